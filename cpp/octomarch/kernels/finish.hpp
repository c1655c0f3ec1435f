// The check of the secant finish, over all rays of a march at once. march.hpp runs it last.
#pragma once

#include "octomarch/kernels/evaluate.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

/// Takes back what the secant finish got wrong. On a surface it all but closes the gap; where a sixteenth of the hit
/// epsilon is left, a ray that only grazes an edge was sent past it, and the sample before stands. One evaluation for
/// each finished ray.
template <class Real>
void check_finish(const TapeView<Real>& tape, Real* registers, const RayView<Real>& rays,
                  const MarchParameters<Real>& parameters, const MarchOutput<Real>& out, Counters& counters) {
  using T = Lanes<Real>;
  alignas(kAlignment) Real t[kLanes];
  alignas(kAlignment) Real unfinished[kLanes];
  alignas(kAlignment) Real epsilon[kLanes];
  alignas(kAlignment) Real origin[kLanes];
  alignas(kAlignment) Real direction[kLanes];
  const Column<Real>* const origins[] = {&rays.ox, &rays.oy, &rays.oz};
  const Column<Real>* const directions[] = {&rays.dx, &rays.dy, &rays.dz};
  for (std::size_t first = 0; first < rays.count; first += kLanes) {
    if (is_set(parameters.cancelled)) return;
    const std::size_t left = rays.count - first;
    const std::size_t lanes = left < kLanes ? left : kLanes;
    const std::size_t count = batches<Real>(lanes);
    const auto copy = [&](Real* row, const Column<Real>& column) {
      if (column.values == nullptr) {
        for (std::size_t i = 0; i < kLanes; ++i) row[i] = column.value;
      } else if (lanes == kLanes) {
        __builtin_memcpy(row, column.values + first, kLanes * sizeof(Real));
      } else {
        for (std::size_t i = 0; i < kLanes; ++i) row[i] = i < lanes ? column.values[first + i] : Real(0);
      }
    };
    copy(t, {out.t, 0});
    copy(unfinished, {out.unfinished, 0});
    std::uint64_t changed = 0;
    for_each_batch<Real>(count, [&](std::size_t lane) {
      changed |= (!(T::load(t + lane) == T::load(unfinished + lane))).bits() << lane;
    });
    if (changed == 0) continue;
    copy(epsilon, rays.epsilon);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      copy(origin, *origins[axis]);
      copy(direction, *directions[axis]);
      for_each_batch<Real>(count, [&](std::size_t lane) {
        (T::load(origin + lane) + T::load(t + lane) * T::load(direction + lane))
            .store(registers + axis * kLanes + lane);
      });
    }
    const Real* const field = evaluate(tape, registers, count);
    counters.evaluations += static_cast<std::uint64_t>(__builtin_popcountll(changed));
    counters.lane_slots += count * kWidth<Real>;
    for_each_batch<Real>(count, [&](std::size_t lane) {
      const T end = T::load(t + lane);
      const T r = T::load(field + lane) * T(parameters.step_scale);
      const T hit_epsilon = max(T::load(epsilon + lane), T(parameters.epsilon_slope) * end);
      const Mask<Real> kept = abs(r) <= hit_epsilon * T(Real(0.0625));
      select(kept, end, T::load(unfinished + lane)).store(t + lane);
    });
    for (std::size_t i = 0; i < lanes; ++i) out.t[first + i] = t[i];
  }
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
