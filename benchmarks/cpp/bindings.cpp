// The Python module octomarch_bench: every hand-written march by instruction set and name. The marches come before it;
// benchmarks/run.py times it.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "camera.hpp"
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "octomarch/base/build_info.hpp"

// OCTOMARCH_BENCH_ISAS comes from CMake: ISA(avx512) ISA(avx2) … for the instruction sets that were built.
#define ISA(isa) OCTOMARCH_BENCH_DECLARE(isa)
OCTOMARCH_BENCH_ISAS
ISA(native)
#undef ISA

namespace octomarch_bench {
namespace {

namespace py = pybind11;
using Vector = std::array<double, 3>;

struct Variant {
  std::string_view isa;
  std::string_view name;
  March (*march)(SceneName scene);
};

#define ISA(isa)                                                                          \
  Variant{#isa, "scalar", isa::scalar_march}, Variant{#isa, "skip", isa::skipping_march}, \
      Variant{#isa, "packet", isa::packet_march}, Variant{#isa, "block", isa::block_march},
constexpr Variant kVariants[] = {OCTOMARCH_BENCH_ISAS Variant{"native", "scalar", native::scalar_march}};
#undef ISA

bool runs_here(std::string_view isa) {
#ifdef __x86_64__
  if (isa == "avx2") return __builtin_cpu_supports("avx2") != 0;
  if (isa == "avx512") {
    return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512cd") != 0 &&
           __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
           __builtin_cpu_supports("avx512vl") != 0;
  }
#endif
  return !isa.empty();
}

std::vector<std::tuple<std::string, std::string>> variants() {
  std::vector<std::tuple<std::string, std::string>> names;
  for (const Variant& variant : kVariants) {
    if (runs_here(variant.isa)) names.emplace_back(variant.isa, variant.name);
  }
  return names;
}

March find(const std::string& isa, const std::string& name, const std::string& scene) {
  if (scene != "A" && scene != "B") throw std::invalid_argument("scene must be A or B, got " + scene);
  for (const Variant& variant : kVariants) {
    if (variant.isa == isa && variant.name == name && runs_here(isa)) {
      return variant.march(scene == "A" ? SceneName::kA : SceneName::kB);
    }
  }
  throw std::invalid_argument("no march " + name + " for " + isa + " here");
}

Vector cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Vector unit(const Vector& a) {
  const double length = std::hypot(a[0], a[1], a[2]);
  return {a[0] / length, a[1] / length, a[2] / length};
}

/// The look-at camera of the engine with y up.
Frame look_at(const Vector& eye, const Vector& target, double fov, int width, int height) {
  const Vector w = unit({target[0] - eye[0], target[1] - eye[1], target[2] - eye[2]});
  const Vector u = unit(cross(w, {0.0, 1.0, 0.0}));
  const Vector v = cross(u, w);
  const double half = std::tan(fov * std::numbers::pi / 360.0);
  const double aspect = static_cast<double>(width) / height;
  Frame frame{};
  frame.width = width;
  frame.height = height;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    frame.eye[axis] = static_cast<float>(eye[axis]);
    frame.corner[axis] = static_cast<float>(w[axis] - half * aspect * u[axis] + half * v[axis]);
    frame.right[axis] = static_cast<float>(2.0 * half * aspect / width * u[axis]);
    frame.down[axis] = static_cast<float>(-2.0 * half / height * v[axis]);
  }
  return frame;
}

/// (t per pixel, evaluations of the field).
std::tuple<py::array_t<float>, std::int64_t> march(const std::string& isa, const std::string& name,
                                                   const std::string& scene, const Vector& eye, const Vector& target,
                                                   double fov, int width, int height, int max_steps, double epsilon,
                                                   double max_distance) {
  if (width <= 0 || height <= 0 || width % 4 != 0 || height % 4 != 0) {
    throw std::invalid_argument("width and height must be positive multiples of 4");
  }
  const March function = find(isa, name, scene);
  const Frame frame = look_at(eye, target, fov, width, height);
  const float reach = std::max({std::fabs(frame.eye[0]), std::fabs(frame.eye[1]), std::fabs(frame.eye[2])});
  const Settings settings{max_steps, static_cast<float>(max_distance),
                          std::max(static_cast<float>(epsilon), kUlpFloor * reach)};
  py::array_t<float> depth({height, width});
  float* const pixels = depth.mutable_data();
  std::int64_t evaluations = 0;
  {
    const py::gil_scoped_release release;
    evaluations = function(frame, settings, pixels);
  }
  return {std::move(depth), evaluations};
}

}  // namespace
}  // namespace octomarch_bench

PYBIND11_MODULE(octomarch_bench, module) {
  namespace py = pybind11;
  using namespace pybind11::literals;
  module.doc() = "Marches written by hand, to hold the engine against.";
  module.def("variants", &octomarch_bench::variants, "(isa, name) of every march that runs on this machine.");
  module.def("march", &octomarch_bench::march, "isa"_a, "name"_a, "scene"_a, py::kw_only(), "eye"_a, "target"_a,
             "fov"_a, "width"_a, "height"_a, "max_steps"_a, "epsilon"_a, "max_distance"_a,
             "March every pixel; returns (t of shape (height, width), evaluations of the field).");
  module.attr("compiler") = octomarch::kCompiler;
  module.attr("flags") = octomarch::kFlags;
  module.attr("xsimd") = octomarch::kXsimdVersion;
}
