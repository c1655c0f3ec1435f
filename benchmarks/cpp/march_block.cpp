// Refilled blocks of eight packets with xsimd by hand and the field fused: the practical limit that the engine is held
// against. A packet is 4×2 rays; when all of them are done, its slot takes the next packet of the picture.
// scenes.hpp comes before it; bindings.cpp calls it.
//
// What makes it fast: the batches of a block are independent, so that the processor overlaps their latencies; a finished
// lane needs no stored mask; and the block is marched as two halves, each looked at while the other is in flight, so
// that the mispredicted branch of a retirement finds work to overlap with.
#include <bit>
#include <cstring>
#include <limits>

#include "scenes.hpp"

namespace octomarch_bench::OCTOMARCH_BENCH_ISA {
namespace {

using Batch = xsimd::batch<float, OCTOMARCH_BENCH_ARCH>;

/// Batches for one packet: AVX-512 is wider than that.
#ifdef __AVX512F__
using Narrow = xsimd::batch<float, xsimd::avx2>;
#else
using Narrow = Batch;
#endif

constexpr int kLanes = static_cast<int>(Batch::size);
constexpr int kNarrow = static_cast<int>(Narrow::size);
constexpr int kPacketWidth = 4;
constexpr int kPacketHeight = 2;
constexpr int kRays = kPacketWidth * kPacketHeight;
constexpr int kSlots = 4;  // packets in half a block
constexpr int kHalf = kSlots * kRays;

/// Half a block. A slot is a byte of `live` and of `vacant`.
struct Half {
  alignas(64) float t[kHalf] = {};
  alignas(64) float dx[kHalf] = {};
  alignas(64) float dy[kHalf] = {};
  alignas(64) float dz[kHalf] = {};
  std::ptrdiff_t pixel[kSlots] = {};  // index of the upper left pixel of the packet
  int start[kSlots] = {};             // value of `steps` when the slot was filled
  int steps = 0;                      // made by this half so far
  int deadline = 0;                   // no slot reaches the step limit before `steps` is this
  std::uint32_t live = ~0u;           // per lane, as of the last step
  std::uint32_t vacant = 0;           // all bits of a slot that got no packet
};

/// The packets of a picture, row by row.
struct Packets {
  explicit Packets(const Frame& picture) : frame(picture) {}

  /// Puts the next packet into a slot, or leaves the slot vacant and returns false.
  OCTOMARCH_BENCH_INLINE bool fill(Half& half, int slot) {
    if (j >= frame.height) {
      half.vacant |= 0xFFu << (8 * slot);
      return false;
    }
    for (int lane = 0; lane < kRays; lane += kNarrow) {
      const auto d = direction(frame, Narrow::load_aligned(centres.columns + lane) + Narrow(static_cast<float>(i)),
                               Narrow::load_aligned(centres.rows + lane) + Narrow(static_cast<float>(j)));
      d.x.store_aligned(half.dx + slot * kRays + lane);
      d.y.store_aligned(half.dy + slot * kRays + lane);
      d.z.store_aligned(half.dz + slot * kRays + lane);
      Narrow(0.0f).store_aligned(half.t + slot * kRays + lane);
    }
    half.pixel[slot] = static_cast<std::ptrdiff_t>(j) * frame.width + i;
    half.start[slot] = half.steps;
    i += kPacketWidth;
    if (i >= frame.width) {
      i = 0;
      j += kPacketHeight;
    }
    return true;
  }

