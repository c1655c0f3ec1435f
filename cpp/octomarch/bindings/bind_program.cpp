// Compiled programs, queries on arrays, and what this machine can run.
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "octomarch/base/build_info.hpp"
#include "octomarch/bindings/arrays.hpp"
#include "octomarch/bindings/register.hpp"
#include "octomarch/graph/analysis.hpp"
#include "octomarch/graph/schema.hpp"
#include "octomarch/kernels/dispatch.hpp"
#include "octomarch/program/program.hpp"
#include "octomarch/render/query.hpp"

namespace py = pybind11;

namespace octomarch {
namespace {

using Triple = std::tuple<double, double, double>;
using Box = std::tuple<Triple, Triple>;

Triple triple(const Vec3& v) { return {v.x, v.y, v.z}; }
Box box_of(const Aabb& box) { return {triple(box.lo), triple(box.hi)}; }

std::optional<Box> focus_of(const Program& program) {
  if (!program.focus()) return std::nullopt;
  return box_of(*program.focus());
}

std::vector<std::tuple<std::string_view, int>> objects_of(const Program& program) {
  std::vector<std::tuple<std::string_view, int>> objects;
  for (const Object& object : program.attributes().objects) objects.emplace_back(name(object.kind), object.material);
  return objects;
}

Execution execution(int threads, const std::string& isa) {
  require(threads >= 0, "threads", ">= 0 (0 = all cores)", threads);
  return {&kernels::find_isa(isa), static_cast<unsigned>(threads), {check_signals, {}}};
}

py::array distance(const Program& program, const Rows& points, const std::string& precision, int threads,
                   const std::string& isa) {
  const std::span<const double> in = triples(points, "points");
  const Execution how = execution(threads, isa);
  return with_precision("precision", precision, [&]<class Real>(Real) -> py::array {
    py::array_t<Real> values(points.shape(0));
    const std::span<Real> out = contents(values);
    {
      const py::gil_scoped_release release;
      query_distance(program, in.data(), out.size(), out.data(), how);
    }
    return values;
  });
}

py::array gradient(const Program& program, const Rows& points, const std::string& precision, int threads,
                   const std::string& isa) {
  const std::span<const double> in = triples(points, "points");
  const Execution how = execution(threads, isa);
  return with_precision("precision", precision, [&]<class Real>(Real) -> py::array {
    py::array_t<Real> gradients({points.shape(0), py::ssize_t{3}});
    const std::span<Real> out = contents(gradients);
    {
      const py::gil_scoped_release release;
      query_gradient(program, in.data(), in.size() / 3, out.data(), how);
    }
    return gradients;
  });
}

py::array material(const Program& program, const Rows& points, const Rows& normals, const std::string& precision,
                   int threads, const std::string& isa) {
  const std::span<const double> in = triples(points, "points");
  const std::span<const double> facing = triples(normals, "normals");
  require(in.size() == facing.size(), "normals", "as many as points", normals.shape(0));
  const Execution how = execution(threads, isa);
  return with_precision("precision", precision, [&]<class Real>(Real) -> py::array {
    py::array_t<Real> slots({points.shape(0), py::ssize_t{Material::kSlots}});
    const std::span<Real> out = contents(slots);
    {
      const py::gil_scoped_release release;
      query_material(program, in.data(), facing.data(), in.size() / 3, out.data(), how);
    }
    return slots;
  });
}

/// Is what a repeat copies its own mirror image across x, y and z? Else it is copied from neighbouring cells as well.
std::tuple<bool, bool, bool> mirror_symmetry(const NodePtr& shape) {
  const unsigned symmetry = analyse(*shape).at(shape.get()).symmetry;
  return {(symmetry & kMirrorX) != 0, (symmetry & kMirrorX << 1U) != 0, (symmetry & kMirrorX << 2U) != 0};
}

/// Arrays for the planes that are named, all but t null otherwise.
template <class Real>
Hits<Real> hits_named(const std::vector<std::string>& names, Results& results) {
  Hits<Real> hits{.t = results.scalars<Real>("t").data()};
  for (const std::string_view name : names) {
    if (name == "position") hits.position = results.vectors<Real>("position").data();
    else if (name == "normal") hits.normal = results.vectors<Real>("normal").data();
    else if (name == "object_id") hits.object_id = results.scalars<std::int32_t>("object_id").data();
    else if (name == "material_id") hits.material_id = results.scalars<std::int32_t>("material_id").data();
    else if (name == "steps") hits.steps = results.scalars<std::int32_t>("steps").data();
    else if (name == "status") hits.status = results.scalars<std::uint8_t>("status").data();
    else require(name == "t", "planes", "among t, position, normal, object_id, material_id, steps, status", name);
  }
  return hits;
}

Triple doubt(const Program& program, const std::string& precision) {
  return with_precision("precision", precision, [&]<class Real>(Real) -> Triple {
    const Doubt& doubt = program.doubt<Real>();
    return {doubt.offset, doubt.slope, doubt.reach};
  });
}

py::dict raycast(const Program& program, const Rows& origins, const Rows& directions, const March& march,
                 const Shading& shading, double t_max, const std::string& precision,
                 const std::vector<std::string>& planes, int threads, const std::string& isa) {
  const std::span<const double> from = triples(origins, "origins");
  const std::span<const double> along = triples(directions, "directions");
  require(from.size() == along.size(), "directions", "as many as origins", directions.shape(0));
  require(t_max > 0.0, "t_max", "> 0", t_max);
  const Execution how = execution(threads, isa);
  return with_precision("precision", precision, [&]<class Real>(Real) {
    Results results({origins.shape(0)});
    const Hits<Real> hits = hits_named<Real>(planes, results);
    {
      const py::gil_scoped_release release;
      query_rays(program, from.data(), along.data(), from.size() / 3, march, shading, t_max, hits, how);
    }
    return results.take();
  });
}

std::vector<std::string_view> isas() {
  std::vector<std::string_view> names;
  for (const kernels::Isa& isa : kernels::available_isas()) names.push_back(isa.name);
  return names;
}

py::dict build_info() {
  py::dict info;
  info["version"] = kVersion;
  info["compiler"] = kCompiler;
  info["flags"] = kFlags;
  info["build_type"] = kBuildType;
  info["xsimd"] = kXsimdVersion;
  info["glm"] = kGlmVersion;
  return info;
}

}  // namespace

void register_program(py::module_& module) {
  py::class_<Program, std::shared_ptr<Program>>(module, "Program", py::is_final(), "A compiled shape.")
      .def_property_readonly("lipschitz", &Program::lipschitz)
      .def_property_readonly("bounds", [](const Program& program) { return box_of(program.bounds()); })
      .def_property_readonly("focus", &focus_of)
      .def_property_readonly("anchor", [](const Program& program) { return triple(program.site().anchor); })
      .def_property_readonly("is_solid", &Program::is_solid)
      .def("doubt", &doubt, py::arg("precision"))
      .def_property_readonly("instructions", [](const Program& program) { return program.distance().code.size(); })
      .def_property_readonly("registers", [](const Program& program) { return program.distance().registers; })
      .def_property_readonly("attribute_instructions",
                             [](const Program& program) { return program.attributes().tape.code.size(); })
      .def_property_readonly("materials", [](const Program& program) { return program.attributes().materials; })
      .def_property_readonly("objects", &objects_of)
      .def("listing", &listing);
  module.def(
      "compile", [](const NodePtr& shape) { return compile(shape); }, py::arg("shape").none(false),
      py::call_guard<py::gil_scoped_release>());
  module.def("distance", &distance, py::arg("program"), py::arg("points"), py::arg("precision"), py::arg("threads"),
             py::arg("isa"));
  module.def("gradient", &gradient, py::arg("program"), py::arg("points"), py::arg("precision"), py::arg("threads"),
             py::arg("isa"));
  module.def("material", &material, py::arg("program"), py::arg("points"), py::arg("normals"), py::arg("precision"),
             py::arg("threads"), py::arg("isa"));
  module.def("mirror_symmetry", &mirror_symmetry, py::arg("shape").none(false));
  module.def("raycast", &raycast, py::arg("program"), py::arg("origins"), py::arg("directions"), py::arg("march"),
             py::arg("shading"), py::arg("t_max"), py::arg("precision"), py::arg("planes"), py::arg("threads"),
             py::arg("isa"));
  module.def("isas", &isas);
  module.def("resolve_isa", [](const std::string& isa) { return kernels::find_isa(isa).name; }, py::arg("isa"));
  module.def("build_info", &build_info);
}

}  // namespace octomarch
