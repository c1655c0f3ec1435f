// What a march is for: finding hits, or finding how much of a light passes. A task sees each step's samples and says what
// became of a packet when it retires. packets.hpp comes before, march.hpp runs them.
#pragma once

#include "octomarch/kernels/packets.hpp"
#include "octomarch/kernels/steps.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

/// Finds hits. Carried, for the secant finish: r of the last sample that was no hit; for bisection: its t.
template <class Real, class Steps, Finish kFinish>
struct HitTask {
  using T = Lanes<Real>;
  MarchOutput<Real> out;
  Steps way;

  static constexpr Real kFirstCarried = 0;
  std::int32_t* steps() const { return out.steps; }

  void observe(BlockState<Real>& state, std::size_t lane, const T& t, const T& r, const Mask<Real>& goes_on) const {
    if constexpr (kFinish != Finish::kNone) {
      const T& kept = kFinish == Finish::kSecant ? r : t;
      select(goes_on, kept, T::load(state.carried + lane)).store(state.carried + lane);
    }
  }

  /// Writes what became of the rays of one slot, of which those that are still live have spent their steps. `field`:
  /// values of the block's last step. Not inline: between the steps it costs them registers on AVX-512.
  [[gnu::noinline]] void retire(const Block<Real>& block, const Real* field, const T& step_scale, std::size_t slot,
                                std::size_t valid) const {
    alignas(kAlignment) Real results[kLanes];
    alignas(kAlignment) Real unfinished[kLanes];
    alignas(kAlignment) Real statuses[kLanes];
    const BlockState<Real>& state = block.state;
    for (std::size_t lane = first_batch_lane<Real>(slot); lane < (slot + 1) * kPacketLanes; lane += kWidth<Real>) {
      const T t = T::load(state.t + lane);
      const T t_max = T::load(state.t_max + lane);
      const Mask<Real> hit = t <= t_max;  // what ended otherwise is beyond t_max, or NaN
      const Mask<Real> inside = t == way.start();
      const T nowhere = std::numeric_limits<Real>::infinity();
      if constexpr (kFinish == Finish::kSecant) {
        const T end = finished(t, T::load(field + lane) * step_scale, T::load(state.carried + lane), t_max);
        select(hit, select(inside, t, end), nowhere).store(results + lane);
        select(hit, t, nowhere).store(unfinished + lane);
      } else {
        select(hit, t, nowhere).store(results + lane);
      }
      if constexpr (kFinish == Finish::kBisection) {
        const T outside = way.outside(T::load(state.carried + lane), t, T::load(state.epsilon + lane));
        select(hit, select(inside, t, outside), nowhere).store(unfinished + lane);
      }
      const T found = select(inside, T(kInside), T(kHit));
      const T lost = select(t > t_max, T(kMiss), T(kInvalid));
      select(hit, found, lost).store(statuses + lane);
    }
    const std::size_t lane = slot * kPacketLanes;
    const std::uint64_t spent = block.live >> lane & 0xFFU;
    for (std::size_t i = 0; spent != 0 && i < kPacketLanes; ++i) {
      if ((spent >> i & 1U) == 0) continue;
      results[lane + i] = unfinished[lane + i] = state.t[lane + i];
      statuses[lane + i] = kStepLimit;
    }
    copy_packet(out.t + block.first_ray[slot], results + lane, valid);
    if constexpr (kFinish != Finish::kNone)
      copy_packet(out.unfinished + block.first_ray[slot], unfinished + lane, valid);
    if (out.status == nullptr) return;
    std::uint8_t codes[kPacketLanes];
    for (std::size_t i = 0; i < kPacketLanes; ++i) codes[i] = static_cast<std::uint8_t>(statuses[lane + i]);
    copy_packet(out.status + block.first_ray[slot], codes, valid);
  }

 private:
  // values of octomarch::Status, which kernels do not include
  static constexpr Real kHit = 0, kMiss = 1, kStepLimit = 2, kInside = 3, kInvalid = 4;

  /// The root of the secant through the last two samples, trusted for 32 times the last distance at the most, and not
  /// at all where the field did not fall between them.
  T finished(const T& t, const T& r, const T& previous, const T& t_max) const {
    const T apart = way.length(previous, T(Real(0)));
    const T root = select(r < previous, r * apart / (previous - r), T(Real(0)));
    const T farthest = T(Real(32)) * max(r, T(Real(0)));
    return min(t + min(root, farthest), t_max);
  }
};

/// Finds how much of a light passes. Carried: the visibility so far.
template <class Real>
struct ShadowTask {
  using T = Lanes<Real>;
  Real* visibility;
  T k;

  static constexpr Real kFirstCarried = 1;
  std::int32_t* steps() const { return nullptr; }

  void observe(BlockState<Real>& state, std::size_t lane, const T& t, const T& r, const Mask<Real>& /*goes_on*/) const {
    const T so_far = T::load(state.carried + lane);
    const T penumbra = min(k * r / t, so_far);
    select(t <= T::load(state.t_max + lane), penumbra, so_far).store(state.carried + lane);
  }

  /// A ray that ended within t_max has hit something.
  void retire(const Block<Real>& block, const Real* /*field*/, const T& /*step_scale*/, std::size_t slot,
              std::size_t valid) const {
    Real* const out = visibility + block.first_ray[slot];
    const std::size_t lane = slot * kPacketLanes;
    for (std::size_t i = 0; i < valid; ++i) {
      const bool blocked =
          block.state.t[lane + i] <= block.state.t_max[lane + i] && (block.live >> (lane + i) & 1U) == 0;
      const Real passed = block.state.carried[lane + i];
      out[i] = blocked || passed < Real(0) ? Real(0) : passed;
    }
  }
};

}  // namespace octomarch::kernels::OCTOMARCH_ISA
