// Builders of shapes as Python sees them: primitives, operators over distances, operators over points. The Python
// package gives them names, defaults and documentation; programs and the reference take the nodes they make.
#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "octomarch/bindings/register.hpp"
#include "octomarch/bindings/values.hpp"
#include "octomarch/graph/builder.hpp"

namespace py = pybind11;

namespace octomarch {
namespace {

constexpr Names<NodeKind, 4> kCombinations{{{"union", NodeKind::kUnion},
                                            {"intersection", NodeKind::kIntersection},
                                            {"difference", NodeKind::kDifference},
                                            {"metaballs", NodeKind::kMetaballs}}};
constexpr Names<NodeKind, 3> kBoxes{
    {{"exact", NodeKind::kBox}, {"exterior", NodeKind::kBoxExterior}, {"maximum", NodeKind::kBoxMaximum}}};

std::optional<Aabb> aabb(const std::optional<std::array<Triple, 2>>& corners) {
  if (!corners) return std::nullopt;
  return Aabb{vec3((*corners)[0]), vec3((*corners)[1])};
}

constexpr Names<Interpolation, 2> kInterpolations{
    {{"linear", Interpolation::kLinear}, {"cubic", Interpolation::kCubic}}};

using Samples = py::array_t<float, py::array::c_style | py::array::forcecast>;

NodePtr grid_of(const Samples& values, const Triple& lo, const Triple& hi, const std::string& interpolation) {
  require(values.ndim() == 3, "values", "an array of three axes", values.ndim());
  const auto size = [&values](py::ssize_t axis) { return static_cast<std::size_t>(values.shape(axis)); };
  const Interpolation kind = parse("interpolation", interpolation, kInterpolations);
  std::vector<float> copy(values.data(), values.data() + values.size());
  const py::gil_scoped_release free_others;
  return grid({size(0), size(1), size(2)}, std::move(copy), {vec3(lo), vec3(hi)}, kind);
}

/// Everything that is round about an axis or bounded by flat faces.
void register_solids(py::module_& module) {
  module.def("sphere", &sphere, py::arg("radius"));
  module.def(
      "box", [](const Triple& size, const std::string& form) { return box(vec3(size), parse("form", form, kBoxes)); },
      py::arg("size"), py::arg("form"));
  module.def(
      "plane", [](const Triple& normal, const Triple& point) { return plane(vec3(normal), vec3(point)); },
      py::arg("normal"), py::arg("point"));
  module.def(
      "cylinder",
      [](double radius, std::optional<double> height, const Triple& axis) {
        return cylinder(radius, height, vec3(axis));
      },
      py::arg("radius"), py::arg("height"), py::arg("axis"));
  module.def(
      "capped_cone",
      [](double radius_bottom, double radius_top, double height, const Triple& axis) {
        return capped_cone(radius_bottom, radius_top, height, vec3(axis));
      },
      py::arg("radius_bottom"), py::arg("radius_top"), py::arg("height"), py::arg("axis"));
  module.def(
      "torus",
      [](double radius, double tube_radius, const Triple& axis) { return torus(radius, tube_radius, vec3(axis)); },
      py::arg("radius"), py::arg("tube_radius"), py::arg("axis"));
  module.def(
      "capsule", [](const Triple& a, const Triple& b, double radius) { return capsule(vec3(a), vec3(b), radius); },
      py::arg("a"), py::arg("b"), py::arg("radius"));
  module.def("octahedron", &octahedron, py::arg("radius"));
  module.def("pyramid", &pyramid, py::arg("edge"), py::arg("height"));
}

void register_flat_and_free(py::module_& module) {
  module.def("rectangle", &rectangle, py::arg("size"));
  module.def("polygon", &polygon, py::arg("corners"));
  module.def("grid", &grid_of, py::arg("values"), py::arg("lo"), py::arg("hi"), py::arg("interpolation"));
  module.def(
      "field",
      [](NodePtr expression, std::optional<double> lipschitz, const std::optional<std::array<Triple, 2>>& bounds) {
        return field(std::move(expression), lipschitz, aabb(bounds));
      },
      py::arg("expression").none(false), py::arg("lipschitz"), py::arg("bounds"));
  module.def("solid", &solid, py::arg("expression").none(false));
}

void register_distance_operators(py::module_& module) {
  module.def(
      "combine",
      [](const std::string& kind, std::vector<NodePtr> shapes, double smooth) {
        return combine(parse("kind", kind, kCombinations), std::move(shapes), smooth);
      },
      py::arg("kind"), py::arg("shapes"), py::arg("smooth"));
  module.def("complement", &complement, py::arg("shape").none(false));
  module.def("round", &round, py::arg("shape").none(false), py::arg("radius"));
  module.def("shell", &shell, py::arg("shape").none(false), py::arg("thickness"));
  module.def("displace", &displace, py::arg("shape").none(false), py::arg("expression").none(false),
             py::arg("lipschitz"));
  module.def("extrude", &extrude, py::arg("shape").none(false), py::arg("height"));
  module.def("paint", &paint, py::arg("shape").none(false), py::arg("material"));
}

void register_point_operators(py::module_& module) {
  module.def(
      "translate", [](NodePtr shape, const Triple& offset) { return translate(std::move(shape), vec3(offset)); },
      py::arg("shape").none(false), py::arg("offset"));
  module.def(
      "rotate",
      [](NodePtr shape, double degrees, const Triple& axis) { return rotate(std::move(shape), degrees, vec3(axis)); },
      py::arg("shape").none(false), py::arg("degrees"), py::arg("axis"));
  module.def("scale", &scale, py::arg("shape").none(false), py::arg("factor"));
  module.def(
      "stretch", [](NodePtr shape, const Triple& factors) { return stretch(std::move(shape), vec3(factors)); },
      py::arg("shape").none(false), py::arg("factors"));
  module.def("mirror", &mirror, py::arg("shape").none(false), py::arg("axis"));
  module.def(
      "elongate", [](NodePtr shape, const Triple& lengths) { return elongate(std::move(shape), vec3(lengths)); },
      py::arg("shape").none(false), py::arg("lengths"));
  module.def("twist", &twist, py::arg("shape").none(false), py::arg("degrees"), py::arg("axis"));
  module.def("bend", &bend, py::arg("shape").none(false), py::arg("degrees"));
  module.def("revolve", &revolve, py::arg("shape").none(false), py::arg("offset"));
  module.def(
      "repeat",
      [](NodePtr shape, const Triple& period, const std::array<int, 3>& counts) {
        return repeat(std::move(shape), vec3(period), counts);
      },
      py::arg("shape").none(false), py::arg("period"), py::arg("counts"));
}

}  // namespace

void register_shape(py::module_& module) {
  register_solids(module);
  register_flat_and_free(module);
  register_distance_operators(module);
  register_point_operators(module);
}

}  // namespace octomarch
