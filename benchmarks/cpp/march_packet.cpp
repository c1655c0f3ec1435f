// One packet of rays at a time with xsimd by hand: what most people would write first. A packet is 4×2 rays, two batches
// on SSE2 and one on AVX2; on AVX-512 it is 4×4, one batch, since half a register would be too easy an opponent.
// scenes.hpp comes before it; bindings.cpp calls it.
#include <cstring>
#include <limits>

#include "scenes.hpp"

namespace octomarch_bench::OCTOMARCH_BENCH_ISA {
namespace {

using Batch = xsimd::batch<float, OCTOMARCH_BENCH_ARCH>;

constexpr int kLanes = static_cast<int>(Batch::size);
constexpr int kPacketWidth = 4;
constexpr int kPacketHeight = kLanes > 8 ? 4 : 2;
constexpr int kRays = kPacketWidth * kPacketHeight;
constexpr int kBatches = kRays / kLanes;

using Centres = PixelCentres<kPacketWidth, kPacketHeight>;

/// Marches the packet with its upper left corner at pixel (i, j) and returns the steps it took.
template <class Scene>
OCTOMARCH_BENCH_INLINE int march_one(const Frame& frame, const Settings& settings, const Centres& centres, int i, int j,
                                     float* values) {
  const Direction<Batch> eye{Batch(frame.eye[0]), Batch(frame.eye[1]), Batch(frame.eye[2])};
  const Batch epsilon(settings.epsilon);
  const Batch farthest(settings.max_distance);
  Batch t[kBatches];
  Direction<Batch> d[kBatches];
  for (int b = 0; b < kBatches; ++b) {
    t[b] = Batch(0.0f);
    d[b] = direction(frame, Batch::load_aligned(centres.columns + b * kLanes) + Batch(static_cast<float>(i)),
                     Batch::load_aligned(centres.rows + b * kLanes) + Batch(static_cast<float>(j)));
  }
  int steps = 0;
  for (bool live = true; live && steps < settings.max_steps; ++steps) {
    live = false;
    for (int b = 0; b < kBatches; ++b) {
      const Batch r = Scene::field(eye.x + t[b] * d[b].x, eye.y + t[b] * d[b].y, eye.z + t[b] * d[b].z);
      // A finished lane needs no mask: a hit keeps t and hits again, a miss stays beyond the farthest t.
      const auto hit = r < larger(epsilon, Batch(kUlpFloor) * t[b]);
      t[b] = xsimd::select(hit, t[b], t[b] + r);
      live |= xsimd::any(xsimd::bitwise_andnot(t[b] <= farthest, hit));
    }
  }
  const Batch infinity(std::numeric_limits<float>::infinity());
  for (int b = 0; b < kBatches; ++b) {
    xsimd::select(t[b] <= farthest, t[b], infinity).store_aligned(values + b * kLanes);
  }
  return steps;
}

template <class Scene>
std::int64_t march(const Frame& frame, const Settings& settings, float* depth) {
  const Centres centres;
  std::int64_t evaluations = 0;
  for (int j = 0; j < frame.height; j += kPacketHeight) {
    for (int i = 0; i < frame.width; i += kPacketWidth) {
      alignas(64) float values[kRays];
      evaluations += std::int64_t{march_one<Scene>(frame, settings, centres, i, j, values)} * kRays;
      for (int row = 0; row < kPacketHeight; ++row) {
        std::memcpy(depth + static_cast<std::ptrdiff_t>(j + row) * frame.width + i, values + row * kPacketWidth,
                    kPacketWidth * sizeof(float));
      }
    }
  }
  return evaluations;
}

}  // namespace

March packet_march(SceneName scene) { return scene == SceneName::kA ? march<SceneA> : march<SceneB>; }

}  // namespace octomarch_bench::OCTOMARCH_BENCH_ISA
