// Reads nodes.def's descriptions once, and holds nodes of unknown origin against them.
#include "octomarch/graph/schema.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "octomarch/base/error.hpp"
#include "octomarch/graph/checks.hpp"
#include "octomarch/graph/grid.hpp"
#include "octomarch/graph/scene.hpp"
#include "octomarch/graph/text.hpp"

namespace octomarch {
namespace {

struct Description {
  std::string_view name;
  std::string_view parameters;
  std::string_view children;
};

constexpr Description kDescriptions[] = {
#define OCTOMARCH_NODE(kind, name, parameters, children) {name, parameters, children},
#include "octomarch/graph/nodes.def"
#undef OCTOMARCH_NODE
};

constexpr std::array<std::pair<std::string_view, ParameterType>, 9> kTypes{{{"length", ParameterType::kLength},
                                                                            {"position", ParameterType::kPosition},
                                                                            {"extent", ParameterType::kExtent},
                                                                            {"rate", ParameterType::kRate},
                                                                            {"factor", ParameterType::kFactor},
                                                                            {"number", ParameterType::kNumber},
                                                                            {"bound", ParameterType::kBound},
                                                                            {"axis", ParameterType::kAxis},
                                                                            {"whole", ParameterType::kWhole}}};

ParameterType type_named(std::string_view text) {
  for (const auto& [name, type] : kTypes) {
    if (name == text) return type;
  }
  throw std::logic_error("nodes.def: no parameter type " + std::string(text));
}

/// Cuts the first word off `text`.
std::string_view next_word(std::string_view& text) {
  const std::size_t end = text.find(' ');
  const std::string_view word = text.substr(0, end);
  text = end == std::string_view::npos ? std::string_view{} : text.substr(end + 1);
  return word;
}

NodeSchema parsed(const Description& description) {
  NodeSchema result;
  for (std::string_view rest = description.parameters; !rest.empty();) {
    const std::string_view word = next_word(rest);
    const std::size_t colon = word.find(':');
    const std::size_t star = word.find('*');
    const Parameter parameter{word.substr(0, colon), type_named(word.substr(colon + 1, star - colon - 1))};
    result.any_number = star != std::string_view::npos && star + 1 == word.size();
    const bool several = star != std::string_view::npos && !result.any_number;
    const int count = several ? word[star + 1] - '0' : 1;
    for (int i = 0; i < count; ++i) result.parameters.push_back(parameter);
  }
  for (std::string_view rest = description.children; !rest.empty();) {
    const std::string_view word = next_word(rest);
    result.any_children = word.back() == '*';
    result.children.push_back(result.any_children ? word.substr(0, word.size() - 1) : word);
  }
  return result;
}

bool is_allowed(ParameterType type, double value) {
  switch (type) {
    case ParameterType::kLength: return std::isfinite(value) && value >= 0.0;
    case ParameterType::kExtent: return value >= 0.0;
    case ParameterType::kFactor: return std::isfinite(value) && value > 0.0;
    case ParameterType::kBound: return !std::isnan(value);
    case ParameterType::kAxis: return value == 0.0 || value == 1.0 || value == 2.0;
    case ParameterType::kWhole: return value >= 0.0 && value < 0x1p31 && value == std::floor(value);
    default: return std::isfinite(value);
  }
}

std::string_view requirement(ParameterType type) {
  switch (type) {
    case ParameterType::kLength: return "finite and >= 0";
    case ParameterType::kExtent: return ">= 0";
    case ParameterType::kFactor: return "finite and > 0";
    case ParameterType::kBound: return "a number";
    case ParameterType::kAxis: return "0, 1 or 2";
    case ParameterType::kWhole: return "a whole number from 0 to 2147483647";
    default: return "finite";
  }
}

/// "radius", or "half[1]" where there are several of the name.
std::string name_of(const NodeSchema& schema, std::size_t i) {
  const auto& all = schema.parameters;
  const std::string_view name = all[std::min(i, all.size() - 1)].name;
  const auto named = [name](const Parameter& parameter) { return parameter.name == name; };
  const auto first = static_cast<std::size_t>(std::ranges::find_if(all, named) - all.begin());
  if (!schema.any_number && std::ranges::count_if(all, named) == 1) return std::string(name);
  return std::string(name) + "[" + std::to_string(i - first) + "]";
}

void check_parameters(const NodeSchema& schema, const std::vector<double>& parameters) {
  const std::size_t least = schema.parameters.size();
  const bool enough = schema.any_number ? parameters.size() >= least : parameters.size() == least;
  require(enough, "parameters", (schema.any_number ? "at least " : "") + std::to_string(least) + " numbers",
          parameters.size());
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const Parameter& parameter = schema.parameters[std::min(i, least - 1)];
    if (is_allowed(parameter.type, parameters[i])) continue;
    require(false, name_of(schema, i), requirement(parameter.type), text(parameters[i]));
  }
}

void check_children(const NodeSchema& schema, const std::vector<NodePtr>& children) {
  const std::size_t least = schema.children.size();
  const bool enough = schema.any_children ? children.size() >= least : children.size() == least;
  require(enough, "children", (schema.any_children ? "at least " : "") + std::to_string(least) + " nodes",
          children.size());
  for (std::size_t i = 0; i < children.size(); ++i) {
    const std::string_view wanted = schema.children[std::min(i, least - 1)];
    require(children[i] != nullptr && sort_of(*children[i]) == wanted, "children[" + std::to_string(i) + "]", wanted,
            children[i] == nullptr ? "none" : sort_of(*children[i]));
  }
}

bool is_near(double a, double b) { return std::fabs(a - b) <= 1e-9; }

void check_rotation(std::span<const double> rotation) {
  Mat3 m{};
  std::copy(rotation.begin(), rotation.end(), m.begin());
  const Mat3 product = m * transposed(m);
  for (std::size_t i = 0; i < 9; ++i) {
    require(is_near(product[i], kIdentity3[i]), "rotation", "orthonormal", text(rotation[i]));
  }
  const Vec3 z = cross({m[0], m[1], m[2]}, {m[3], m[4], m[5]});
  require(dot(z, {m[6], m[7], m[8]}) > 0.0, "rotation", "right-handed", "a reflection");
}

void check_repeat(const std::vector<double>& p) {
  require(p[0] > 0.0 || p[1] > 0.0 || p[2] > 0.0, "period", "> 0 on an axis at least", "0 on all");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool plain = p[3 + axis] != 1.0 && (p[axis] > 0.0 || p[3 + axis] == 0.0);
    require(plain, "count", "0 or >= 2, and 0 where nothing is repeated", text(p[3 + axis]));
  }
}

