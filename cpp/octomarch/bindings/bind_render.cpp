// Pictures: the planes that Python names, as fresh numpy arrays, with progress and interrupts on the calling thread.
#include <chrono>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "octomarch/bindings/arrays.hpp"
#include "octomarch/bindings/register.hpp"
#include "octomarch/render/render.hpp"

namespace py = pybind11;

namespace octomarch {
namespace {

template <class Real>
Planes<Real> planes_named(const std::vector<std::string>& names, Results& results) {
  Planes<Real> planes;
  for (const std::string_view name : names) {
    if (name == "color") planes.color = results.vectors<Real>("color").data();
    else if (name == "depth") planes.depth = results.scalars<Real>("depth").data();
    else if (name == "position") planes.position = results.vectors<Real>("position").data();
    else if (name == "normal") planes.normal = results.vectors<Real>("normal").data();
    else if (name == "object_id") planes.object_id = results.scalars<std::int32_t>("object_id").data();
    else if (name == "material_id") planes.material_id = results.scalars<std::int32_t>("material_id").data();
    else if (name == "steps") planes.steps = results.scalars<std::int32_t>("steps").data();
    else if (name == "status") planes.status = results.scalars<std::uint8_t>("status").data();
    else require(false, "planes", "among color, depth, position, normal, object_id, material_id, steps, status", name);
  }
  return planes;
}

double occupancy(const kernels::Counters& work) {
  return work.lane_slots == 0 ? 1.0 : static_cast<double>(work.evaluations) / static_cast<double>(work.lane_slots);
}

/// Adds what a stage and all of them together are told alike.
void add_work(py::dict& dict, const kernels::Counters& work) {
  dict["evaluations"] = work.evaluations;
  dict["instructions"] = work.instructions;
  dict["occupancy"] = occupancy(work);
  dict["packets"] = work.packets;
}

py::dict stage_dict(const StageStats& stage) {
  py::dict dict;
  dict["count"] = stage.count;
  add_work(dict, stage.work);
  dict["refills"] = stage.work.refills;
  dict["cells_visited"] = stage.cells_visited;
  dict["cells_made"] = stage.cells_made;
  dict["seconds_cells"] = stage.cell_seconds;
  dict["seconds"] = stage.seconds;
  return dict;
}

py::dict stats_dict(const RenderStats& stats, const kernels::Isa& isa, unsigned threads, const std::string& precision,
                    double seconds) {
  StageStats all;
  py::dict stages;
  for (const NamedStage& stage : kStages) {
    all += stats.*stage.stats;
    stages[stage.name] = stage_dict(stats.*stage.stats);
  }
  py::dict dict;
  dict["isa"] = isa.name;
  dict["precision"] = precision;
  dict["threads"] = threads;
  dict["rays"] = stats.primary.count;
  add_work(dict, all.work);
  dict["without_gradient"] = stats.normals.without;
  dict["cells"] = all.cells_made;
  dict["cell_bytes"] = stats.cell_bytes;
  dict["seconds_cells"] = all.cell_seconds;
  dict["seconds_march"] = stats.seconds_march;
  dict["seconds_shade"] = stats.seconds_shade;
  dict["seconds_reflect"] = stats.seconds_reflect;
  dict["seconds"] = seconds;
  dict["stages"] = stages;
  return dict;
}

Listener listener_for(const py::object& progress) {
  Listener listener{check_signals, {}};
  if (!progress.is_none()) {
    listener.progress = [&progress](std::size_t done, std::size_t all) {
      const py::gil_scoped_acquire gil;
      progress(done, all);
    };
  }
  return listener;
}

py::tuple render_planes(const Program& program, const Scene& scene, const Camera& camera, const March& march,
                        const Shading& shading, std::uint32_t width, std::uint32_t height, const CropBox& crop,
                        int samples, const std::vector<std::string>& planes, const std::string& precision, int threads,
                        const std::string& isa, const py::object& progress) {
  require(width >= 1, "width", ">= 1", width);
  require(height >= 1, "height", ">= 1", height);
  require(samples >= 1, "samples", ">= 1", samples);
  require(threads >= 0, "threads", ">= 0 (0 = all cores)", threads);
  const kernels::Isa& chosen = kernels::find_isa(isa);
  const Picture picture{&program, &scene, camera, march, shading, width, height, crop_of(crop, width, height), samples};
  const unsigned workers = thread_count(static_cast<unsigned>(threads));
  const Listener listener = listener_for(progress);
  return with_precision("precision", precision, [&]<class Real>(Real) {
    const Crop& window = picture.crop;
    Results results({static_cast<py::ssize_t>(window.height), static_cast<py::ssize_t>(window.width)});
    const Planes<Real> wanted = planes_named<Real>(planes, results);
    const auto start = std::chrono::steady_clock::now();
    RenderStats stats;
    {
      const py::gil_scoped_release release;
      stats = render<Real>(picture, wanted, chosen, workers, listener);
    }
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return py::make_tuple(results.take(), stats_dict(stats, chosen, workers, precision, seconds));
  });
}

}  // namespace

void register_render(py::module_& module) {
  module.def("render", &render_planes, py::arg("program"), py::arg("scene"), py::arg("camera"), py::arg("march"),
             py::arg("shading"), py::arg("width"), py::arg("height"), py::arg("crop"), py::arg("samples"),
             py::arg("planes"), py::arg("precision"), py::arg("threads"), py::arg("isa"), py::arg("progress"));
}

}  // namespace octomarch
