// One ray at a time in plain C++, the field inlined, out of the loop at the first hit or miss: what the engine's speed is
// counted against. scenes.hpp comes before it; bindings.cpp calls it.
#include <limits>

#include "scenes.hpp"

namespace octomarch_bench::OCTOMARCH_BENCH_ISA {
namespace {

template <class Scene>
std::int64_t march(const Frame& frame, const Settings& settings, float* depth) {
  const float eye_x = frame.eye[0];
  const float eye_y = frame.eye[1];
  const float eye_z = frame.eye[2];
  const float epsilon = settings.epsilon;
  std::int64_t evaluations = 0;
  for (int j = 0; j < frame.height; ++j) {
    for (int i = 0; i < frame.width; ++i) {
      const auto d = direction(frame, static_cast<float>(i) + 0.5f, static_cast<float>(j) + 0.5f);
      float t = 0.0f;
      int steps = 0;
      while (steps < settings.max_steps) {
        const float r = Scene::field(eye_x + t * d.x, eye_y + t * d.y, eye_z + t * d.z);
        ++steps;
        if (r < larger(epsilon, kUlpFloor * t)) break;
        t += r;
        // False for a NaN as well, so that an invalid field ends the ray at once.
        if (!(t <= settings.max_distance)) {
          t = std::numeric_limits<float>::infinity();
          break;
        }
      }
      depth[static_cast<std::ptrdiff_t>(j) * frame.width + i] = t;
      evaluations += steps;
    }
  }
  return evaluations;
}

}  // namespace

March scalar_march(SceneName scene) { return scene == SceneName::kA ? march<SceneA> : march<SceneB>; }

March skipping_march(SceneName scene) { return scene == SceneName::kA ? march<SceneASkipping> : march<SceneBSkipping>; }

}  // namespace octomarch_bench::OCTOMARCH_BENCH_ISA