  const Frame& frame;
  int i = 0;
  int j = 0;
  const PixelCentres<kPacketWidth, kPacketHeight> centres;
};

/// The settings as batches, made once so that the compiler keeps them in registers where it has enough.
struct Constants {
  Direction<Batch> eye;
  Batch epsilon;
  Batch farthest;
};

/// One step of all rays of a half.
template <class Scene>
OCTOMARCH_BENCH_INLINE void advance(Half& half, const Constants& constants) {
  const auto& [eye, epsilon, farthest] = constants;
  std::uint32_t live = 0;
  for (int lane = 0; lane < kHalf; lane += kLanes) {
    const Batch t = Batch::load_aligned(half.t + lane);
    const Batch r =
        Scene::field(eye.x + t * Batch::load_aligned(half.dx + lane), eye.y + t * Batch::load_aligned(half.dy + lane),
                     eye.z + t * Batch::load_aligned(half.dz + lane));
    // A finished lane needs no mask: a hit keeps t and hits again, a miss stays beyond the farthest t.
    const auto hit = r < larger(epsilon, Batch(kUlpFloor) * t);
    const Batch next = xsimd::select(hit, t, t + r);
    next.store_aligned(half.t + lane);
    live |= static_cast<std::uint32_t>(xsimd::bitwise_andnot(next <= farthest, hit).mask()) << lane;
  }
  half.live = live;
  ++half.steps;
}

/// Bit 7 of each slot whose packet has made all its steps. Rare, hence out of line; sets the next deadline.
[[gnu::noinline, gnu::cold]] std::uint32_t overdue_slots(Half& half, int max_steps) {
  std::uint32_t overdue = 0;
  half.deadline = half.steps + max_steps;
  for (int slot = 0; slot < kSlots; ++slot) {
    const int limit = half.start[slot] + max_steps;
    if (((half.vacant >> (8 * slot)) & 1u) != 0) continue;
    if (half.steps >= limit) {
      overdue |= 0x80u << (8 * slot);
    } else if (limit < half.deadline) {
      half.deadline = limit;
    }
  }
  return overdue;
}

/// Bit 7 of each slot whose packet is done: a byte without a live lane, or the step limit. Vacant slots count as busy;
/// written with `or` and one `not`, because GCC moves an and-not of integers to the mask registers of AVX-512, where it
/// waits behind the vector code (7 % of the whole march).
OCTOMARCH_BENCH_INLINE std::uint32_t done_slots(Half& half, int max_steps) {
  constexpr std::uint32_t kLow = 0x7F7F7F7Fu;
  const std::uint32_t busy = half.live | half.vacant;
  std::uint32_t done = ~(((busy & kLow) + kLow) | busy | kLow);
  if (half.steps >= half.deadline) [[unlikely]] {
    done |= overdue_slots(half, max_steps);
  }
  return done;
}

/// Writes t of a finished packet.
OCTOMARCH_BENCH_INLINE void write(const Half& half, int slot, float max_distance, float* depth, int width) {
  alignas(64) float values[kRays];
  for (int lane = 0; lane < kRays; lane += kNarrow) {
    const Narrow t = Narrow::load_aligned(half.t + slot * kRays + lane);
    xsimd::select(t <= Narrow(max_distance), t, Narrow(std::numeric_limits<float>::infinity()))
        .store_aligned(values + lane);
  }
  for (int row = 0; row < kPacketHeight; ++row) {
    std::memcpy(depth + half.pixel[slot] + static_cast<std::ptrdiff_t>(row) * width, values + row * kPacketWidth,
                kPacketWidth * sizeof(float));
  }
}

template <class Scene>
std::int64_t march(const Frame& frame, const Settings& settings, float* depth) {
  const Constants constants{{Batch(frame.eye[0]), Batch(frame.eye[1]), Batch(frame.eye[2])},
                            Batch(settings.epsilon),
                            Batch(settings.max_distance)};
  Packets packets(frame);
  Half halves[2];
  int running = 0;
  for (Half& half : halves) {
    half.deadline = settings.max_steps;
    for (int slot = 0; slot < kSlots; ++slot) {
      if (packets.fill(half, slot)) ++running;
    }
  }
  // Marches one half, then lets packets of the other leave; returns how many slots stay vacant.
  const auto turn = [&](Half& marched, Half& other) __attribute__((always_inline)) {
    int ended = 0;
    advance<Scene>(marched, constants);
    for (std::uint32_t done = done_slots(other, settings.max_steps); done != 0; done &= done - 1) {
      const int slot = std::countr_zero(done) / 8;
      write(other, slot, settings.max_distance, depth, frame.width);
      if (!packets.fill(other, slot)) ++ended;
    }
    return ended;
  };
  while (running > 0) {
    running -= turn(halves[0], halves[1]);
    running -= turn(halves[1], halves[0]);
  }
  return (std::int64_t{halves[0].steps} + halves[1].steps) * kHalf;
}

}  // namespace

March block_march(SceneName scene) { return scene == SceneName::kA ? march<SceneA> : march<SceneB>; }

}  // namespace octomarch_bench::OCTOMARCH_BENCH_ISA
