// What an operator asks of its number type T, and helpers built on that. Operators are written once, as templates, and
// instantiated by kernels/ over lanes (values) and over Dual<lanes> (values with exact derivatives).
//
// T offers + - * and unary -, sqrt, square, abs, min, max, select(mask, a, b) and value_of (the part that comparisons
// look at), with min(a, b) = a < b ? a : b and max(a, b) = a > b ? a : b: so a NaN in `a` yields `b`. Constants have the
// lane type C itself, which has floor too; T mixes with C in + - * min max. Where an operator takes inputs of different types
// (const auto&), these are duals of which some derivatives are known.
#pragma once

namespace octomarch::ops {

/// What an operator's constants are: numbers, or lanes of such, where each lane has its own.
template <class Constant>
struct NumberOf {
  using Type = Constant;
};
template <class Constant>
  requires requires { typename Constant::Real; }
struct NumberOf<Constant> {
  using Type = typename Constant::Real;
};
template <class Constant>
using Number = typename NumberOf<Constant>::Type;

/// Three numbers: a point, or the outputs of an operator that moves points.
template <class X, class Y = X, class Z = X>
struct Triple {
  X x;
  Y y;
  Z z;
};

template <class X, class Y, class Z>
Triple(X, Y, Z) -> Triple<X, Y, Z>;

/// Two numbers: the outputs of an operator that moves points in a plane.
template <class T>
struct PlanarPoint {
  T x;
  T y;
};

/// min and max of two fields. Values with derivatives have overloads that take, of equal operands, one that has a slope.
template <class T>
T smaller_of(const T& a, const T& b) {
  return min(a, b);
}

template <class T>
T larger_of(const T& a, const T& b) {
  return max(a, b);
}

auto length(const auto& x, const auto& y) { return sqrt(square(x) + square(y)); }

auto length(const auto& x, const auto& y, const auto& z) { return sqrt(square(x) + square(y) + square(z)); }

/// max(q, 0), where it is part of a length.
template <class T, class C>
T positive_part(const T& q, const C& zero) {
  return max(q, zero);
}

/// Exact distance to a box from the signed excesses q = |p| − half over its axes. Outside it is the length of the
/// positive excesses, inside and on a face the largest excess: there the textbook sum of both terms has no derivative.
template <class C>
auto box_distance(const auto& qx, const auto& qy, const auto& qz, const C& zero) {
  const auto largest = max(max(qx, qy), qz);
  const auto outside = length(positive_part(qx, zero), positive_part(qy, zero), positive_part(qz, zero));
  return select(value_of(largest) > zero, outside, largest);
}

template <class C>
auto box_distance(const auto& qx, const auto& qy, const C& zero) {
  const auto largest = max(qx, qy);
  const auto outside = length(positive_part(qx, zero), positive_part(qy, zero));
  return select(value_of(largest) > zero, outside, largest);
}

}  // namespace octomarch::ops
