// What an operator asks of its number type T, and helpers built on that. Operators are written once, as templates, and
// instantiated by kernels/ over lanes (values) and over Dual<lanes> (values with exact derivatives).
//
// T offers + - * and unary -, sqrt, square, abs, min, max, select(mask, a, b) and value_of (the part that comparisons
// look at), with min(a, b) = a < b ? a : b and max(a, b) = a > b ? a : b: so a NaN in `a` yields `b`. Constants have the
// lane type C itself, which has floor too; T mixes with C in + - * min max.
#pragma once

namespace octomarch::ops {

/// Three numbers: a point, or the outputs of an operator that moves points.
template <class T>
struct Triple {
  T x;
  T y;
  T z;
};

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

template <class T>
T length(const T& x, const T& y) {
  return sqrt(square(x) + square(y));
}

template <class T>
T length(const T& x, const T& y, const T& z) {
  return sqrt(square(x) + square(y) + square(z));
}

/// Exact distance to a box from the signed excesses q = |p| − half over its axes. Outside it is the length of the
/// positive excesses, inside and on a face the largest excess: there the textbook sum of both terms has no derivative.
template <class T, class C>
T box_distance(const T& qx, const T& qy, const T& qz, const C& zero) {
  const T largest = max(max(qx, qy), qz);
  const T outside = length(max(qx, zero), max(qy, zero), max(qz, zero));
  return select(value_of(largest) > zero, outside, largest);
}

template <class T, class C>
T box_distance(const T& qx, const T& qy, const C& zero) {
  const T largest = max(qx, qy);
  const T outside = length(max(qx, zero), max(qy, zero));
  return select(value_of(largest) > zero, outside, largest);
}

}  // namespace octomarch::ops
