// Expressions, images and materials as Python sees them: numbers at a point, and the seven of them that a surface is
// made of. Nodes come before (bind_shape.cpp); the Python modules expressions, textures and materials wrap these.
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "octomarch/base/error.hpp"
#include "octomarch/bindings/register.hpp"
#include "octomarch/graph/builder.hpp"
#include "octomarch/graph/expression_bounds.hpp"
#include "octomarch/graph/schema.hpp"

namespace py = pybind11;

namespace octomarch {
namespace {

using Triple = std::array<double, 3>;
using Texels = py::array_t<float, py::array::c_style | py::array::forcecast>;

Aabb box_between(const Triple& lo, const Triple& hi) { return {{lo[0], lo[1], lo[2]}, {hi[0], hi[1], hi[2]}}; }

NodePtr operation(const std::string& kind, std::vector<NodePtr> operands) {
  NodePtr node = checked_node(kind, {}, std::move(operands), {});
  require(is_expression(node->kind()), "kind", "an operation on numbers", kind);
  return node;
}

NodePtr image_of(const Texels& texels) {
  const bool is_rgb = texels.ndim() == 3 && texels.shape(2) == 3;
  require(is_rgb, "texels", "an array of shape (height, width, 3)",
          py::str(py::getattr(texels, "shape")).cast<std::string>());
  constexpr auto kMost = static_cast<py::ssize_t>(std::numeric_limits<std::int32_t>::max());
  require(texels.size() <= kMost, "texels", "at most 2147483647 numbers", texels.size());
  return image(static_cast<int>(texels.shape(1)), static_cast<int>(texels.shape(0)),
               std::vector<float>(texels.data(), texels.data() + texels.size()));
}

std::optional<double> constant_of(const Node& node) {
  if (node.kind() != NodeKind::kConstant) return std::nullopt;
  return node.parameter(0);
}

std::tuple<double, double, double> bounds_of(const NodePtr& node, const Triple& lo, const Triple& hi) {
  require(is_expression(node->kind()), "expression", "an expression", name(node->kind()));
  const ExpressionBounds bounds = expression_bounds(*node, box_between(lo, hi));
  return {bounds.lo, bounds.hi, bounds.slope};
}

}  // namespace

void register_expression(py::module_& module) {
  module.def("constant", &constant, py::arg("value"));
  module.def("coordinate", &coordinate, py::arg("index"));
  module.def("expression", &operation, py::arg("kind"), py::arg("operands"));
  module.def("noise", &noise, py::arg("x").none(false), py::arg("y").none(false), py::arg("z").none(false),
             py::arg("seed"));
  module.def("image", &image_of, py::arg("texels"));
  module.def("texel", &texel, py::arg("image").none(false), py::arg("u").none(false), py::arg("v").none(false),
             py::arg("channel"), py::arg("wrap"));
  module.def("constant_value", &constant_of, py::arg("node").none(false));
  module.def("uses_normal", &Node::uses_normal, py::arg("expression").none(false));
  module.def("expression_bounds", &bounds_of, py::arg("expression").none(false), py::arg("lo"), py::arg("hi"));
  py::class_<Material>(module, "Material", py::is_final())
      .def(py::init([](std::array<NodePtr, Material::kSlots> slots) { return Material{std::move(slots)}; }),
           py::arg("slots"))
      .def_readonly("slots", &Material::slots);
}

}  // namespace octomarch
