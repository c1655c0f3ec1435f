// What all marches of the benchmark share: the camera ready for use, the settings, and the signature by which
// bindings.cpp calls them. Nothing comes before it; lanes.hpp, the marches and the bindings come after it.
#pragma once

#include <cstdint>

namespace octomarch_bench {

/// A perspective camera ready for the pixels of one picture: pixel (i, j) looks along
/// unit(corner + (j + ½)·down + (i + ½)·right).
struct Frame {
  int width;
  int height;
  float eye[3];
  float corner[3];
  float right[3];
  float down[3];
};

struct Settings {
  int max_steps;
  float max_distance;
  float epsilon;  ///< max(epsilon, 16u·|eye|∞)
};

/// 16u, u = 2⁻²⁴: a surface is hit where the field is below max(epsilon, kUlpFloor·t).
inline constexpr float kUlpFloor = 16.0f / 16777216.0f;

enum class SceneName : std::uint8_t { kA, kB };

/// Marches every pixel of `frame`, whose sides are multiples of four, writes t to depth[height·width], +inf on a miss,
/// and returns the number of field evaluations, lanes that had nothing to do included.
using March = std::int64_t (*)(const Frame& frame, const Settings& settings, float* depth);

}  // namespace octomarch_bench

/// The marches of one ISA, each null where the object library has none. Declared once per ISA by bindings.cpp.
#define OCTOMARCH_BENCH_DECLARE(isa)     \
  namespace octomarch_bench::isa {       \
  March scalar_march(SceneName scene);   \
  March skipping_march(SceneName scene); \
  March packet_march(SceneName scene);   \
  March block_march(SceneName scene);    \
  }
