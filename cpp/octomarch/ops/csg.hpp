// Operators over distances: the hard ones by comparison, the smooth ones by the quadratic polynomial blend (I. Quilez,
// "smooth minimum", 2013). All keep the larger Lipschitz bound of their operands: a blend's gradient is a convex
// combination of theirs. Intersections and differences give lower bounds of the true distance.
#pragma once

#include "octomarch/ops/dual_math.hpp"
#include "octomarch/ops/math.hpp"
#include "octomarch/ops/number.hpp"

namespace octomarch::ops {

/// Operators without constants take the (empty) list all the same, so that every operator is built alike.
struct NoConstants {
  template <class Real>
  explicit NoConstants(const Real* /*none*/) {}
};

template <class C>
struct Union : NoConstants {
  using NoConstants::NoConstants;
  template <class T>
  T operator()(const T& a, const T& b) const {
    return smaller_of(a, b);
  }
};

template <class C>
struct Intersection : NoConstants {
  using NoConstants::NoConstants;
  template <class T>
  T operator()(const T& a, const T& b) const {
    return larger_of(a, b);
  }
};

/// a without b.
template <class C>
struct Difference : NoConstants {
  using NoConstants::NoConstants;
  template <class T>
  T operator()(const T& a, const T& b) const {
    return larger_of(a, -b);
  }
};

template <class C>
struct Complement : NoConstants {
  using NoConstants::NoConstants;
  template <class T>
  T operator()(const T& a) const {
    return -a;
  }
};

/// What a smooth operator takes from the smaller, or adds to the larger, of two distances that differ by `gap`:
/// max(k − |gap|, 0)²/(4k). Callers order the gap so that it is ≥ 0 where min or max takes the second operand, as both
/// do on a tie: abs has slope +1 at 0, and with that the derivative is right there too. Constants: k, 1/(4k).
template <class C>
struct Blend {
  C k, quarter_inverse, zero;
  template <class Real>
  explicit Blend(const Real* p) : k(p[0]), quarter_inverse(p[1]), zero(Real(0)) {}

  template <class T>
  T operator()(const T& gap) const {
    const T overlap = max(k - abs(gap), zero);
    return overlap * (overlap * quarter_inverse);  // its square alone would overflow for k beyond 1e19
  }

  /// The derivative in closed form takes a third of the operations. Beyond k it is 0, whatever the gap's.
  template <class T>
  Dual<T> operator()(const Dual<T>& gap) const {
    const T overlap = max(k - abs(gap.value), zero);
    const T share = overlap * quarter_inverse;
    const T slope = select(gap.value < zero, share + share, -(share + share));
    const auto is_blended = overlap > zero;
    return {overlap * share, kept(is_blended, gap.dx * slope), kept(is_blended, gap.dy * slope),
            kept(is_blended, gap.dz * slope)};
  }
};

template <class C>
struct SmoothUnion {
  Blend<C> blend;
  template <class Real>
  explicit SmoothUnion(const Real* p) : blend(p) {}

  template <class T>
  T operator()(const T& a, const T& b) const {
    return min(a, b) - blend(a - b);
  }
};

template <class C>
struct SmoothIntersection {
  Blend<C> blend;
  template <class Real>
  explicit SmoothIntersection(const Real* p) : blend(p) {}

  template <class T>
  T operator()(const T& a, const T& b) const {
    return max(a, b) + blend(b - a);
  }
};

template <class C>
struct SmoothDifference {
  Blend<C> blend;
  template <class Real>
  explicit SmoothDifference(const Real* p) : blend(p) {}

  template <class T>
  T operator()(const T& a, const T& b) const {
    return max(a, -b) + blend(-b - a);
  }
};

/// Exponential blend of two fields, m − k·log1p(exp(−|a − b|/k)), m the smaller: a sum of exponentials that cannot
/// overflow. Constants: k, 1/k.
template <class C>
struct Metaballs {
  C k, inverse;
  template <class Real>
  explicit Metaballs(const Real* p) : k(p[0]), inverse(p[1]) {}

  template <class T>
  T operator()(const T& a, const T& b) const {
    return min(a, b) - log1p(exp(-abs(a - b) * inverse)) * k;
  }
};

/// A wall about the surface. Constants: half its thickness.
template <class C>
struct Shell {
  C half;
  template <class Real>
  explicit Shell(const Real* p) : half(p[0]) {}

  template <class T>
  T operator()(const T& a) const {
    return abs(a) - half;
  }
};

/// A flat field between two planes: inputs its distance and the coordinate across. Constants: half height.
template <class C>
struct Extrude {
  C half, zero;
  template <class Real>
  explicit Extrude(const Real* p) : half(p[0]), zero(Real(0)) {}

  template <class T>
  T operator()(const T& a, const T& z) const {
    return box_distance(a, abs(z) - half, zero);
  }
};

}  // namespace octomarch::ops
