// Operators that move points before a field is taken there: rotation into a child's frame, and repetition.
#pragma once

#include "octomarch/ops/number.hpp"

namespace octomarch::ops {

/// q = M·p + t, M a rotation. Constants: M row by row, t after each row (12).
template <class C>
struct Rotate {
  C m[12];
  template <class Real>
  explicit Rotate(const Real* p)
      : m{C(p[0]), C(p[1]), C(p[2]), C(p[3]), C(p[4]), C(p[5]), C(p[6]), C(p[7]), C(p[8]), C(p[9]), C(p[10]), C(p[11])} {}

  template <class T>
  Triple<T> operator()(const T& x, const T& y, const T& z) const {
    return {x * m[0] + y * m[1] + z * m[2] + m[3], x * m[4] + y * m[5] + z * m[6] + m[7],
            x * m[8] + y * m[9] + z * m[10] + m[11]};
  }
};

/// Repetition along one coordinate: the position within the nearest cell, (p − offset) − period·cell, where
/// cell = clamp(floor((p − offset)/period + shift) + centre, −limit, limit). An endless repeat has an infinite limit.
/// Constants: offset, period, 1/period, shift, centre, limit. The derivative is that of p within a cell.
template <class C>
struct RepeatAxis {
  C offset, period, inverse, shift, centre, limit;
  template <class Real>
  explicit RepeatAxis(const Real* p)
      : offset(p[0]), period(p[1]), inverse(p[2]), shift(p[3]), centre(p[4]), limit(p[5]) {}

  C clamped(const C& cell) const { return min(max(cell, -limit), limit); }
  C cell(const C& p) const { return clamped(floor(p * inverse + shift) + centre); }

  template <class T>
  T operator()(const T& x) const {
    const T p = x - offset;
    return p - cell(value_of(p)) * period;
  }
};

/// Repetition along all three coordinates. Constants: those of RepeatAxis for x, y and z (18).
template <class C>
struct Repeat {
  RepeatAxis<C> rx, ry, rz;
  template <class Real>
  explicit Repeat(const Real* p) : rx(p), ry(p + 6), rz(p + 12) {}

  template <class T>
  Triple<T> operator()(const T& x, const T& y, const T& z) const {
    return {rx(x), ry(y), rz(z)};
  }
};

/// The position within the next cell on the side where the point lies in its own: what repeats content that is not
/// mirror-symmetric must look at too. Constants: those of RepeatAxis.
template <class C>
struct RepeatNeighbour {
  RepeatAxis<C> axis;
  C zero, one;
  template <class Real>
  explicit RepeatNeighbour(const Real* p) : axis(p), zero(Real(0)), one(Real(1)) {}

  template <class T>
  T operator()(const T& x) const {
    const T p = x - axis.offset;
    const C own = axis.cell(value_of(p));
    const C side = select(value_of(p) - own * axis.period < zero, -one, one);
    return p - axis.clamped(own + side) * axis.period;
  }
};

}  // namespace octomarch::ops
