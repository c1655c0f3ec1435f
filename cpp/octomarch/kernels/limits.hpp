// What is known of rays without their field: where they meet planes, and where they are within bounds. Closed forms, before and
// after a march of what is left (march.hpp).
#pragma once

#include <limits>

#include "octomarch/kernels/finish.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

/// A plane's distance along the ray is offset + t·slope.
template <class Real>
struct AlongRay {
  Lanes<Real> offset;
  Lanes<Real> slope;
};

template <class Real>
AlongRay<Real> along(const Real* plane, const RayView<Real>& rays, std::size_t i) {
  using T = Lanes<Real>;
  const T x = plane[0];
  const T y = plane[1];
  const T z = plane[2];
  return {x * at(rays.ox, i) + y * at(rays.oy, i) + z * at(rays.oz, i) + T(plane[3]),
          x * at(rays.dx, i) + y * at(rays.dy, i) + z * at(rays.dz, i)};
}

template <class Real>
void meet_planes(const PlanesView<Real>& planes, const RayView<Real>& rays, const MarchParameters<Real>& parameters,
                 Real* met, Real* end) {
  using T = Lanes<Real>;
  const T t_min = parameters.t_min;
  const T infinity = std::numeric_limits<Real>::infinity();
  for (std::size_t i = 0; i < rays.count; i += kWidth<Real>) {
    const T epsilon = max(at(rays.epsilon, i), T(parameters.epsilon_slope) * t_min);
    T first = infinity;
    for (std::size_t k = 0; k < planes.count; ++k) {
      const AlongRay<Real> line = along(planes.equations + 4 * k, rays, i);
      const T crossing = select(line.slope < T(Real(0)), max(line.offset / -line.slope, t_min), infinity);
      const Mask<Real> is_inside = line.offset + t_min * line.slope <= epsilon;
      first = min(select(is_inside, t_min, crossing), first);
    }
    first.store(met + i);
    min(first, at(rays.t_max, i)).store(end + i);
  }
}

/// Sets those of a block's kLanes bytes whose bit is set.
inline void set_bytes(std::uint8_t* bytes, std::uint64_t bits, std::uint8_t value) {
  if (bits == ~std::uint64_t{0}) {
    __builtin_memset(bytes, value, kLanes);
    return;
  }
  for (; bits != 0; bits &= bits - 1) bytes[__builtin_ctzll(bits)] = value;
}

template <class Real>
void take_planes(const RayView<Real>& rays, const MarchParameters<Real>& parameters, const Real* met,
                 const MarchState<Real>& state, std::uint8_t* status) {
  using T = Lanes<Real>;
  for_each_block(rays.count, status, kMiss, [&](std::size_t first, std::uint64_t misses) {
    std::uint64_t hits = 0;
    std::uint64_t inside = 0;
    for (std::size_t lane = 0; misses != 0 && lane < kLanes; lane += kWidth<Real>) {
      const std::size_t i = first + lane;
      const T t = T::load(met + i);
      const Mask<Real> meets = Mask<Real>::from_bits(misses >> lane) & (t <= at(rays.t_max, i));
      select(meets, t, T::load(state.t + i)).store(state.t + i);
      const Mask<Real> is_inside = meets & (t <= T(parameters.t_min));
      inside |= is_inside.bits() << lane;
      hits |= (meets & !is_inside).bits() << lane;
    }
    set_bytes(status + first, hits, kHit);
    set_bytes(status + first, inside, kInside);
  });
}

template <class Real>
void dim_by_planes(const PlanesView<Real>& planes, const RayView<Real>& rays, const MarchParameters<Real>& parameters,
                   Real* visibility) {
  using T = Lanes<Real>;
  const T k = parameters.k;
  const T zero = Real(0);
  for (std::size_t i = 0; i < rays.count; i += kWidth<Real>) {
    const T t_max = at(rays.t_max, i);
    T seen = T::load(visibility + i);
    for (std::size_t plane = 0; plane < planes.count; ++plane) {
      const AlongRay<Real> line = along(planes.equations + 4 * plane, rays, i);
      const T far_end = line.offset + t_max * line.slope;
      const Mask<Real> is_blocked = (line.offset <= zero) | (far_end <= zero);
      seen = select(is_blocked, zero, min(k * far_end / t_max, seen));
    }
    seen.store(visibility + i);
  }
}

template <class Real>
void clip_rays(const Region<Real>& box, Real widening, Real epsilon_slope, const RayView<Real>& rays, Real* start,
               Real* end) {
  using T = Lanes<Real>;
  const T room_for_hits = Real(4);
  const T growth = widening + Real(4) * epsilon_slope;
  const T zero = Real(0);
  for (std::size_t i = 0; i < rays.count; i += kWidth<Real>) {
    const T room = room_for_hits * at(rays.epsilon, i);
    T enter = at(rays.start, i);
    T leave = at(rays.t_max, i);
    // t·rate ≥ least; a zero rate makes an infinity of the right sign, or a NaN, which limits nothing
    const auto limit = [&](const T& least, const T& rate) {
      const T t = least / rate;
      enter = select(rate < zero, enter, max(t, enter));
      leave = select(rate < zero, min(t, leave), leave);
    };
    const auto clip = [&](const T& o, const T& d, Real lo, Real hi) {
      limit(T(lo) - room - o, d + growth);
      limit(o - T(hi) - room, growth - d);
    };
    clip(at(rays.ox, i), at(rays.dx, i), box.lo[0], box.hi[0]);
    clip(at(rays.oy, i), at(rays.dy, i), box.lo[1], box.hi[1]);
    clip(at(rays.oz, i), at(rays.dz, i), box.lo[2], box.hi[2]);
    const Mask<Real> passes_by = enter > leave;
    select(passes_by, at(rays.start, i), enter).store(start + i);
    select(passes_by, T(Real(-1)), leave).store(end + i);
  }
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