std::optional<double> constant_of(const Node& node) {
  return node.kind() == NodeKind::kConstant ? std::optional(node.parameter(0)) : std::nullopt;
}

/// A paint's numbers lie in the ranges of materials; what changes from point to point may leave them. See Material.
void check_paint(const std::vector<NodePtr>& children) {
  require(children.size() == 1 + Material::kSlots, "children", "a shape and 7 expressions", children.size());
  std::array<std::optional<double>, 1 + Material::kSlots> numbers;
  for (std::size_t i = 1; i <= Material::kSlots; ++i) numbers[i] = constant_of(*children[i]);
  const bool is_one_color = numbers[1] && numbers[2] && numbers[3];
  for (std::size_t i = 1; i <= Material::kSlots; ++i) {
    if (!numbers[i] || (i <= 3 && !is_one_color)) continue;
    const double most = i <= 3 ? std::numeric_limits<double>::max() : 1.0;
    require(*numbers[i] >= 0.0 && *numbers[i] <= most, "children[" + std::to_string(i) + "]",
            i <= 3 ? "finite and >= 0" : "from 0 to 1", text(*numbers[i]));
  }
}

void check_image(const std::vector<double>& p, const std::vector<float>& texels) {
  require(p[0] >= 1.0, "width", ">= 1", text(p[0]));
  require(p[1] >= 1.0, "height", ">= 1", text(p[1]));
  require(p[0] * p[1] * 3.0 == double(texels.size()), "texels", "3 for each of the image's pixels", texels.size());
  const bool finite = std::ranges::all_of(texels, [](float texel) { return std::isfinite(texel); });
  require(finite, "texels", "finite", "some that are not");
}

/// Slopes that are too small would let rays through.
void check_grid(const std::vector<double>& p, const std::vector<float>& values) {
  const auto count = [&p](std::size_t axis) { return static_cast<std::size_t>(p[axis]); };
  const std::array<std::size_t, 3> size{count(0), count(1), count(2)};
  require_grid(size, values);
  require(p[3] <= 1.0, "interpolation", "0 or 1", text(p[3]));
  require_grid_box({{p[6], p[7], p[8]}, {p[9], p[10], p[11]}});
  GridSamples samples{values, size, {}, p[3] == 0.0 ? Interpolation::kLinear : Interpolation::kCubic};
  for (std::size_t axis = 0; axis < 3; ++axis) samples.spacing[axis] = (p[9 + axis] - p[6 + axis]) / (p[axis] - 1.0);
  const double least = steepest_slope(samples);
  require(p[4] >= least, "lipschitz", ">= " + text(least) + ", the values' slope", text(p[4]));
}

