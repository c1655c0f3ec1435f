// Operators that move points before a field is taken there: rotation into a child's frame, and repetition.
#pragma once

#include "octomarch/ops/dual_math.hpp"
#include "octomarch/ops/math.hpp"
#include "octomarch/ops/number.hpp"

namespace octomarch::ops {

/// q = M·p + t, M a rotation. Constants: M row by row, t after each row (12).
template <class C>
struct Rotate {
  C m[12];
  template <class Real>
  explicit Rotate(const Real* p)
      : m{C(p[0]), C(p[1]), C(p[2]), C(p[3]), C(p[4]),  C(p[5]),
          C(p[6]), C(p[7]), C(p[8]), C(p[9]), C(p[10]), C(p[11])} {}

  template <class T>
  Triple<T> operator()(const T& x, const T& y, const T& z) const {
    return {x * m[0] + y * m[1] + z * m[2] + m[3], x * m[4] + y * m[5] + z * m[6] + m[7],
            x * m[8] + y * m[9] + z * m[10] + m[11]};
  }
};

/// Endless repetition along one coordinate: p − period·floor(p/period + shift), the position in the nearest cell. The
/// cells stand where the content is (shift = ½ − centre/period), so it needs no move back to the origin. The derivative
/// is that of p within a cell. Constants: period, 1/period, shift.
template <class C>
struct RepeatAxis {
  C period, inverse, shift;
  template <class Real>
  explicit RepeatAxis(const Real* p) : period(p[0]), inverse(p[1]), shift(p[2]) {}

  C cell(const C& p) const { return floor(p * inverse + shift); }

  template <class T>
  T operator()(const T& p) const {
    return p - cell(value_of(p)) * period;
  }
};

/// The same along all three coordinates. Constants: those of RepeatAxis for x, y and z (9).
template <class C>
struct Repeat {
  RepeatAxis<C> rx, ry, rz;
  template <class Real>
  explicit Repeat(const Real* p) : rx(p), ry(p + 3), rz(p + 6) {}

  auto operator()(const auto& x, const auto& y, const auto& z) const { return Triple{rx(x), ry(y), rz(z)}; }
};

/// A counted repetition: cells are numbered from the middle one, and held within ±limit. Constants: those of
/// RepeatAxis, centre (0, or ½ where the count is even), limit.
template <class C>
struct RepeatCounted {
  RepeatAxis<C> endless;
  C centre, limit;
  template <class Real>
  explicit RepeatCounted(const Real* p) : endless(p), centre(p[3]), limit(p[4]) {}

  C clamped(const C& cell) const { return min(max(cell, -limit), limit); }
  C cell(const C& p) const { return clamped(endless.cell(p) + centre); }

  template <class T>
  T operator()(const T& p) const {
    return p - cell(value_of(p)) * endless.period;
  }
};

/// The position within the next cell on the side where the point lies in its own: what repeats content that is not
/// mirror-symmetric must look at too. Constants: those of RepeatCounted (limit = +inf: endless), middle of the content.
template <class C>
struct RepeatNeighbour {
  RepeatCounted<C> counted;
  C middle, one;
  template <class Real>
  explicit RepeatNeighbour(const Real* p) : counted(p), middle(p[5]), one(Real(1)) {}

  template <class T>
  T operator()(const T& p) const {
    const C own = counted.cell(value_of(p));
    const C side = select(value_of(p) - own * counted.endless.period < middle, -one, one);
    return p - counted.clamped(own + side) * counted.endless.period;
  }
};

/// Cut through 0 and drawn apart: p − clamp(p, −half, half). Constants: half.
template <class C>
struct Elongate {
  C half;
  template <class Real>
  explicit Elongate(const Real* p) : half(p[0]) {}

  template <class T>
  T operator()(const T& p) const {
    return p - min(max(p, -half), half);
  }
};

/// Constants: lo, hi.
template <class C>
struct Clamp {
  C lo, hi;
  template <class Real>
  explicit Clamp(const Real* p) : lo(p[0]), hi(p[1]) {}

  template <class T>
  T operator()(const T& p) const {
    return min(max(p, lo), hi);
  }
};

/// (u, v) pulled to within `radius` of the origin, then turned by `angle(pulled u)`.
template <class T, class C, class Angle>
PlanarPoint<T> turned_within(const T& u, const T& v, const C& radius, const C& one, Angle&& angle) {
  const T factor = min(radius / length(u, v), one);
  const T pulled_u = u * factor;
  const T pulled_v = v * factor;
  const T turn = angle(pulled_u);
  const T c = cos(turn);
  const T s = sin(turn);
  return {c * pulled_u - s * pulled_v, s * pulled_u + c * pulled_v};
}

/// Turned about the second input's axis, by an angle that grows along it. Outputs: first and third. Constants: radians per
/// unit, radius.
template <class C>
struct Twist {
  C rate, radius, one;
  template <class Real>
  explicit Twist(const Real* p) : rate(p[0]), radius(p[1]), one(Real(1)) {}

  template <class T>
  PlanarPoint<T> operator()(const T& u, const T& along, const T& v) const {
    return turned_within(u, v, radius, one, [&](const T& /*u*/) { return along * rate; });
  }
};

/// Turned by an angle that grows with the first input. Constants: radians per unit, radius.
template <class C>
struct Bend {
  C rate, radius, one;
  template <class Real>
  explicit Bend(const Real* p) : rate(p[0]), radius(p[1]), one(Real(1)) {}

  template <class T>
  PlanarPoint<T> operator()(const T& x, const T& y) const {
    return turned_within(x, y, radius, one, [&](const T& u) { return u * rate; });
  }
};

}  // namespace octomarch::ops
