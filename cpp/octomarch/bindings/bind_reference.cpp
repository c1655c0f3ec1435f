// The scalar reference as Python sees it: arrays in, arrays out, float32 or float64. The GIL is released while it works,
// and taken now and then to see whether the user wants to stop.
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "octomarch/base/error.hpp"
#include "octomarch/bindings/arrays.hpp"
#include "octomarch/bindings/register.hpp"
#include "octomarch/program/program.hpp"
#include "octomarch/reference/certified.hpp"
#include "octomarch/reference/queries.hpp"
#include "octomarch/reference/render.hpp"

namespace py = pybind11;

namespace octomarch {
namespace {

template <class Real>
reference::Compiled compiled(const Program& program, const March& march) {
  const bool is_certified = march.method == Method::kCertified;
  return {program.lipschitz(), program.site(), is_certified ? program.doubt<Real>() : Doubt{}};
}

py::array distance(const Program& program, const Rows& points, const std::string& dtype) {
  const std::span<const double> in = triples(points, "points");
  return with_precision("dtype", dtype, [&]<class T>(T) -> py::array {
    py::array_t<T> values(points.shape(0));
    const std::span<T> out = contents(values);
    {
      const py::gil_scoped_release release;
      reference::distance(program.root(), program.site().anchor, in, out, check_signals);
    }
    return values;
  });
}

py::array gradient(const Program& program, const Rows& points, const std::string& dtype) {
  const std::span<const double> in = triples(points, "points");
  return with_precision("dtype", dtype, [&]<class T>(T) -> py::array {
    py::array_t<T> gradients({points.shape(0), py::ssize_t{3}});
    const std::span<T> out = contents(gradients);
    {
      const py::gil_scoped_release release;
      reference::gradient(program.root(), program.site().anchor, in, out, check_signals);
    }
    return gradients;
  });
}

py::dict raycast(const Program& program, const Rows& origins, const Rows& directions, const March& march,
                 const Shading& shading, double t_max, const std::string& dtype) {
  const std::span<const double> from = triples(origins, "origins");
  const std::span<const double> along = triples(directions, "directions");
  require(from.size() == along.size(), "directions", "as many as origins", directions.shape(0));
  return with_precision("dtype", dtype, [&]<class T>(T) {
    Results results({origins.shape(0)});
    const reference::Hits<T> hits{.t = results.scalars<T>("t"),
                                  .position = results.vectors<T>("position"),
                                  .normal = results.vectors<T>("normal"),
                                  .material_id = results.scalars<std::int32_t>("material_id"),
                                  .steps = results.scalars<std::int32_t>("steps"),
                                  .status = results.scalars<std::uint8_t>("status")};
    {
      const py::gil_scoped_release release;
      reference::raycast(program.root(), from, along, march, shading, t_max, compiled<T>(program, march), hits,
                         check_signals);
    }
    return results.take();
  });
}

template <class T>
reference::Planes<T> planes_named(const std::vector<std::string>& names, Results& results) {
  reference::Planes<T> planes;
  for (const std::string_view name : names) {
    if (name == "color") planes.color = results.vectors<T>("color");
    else if (name == "depth") planes.depth = results.scalars<T>("depth");
    else if (name == "position") planes.position = results.vectors<T>("position");
    else if (name == "normal") planes.normal = results.vectors<T>("normal");
    else if (name == "material_id") planes.material_id = results.scalars<std::int32_t>("material_id");
    else if (name == "steps") planes.steps = results.scalars<std::int32_t>("steps");
    else if (name == "status") planes.status = results.scalars<std::uint8_t>("status");
    else
      require(false, "planes", "among 'color', 'depth', 'position', 'normal', 'material_id', 'steps', 'status'", name);
  }
  return planes;
}

py::dict render(const Program& program, const Scene& scene, const Camera& camera, const March& march,
                const Shading& shading, std::uint32_t width, std::uint32_t height, const CropBox& crop, int samples,
                const std::vector<std::string>& planes, const std::string& dtype) {
  require(width >= 1, "width", ">= 1", width);
  require(height >= 1, "height", ">= 1", height);
  require(samples >= 1, "samples", ">= 1", samples);
  const Crop window = crop_of(crop, width, height);
  return with_precision("dtype", dtype, [&]<class T>(T) {
    Results results({static_cast<py::ssize_t>(window.height), static_cast<py::ssize_t>(window.width)});
    const reference::Planes<T> wanted = planes_named<T>(planes, results);
    {
      const py::gil_scoped_release release;
      reference::render(program.root(), scene, camera, march, shading, {width, height, window, samples},
                        compiled<T>(program, march), wanted, check_signals);
    }
    return results.take();
  });
}

reference::Brackets brackets_in(Results& results) {
  return {.t_lo = results.scalars<double>("t_lo"),
          .t_hi = results.scalars<double>("t_hi"),
          .verdict = results.scalars<std::uint8_t>("status")};
}

py::dict certified(const NodePtr& node, const Rows& origins, const Rows& directions, double t_min, double max_distance,
                   double tolerance, int max_evaluations, unsigned threads) {
  const std::span<const double> from = triples(origins, "origins");
  const std::span<const double> along = triples(directions, "directions");
  require(from.size() == along.size(), "directions", "as many as origins", directions.shape(0));
  Results results({origins.shape(0)});
  const reference::Brackets brackets = brackets_in(results);
  {
    const py::gil_scoped_release release;
    reference::certified(node, from, along, {t_min, max_distance, tolerance, max_evaluations}, threads, brackets,
                         check_signals);
  }
  return results.take();
}

py::dict certified_picture(const NodePtr& node, const Camera& camera, std::uint32_t width, std::uint32_t height,
                           const CropBox& crop, double t_min, double max_distance, double tolerance,
                           int max_evaluations, unsigned threads) {
  require(width >= 1, "width", ">= 1", width);
  require(height >= 1, "height", ">= 1", height);
  const Crop window = crop_of(crop, width, height);
  Results results({static_cast<py::ssize_t>(window.height), static_cast<py::ssize_t>(window.width)});
  const reference::Brackets brackets = brackets_in(results);
  {
    const py::gil_scoped_release release;
    reference::certified_picture(node, camera, width, height, window, {t_min, max_distance, tolerance, max_evaluations},
                                 threads, brackets, check_signals);
  }
  return results.take();
}

/// What the search knows of a field along the segments from `starts` to `ends`: least and greatest value, and least and
/// greatest change per segment.
py::array ranges(const NodePtr& node, const Rows& starts, const Rows& ends) {
  const std::span<const double> from = triples(starts, "starts");
  const std::span<const double> to = triples(ends, "ends");
  require(from.size() == to.size(), "ends", "as many as starts", ends.shape(0));
  py::array_t<double> rows({starts.shape(0), py::ssize_t{4}});
  const std::span<double> out = contents(rows);
  reference::FieldTracer field(node, {});
  for (std::size_t i = 0; i < from.size(); i += 3) {
    reference::PointTrace p;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Interval first = from[i + axis];
      const Interval last = to[i + axis];
      p[axis] = {hull(first, last), first, last, last - first, true};
    }
    const reference::Trace trace = field.along(p);
    const Interval over = trace.is_undefined ? Interval::whole() : trace.over;
    const Interval rise = trace.is_undefined ? Interval::whole() : trace.rise;
    const std::size_t row = i / 3 * 4;
    out[row] = over.lo();
    out[row + 1] = over.hi();
    out[row + 2] = rise.lo();
    out[row + 3] = rise.hi();
  }
  return rows;
}

}  // namespace

