// Builders of expressions, of images, and of the paint that takes both to surfaces.
#include <algorithm>
#include <utility>

#include "octomarch/graph/builder.hpp"
#include "octomarch/graph/checks.hpp"

namespace octomarch {

NodePtr constant(double value) {
  require(!std::isnan(value), "value", "a number", text(value));
  return intern(NodeKind::kConstant, {value}, {});
}

NodePtr coordinate(int index) {
  require(index >= 0 && index <= 5, "index", "0 to 5", index);
  return intern(NodeKind::kCoordinate, {static_cast<double>(index)}, {});
}

NodePtr expression(NodeKind kind, std::vector<NodePtr> operands) {
  const NodeSchema& wanted = schema(kind);
  require(is_expression(kind) && wanted.parameters.empty(), "kind", "an operation on numbers", name(kind));
  require(operands.size() == wanted.children.size(), "operands", std::to_string(wanted.children.size()),
          operands.size());
  for (const NodePtr& operand : operands) require_expression(operand, "operand");
  return intern(kind, {}, std::move(operands));
}

NodePtr noise(NodePtr x, NodePtr y, NodePtr z, int seed) {
  for (const NodePtr* operand : {&x, &y, &z}) require_expression(*operand, "point");
  require(seed >= 0, "seed", ">= 0", seed);
  return intern(NodeKind::kNoise, {static_cast<double>(seed)}, {std::move(x), std::move(y), std::move(z)});
}

NodePtr image(int width, int height, std::vector<float> texels) {
  require(width >= 1, "width", ">= 1", width);
  require(height >= 1, "height", ">= 1", height);
  const std::size_t size = 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  require(texels.size() == size, "texels", std::to_string(size) + " numbers", texels.size());
  const bool finite = std::ranges::all_of(texels, [](float texel) { return std::isfinite(texel); });
  require(finite, "texels", "finite", "some that are not");
  return intern(NodeKind::kImage, {static_cast<double>(width), static_cast<double>(height)}, {}, std::move(texels));
}

NodePtr texel(NodePtr image, NodePtr u, NodePtr v, int channel, int wrap) {
  require(image != nullptr && image->kind() == NodeKind::kImage, "image", "an image",
          image ? name(image->kind()) : "none");
  require_expression(u, "u");
  require_expression(v, "v");
  require(channel >= 0 && channel <= 2, "channel", "0, 1 or 2", channel);
  require(wrap >= 0 && wrap <= 2, "wrap", "0, 1 or 2", wrap);
  return intern(NodeKind::kTexel, {static_cast<double>(channel), static_cast<double>(wrap)},
                {std::move(image), std::move(u), std::move(v)});
}

NodePtr paint(NodePtr shape, const Material& material) {
  require_shape(shape);
  std::vector<NodePtr> children{std::move(shape)};
  for (const NodePtr& slot : material.slots) {
    require_expression(slot, "material");
    children.push_back(slot);
  }
  return intern(NodeKind::kPaint, {}, std::move(children));
}

Material material_of(const Node& paint) {
  Material material;
  std::copy_n(paint.children().begin() + 1, Material::kSlots, material.slots.begin());
  return material;
}

}  // namespace octomarch
