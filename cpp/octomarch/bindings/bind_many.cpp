// Builders of many shapes at once, from arrays: one call for all of them, made without the GIL. Builders of one shape stand
// before it (bind_shape.cpp); the Python package looks at types and shapes of arrays first.
#include <utility>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "octomarch/bindings/arrays.hpp"
#include "octomarch/bindings/register.hpp"
#include "octomarch/graph/builder.hpp"

namespace py = pybind11;

namespace octomarch {
namespace {

std::span<const double> numbers(const Rows& array) { return {array.data(), static_cast<std::size_t>(array.size())}; }

/// What `build` makes of the numbers of `arrays`, called without the GIL.
template <class Build, class... Arrays>
NodePtr built(const Build& build, const Arrays&... arrays) {
  return [&build](auto... spans) {
    const py::gil_scoped_release release;
    return build(spans...);
  }(numbers(arrays)...);
}

}  // namespace

void register_many(py::module_& module) {
  module.def(
      "spheres",
      [](const Rows& centers, const Rows& radii, double smooth) {
        return built([&](auto... rows) { return spheres(rows..., smooth); }, centers, radii);
      },
      py::arg("centers"), py::arg("radii"), py::arg("smooth"));
  module.def(
      "boxes",
      [](const Rows& centers, const Rows& sizes, double smooth) {
        return built([&](auto... rows) { return boxes(rows..., smooth); }, centers, sizes);
      },
      py::arg("centers"), py::arg("sizes"), py::arg("smooth"));
  module.def(
      "capsules",
      [](const Rows& a, const Rows& b, const Rows& radii, double smooth) {
        return built([&](auto... rows) { return capsules(rows..., smooth); }, a, b, radii);
      },
      py::arg("a"), py::arg("b"), py::arg("radii"), py::arg("smooth"));
  module.def(
      "instances",
      [](const NodePtr& shape, const Rows& matrices, double rounding, double smooth) {
        return built([&](auto rows) { return instances(shape, rows, rounding, smooth); }, matrices);
      },
      py::arg("shape").none(false), py::arg("matrices"), py::arg("rounding"), py::arg("smooth"));
}

}  // namespace octomarch