void register_reference(py::module_& module) {
  module.def("reference_distance", &distance, py::arg("program"), py::arg("points"), py::arg("dtype"));
  module.def("reference_gradient", &gradient, py::arg("program"), py::arg("points"), py::arg("dtype"));
  module.def("reference_raycast", &raycast, py::arg("program"), py::arg("origins"), py::arg("directions"),
             py::arg("march"), py::arg("shading"), py::arg("t_max"), py::arg("dtype"));
  module.def("reference_render", &render, py::arg("program"), py::arg("scene"), py::arg("camera"), py::arg("march"),
             py::arg("shading"), py::arg("width"), py::arg("height"), py::arg("crop"), py::arg("samples"),
             py::arg("planes"), py::arg("dtype"));
  module.def("reference_certified", &certified, py::arg("node").none(false), py::arg("origins"), py::arg("directions"),
             py::arg("t_min"), py::arg("max_distance"), py::arg("tolerance"), py::arg("max_evaluations"),
             py::arg("threads"));
  module.def("reference_certified_picture", &certified_picture, py::arg("node").none(false), py::arg("camera"),
             py::arg("width"), py::arg("height"), py::arg("crop"), py::arg("t_min"), py::arg("max_distance"),
             py::arg("tolerance"), py::arg("max_evaluations"), py::arg("threads"));
  module.def("reference_ranges", &ranges, py::arg("node").none(false), py::arg("starts"), py::arg("ends"));
}

}  // namespace octomarch
