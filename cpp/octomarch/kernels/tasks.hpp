// What a march is for: finding hits, or finding how much of a light passes. A task sees each step's samples, and what it
// carries from step to step stays with the ray. steps.hpp comes before, march.hpp runs them, finish.hpp reads what is left.
#pragma once

#include "octomarch/kernels/steps.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

/// Finds hits. Carried, for the secant finish: r of the last sample that was no hit; for bisection: its t.
template <class Real, class Steps, Finish kFinish>
struct HitTask {
  using T = Lanes<Real>;
  static constexpr bool kIsRelaxed = Steps::kIsRelaxed;
  static constexpr bool kCarries = kFinish != Finish::kNone || kIsRelaxed;

  void observe(BlockState<Real>& state, std::size_t lane, const T& t, const T& r, const T& /*t_max*/,
               const Mask<Real>& goes_on) const {
    if constexpr (kFinish != Finish::kNone && !kIsRelaxed) {
      const T& kept = kFinish == Finish::kSecant ? r : t;
      select(goes_on, kept, T::load(state.carried + lane)).store(state.carried + lane);
    }
  }
};

/// Finds how much of a light passes. The visibility so far is carried, or takes the place of the boldness that these long steps
/// do without. Samples from which a long step goes back count too: they are of the ray.
template <class Real, class Steps>
struct ShadowTask {
  using T = Lanes<Real>;
  static constexpr bool kIsRelaxed = Steps::kIsRelaxed;
  static constexpr bool kCarries = true;
  T k;

  void observe(BlockState<Real>& state, std::size_t lane, const T& t, const T& r, const T& t_max,
               const Mask<Real>& /*goes_on*/) const {
    Real* const seen = (kIsRelaxed ? state.boldness : state.carried) + lane;
    const T so_far = T::load(seen);
    const T penumbra = min(k * r / t, so_far);
    select(t <= t_max, penumbra, so_far).store(seen);
  }
};

}  // namespace octomarch::kernels::OCTOMARCH_ISA
