// The end of a march: the check of the secant finish, and bisection, over all rays of a march at once. march.hpp runs one
// of them last.
#pragma once

#include "octomarch/kernels/evaluate.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

/// A block of rays after their march, of which some are to be finished: those whose t and `unfinished` differ.
template <class Real>
struct FinishBlock {
  using T = Lanes<Real>;
  const std::size_t first;
  const std::size_t lanes;  ///< that hold a ray
  const std::size_t count;  ///< batches of them
  std::uint64_t changed = 0;
  alignas(kAlignment) Real t[kLanes];
  alignas(kAlignment) Real unfinished[kLanes];
  alignas(kAlignment) Real epsilon[kLanes];
  alignas(kAlignment) Real origin[3][kLanes];
  alignas(kAlignment) Real direction[3][kLanes];

  /// Takes the block that begins at a ray.
  FinishBlock(const RayView<Real>& rays, const MarchOutput<Real>& out, std::size_t ray)
      : first(ray), lanes(rays.count - ray < kLanes ? rays.count - ray : kLanes), count(batches<Real>(lanes)) {
    copy(t, {out.t, 0});
    copy(unfinished, {out.unfinished, 0});
    for_each_batch<Real>(count, [&](std::size_t lane) { changed |= is_changed(lane).bits() << lane; });
    if (changed == 0) return;
    copy(epsilon, rays.epsilon);
    copy(origin[0], rays.ox);
    copy(origin[1], rays.oy);
    copy(origin[2], rays.oz);
    copy(direction[0], rays.dx);
    copy(direction[1], rays.dy);
    copy(direction[2], rays.dz);
  }

  Mask<Real> is_changed(std::size_t lane) const { return !(T::load(t + lane) == T::load(unfinished + lane)); }

  /// The field at parameter `at` of each ray. One evaluation for each that changed.
  const Real* field(const TapeView<Real>& tape, Real* registers, const Real* at, Counters& counters) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for_each_batch<Real>(count, [&](std::size_t lane) {
        (T::load(origin[axis] + lane) + T::load(at + lane) * T::load(direction[axis] + lane))
            .store(registers + axis * kLanes + lane);
      });
    }
    counters.evaluations += static_cast<std::uint64_t>(__builtin_popcountll(changed));
    counters.lane_slots += count * kWidth<Real>;
    return evaluate(tape, registers, count);
  }

  void write_back(const MarchOutput<Real>& out) const {
    for (std::size_t i = 0; i < lanes; ++i) out.t[first + i] = t[i];
  }

  void copy(Real* row, const Column<Real>& column) const {
    if (column.values == nullptr) {
      for (std::size_t i = 0; i < kLanes; ++i) row[i] = column.value;
    } else if (lanes == kLanes) {
      __builtin_memcpy(row, column.values + first, kLanes * sizeof(Real));
    } else {
      for (std::size_t i = 0; i < kLanes; ++i) row[i] = i < lanes ? column.values[first + i] : Real(0);
    }
  }
};

/// Takes back what the secant finish got wrong. On a surface it all but closes the gap; where a sixteenth of the hit
/// epsilon is left, a ray that only grazes an edge was sent past it, and the sample before stands. One evaluation for
/// each finished ray.
template <class Real>
void check_secant(const TapeView<Real>& tape, Real* registers, const RayView<Real>& rays,
                  const MarchParameters<Real>& parameters, const MarchOutput<Real>& out, Counters& counters) {
  using T = Lanes<Real>;
  for (std::size_t first = 0; first < rays.count; first += kLanes) {
    if (is_set(parameters.cancelled)) return;
    FinishBlock<Real> block(rays, out, first);
    if (block.changed == 0) continue;
    const Real* const field = block.field(tape, registers, block.t, counters);
    for_each_batch<Real>(block.count, [&](std::size_t lane) {
      const T end = T::load(block.t + lane);
      const T r = T::load(field + lane) * T(parameters.step_scale);
      const T hit_epsilon = max(T::load(block.epsilon + lane), T(parameters.epsilon_slope) * end);
      const Mask<Real> kept = abs(r) <= hit_epsilon * T(Real(0.0625));
      select(kept, end, T::load(block.unfinished + lane)).store(block.t + lane);
    });
    block.write_back(out);
  }
}

/// Halves the way from `unfinished`, outside, to t, the first sample inside, until a 1024th of it is left; t becomes its end
/// outside. Ten evaluations for each ray.
template <class Real>
void bisect(const TapeView<Real>& tape, Real* registers, const RayView<Real>& rays,
            const MarchParameters<Real>& parameters, const MarchOutput<Real>& out, Counters& counters) {
  using T = Lanes<Real>;
  constexpr int kHalvings = 10;
  alignas(kAlignment) Real outside[kLanes];
  alignas(kAlignment) Real inside[kLanes];
  alignas(kAlignment) Real middle[kLanes];
  for (std::size_t first = 0; first < rays.count; first += kLanes) {
    FinishBlock<Real> block(rays, out, first);
    if (block.changed == 0) continue;
    __builtin_memcpy(outside, block.unfinished, sizeof(outside));
    __builtin_memcpy(inside, block.t, sizeof(inside));
    for (int i = 0; i < kHalvings; ++i) {
      if (is_set(parameters.cancelled)) return;
      for_each_batch<Real>(block.count, [&](std::size_t lane) {
        const T from = T::load(outside + lane);
        (from + (T::load(inside + lane) - from) * T(Real(0.5))).store(middle + lane);
      });
      const Real* const field = block.field(tape, registers, middle, counters);
      for_each_batch<Real>(block.count, [&](std::size_t lane) {
        const Mask<Real> in_solid = T::load(field + lane) * T(parameters.step_scale) <= T(Real(0));
        const T half = T::load(middle + lane);
        select(in_solid, half, T::load(inside + lane)).store(inside + lane);
        select(in_solid, T::load(outside + lane), half).store(outside + lane);
      });
    }
    for_each_batch<Real>(block.count, [&](std::size_t lane) {
      select(block.is_changed(lane), T::load(outside + lane), T::load(block.t + lane)).store(block.t + lane);
    });
    block.write_back(out);
  }
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