/// What a kind demands of its parameters together.
void check_whole(NodeKind kind, const std::vector<double>& p, const std::vector<NodePtr>& children,
                 const std::vector<float>& texels) {
  switch (kind) {
    case NodeKind::kPlane:
      return require(is_near(length({p[0], p[1], p[2]}), 1.0), "normal", "a unit vector", text(Vec3{p[0], p[1], p[2]}));
    case NodeKind::kPolygon:
      return require(p.size() >= 6 && p.size() % 2 == 0, "corners", "three points or more",
                     std::to_string(p.size()) + " numbers");
    case NodeKind::kGrid: return check_grid(p, texels);
    case NodeKind::kField: require_field_bounds({{p[1], p[2], p[3]}, {p[4], p[5], p[6]}}); [[fallthrough]];
    case NodeKind::kDisplace: return require(p[0] >= 0.0, "lipschitz", ">= 0", text(p[0]));
    case NodeKind::kMetaballs: return require(p[0] > 0.0, "k", "> 0", text(p[0]));
    case NodeKind::kRotate: return check_rotation(p);
    case NodeKind::kRepeat: return check_repeat(p);
    case NodeKind::kExtrude:
    case NodeKind::kRevolve: return require(children[0]->is_flat(), "shape", "flat", name(children[0]->kind()));
    case NodeKind::kPaint: return check_paint(children);
    case NodeKind::kCoordinate: return require(p[0] <= 5.0, "index", "0 to 5", text(p[0]));
    case NodeKind::kTexel:
      require(p[0] <= 2.0, "channel", "0, 1 or 2", text(p[0]));
      return require(p[1] <= 2.0, "wrap", "0, 1 or 2", text(p[1]));
    case NodeKind::kImage: return check_image(p, texels);
    default: return;
  }
}

/// Shapes ask what lies at a point before there is a surface: their expressions have no normal to look at.
void check_expressions(NodeKind kind, const std::vector<NodePtr>& children) {
  if (kind != NodeKind::kField && kind != NodeKind::kSolid && kind != NodeKind::kDisplace) return;
  require(!children.back()->uses_normal(), "expression", "without the normal, which only materials have",
          "one with it");
}

}  // namespace

std::span<const std::string_view> node_names() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> result;
    for (const Description& description : kDescriptions) result.push_back(description.name);
    return result;
  }();
  return names;
}

std::optional<NodeKind> kind_named(std::string_view name) {
  const auto entry = std::ranges::find(node_names(), name);
  if (entry == node_names().end()) return std::nullopt;
  return static_cast<NodeKind>(entry - node_names().begin());
}

std::string_view name(NodeKind kind) { return kDescriptions[static_cast<std::size_t>(kind)].name; }

std::string_view name(ParameterType type) {
  return std::ranges::find(kTypes, type, &std::pair<std::string_view, ParameterType>::second)->first;
}

std::string_view sort_of(const Node& node) {
  return is_shape(node.kind()) ? "shape" : is_expression(node.kind()) ? "expression" : "image";
}

const NodeSchema& schema(NodeKind kind) {
  static const std::vector<NodeSchema> schemas = [] {
    std::vector<NodeSchema> result;
    for (const Description& description : kDescriptions) result.push_back(parsed(description));
    return result;
  }();
  return schemas[static_cast<std::size_t>(kind)];
}

double scaled_parameter(const Node& node, std::size_t i, double scale) {
  const auto& parameters = schema(node.kind()).parameters;
  switch (parameters[std::min(i, parameters.size() - 1)].type) {
    case ParameterType::kLength:
    case ParameterType::kPosition:
    case ParameterType::kExtent: return node.parameter(i) * scale;
    case ParameterType::kRate: return node.parameter(i) / scale;
    default: return node.parameter(i);
  }
}

NodePtr checked_node(std::string_view kind_name, std::vector<double> parameters, std::vector<NodePtr> children,
                     std::vector<float> texels) {
  const std::optional<NodeKind> kind = kind_named(kind_name);
  require(kind.has_value(), "kind", "a kind of node that this version knows", kind_name);
  check_parameters(schema(*kind), parameters);
  check_children(schema(*kind), children);
  const bool has_texels = *kind == NodeKind::kImage || *kind == NodeKind::kGrid;
  require(has_texels || texels.empty(), "texels", "those of an image or a grid", kind_name);
  check_whole(*kind, parameters, children, texels);
  check_expressions(*kind, children);
  return intern(*kind, std::move(parameters), std::move(children), std::move(texels));
}

}  // namespace octomarch
