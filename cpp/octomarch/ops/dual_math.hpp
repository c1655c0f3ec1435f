// The functions of math.hpp over dual numbers: the value as there, and its derivatives by the chain rule. Where a
// derivative is infinite or does not exist, as of acos at ±1 and of atan2 at the origin, 0 stands for it.
#pragma once

#include "octomarch/base/dual.hpp"
#include "octomarch/ops/math.hpp"

namespace octomarch::ops {

/// A function's value and slope at a.value, applied to a's derivatives.
template <class T>
[[gnu::always_inline]] inline Dual<T> chained(const T& value, const T& slope, const Dual<T>& a) {
  const T finite = finite_or_zero(slope);
  return {value, a.dx * finite, a.dy * finite, a.dz * finite};
}

/// The same for two operands.
template <class T>
[[gnu::always_inline]] inline Dual<T> chained(const T& value, const T& slope_a, const Dual<T>& a, const T& slope_b,
                                              const Dual<T>& b) {
  const T by_a = finite_or_zero(slope_a);
  const T by_b = finite_or_zero(slope_b);
  return {value, a.dx * by_a + b.dx * by_b, a.dy * by_a + b.dy * by_b, a.dz * by_a + b.dz * by_b};
}

template <class T>
[[gnu::always_inline]] inline Dual<T> exp(const Dual<T>& a) {
  const T value = exp(a.value);
  return chained(value, value, a);
}

template <class T>
[[gnu::always_inline]] inline Dual<T> exp2(const Dual<T>& a) {
  const T value = exp2(a.value);
  return chained(value, value * T(typename T::Real(0.6931471805599453)), a);  // ln 2
}

template <class T>
[[gnu::always_inline]] inline Dual<T> log(const Dual<T>& a) {
  return chained(log(a.value), T(1) / a.value, a);
}

template <class T>
[[gnu::always_inline]] inline Dual<T> log2(const Dual<T>& a) {
  return chained(log2(a.value), T(typename T::Real(1.4426950408889634)) / a.value, a);  // 1/ln 2
}

template <class T>
[[gnu::always_inline]] inline Dual<T> log1p(const Dual<T>& a) {
  return chained(log1p(a.value), T(1) / (T(1) + a.value), a);
}

template <class T>
[[gnu::always_inline]] inline Dual<T> sin(const Dual<T>& a) {
  const SinCos<T> both = sin_cos(a.value);
  return chained(both.sin, both.cos, a);
}

template <class T>
[[gnu::always_inline]] inline Dual<T> cos(const Dual<T>& a) {
  const SinCos<T> both = sin_cos(a.value);
  return chained(both.cos, -both.sin, a);
}

template <class T>
[[gnu::always_inline]] inline Dual<T> tan(const Dual<T>& a) {
  const T value = tan(a.value);
  return chained(value, T(1) + value * value, a);
}

template <class T>
[[gnu::always_inline]] inline Dual<T> atan(const Dual<T>& a) {
  return chained(atan(a.value), T(1) / (T(1) + a.value * a.value), a);
}

template <class T>
[[gnu::always_inline]] inline Dual<T> asin(const Dual<T>& a) {
  const T slope = T(1) / sqrt((T(1) - a.value) * (T(1) + a.value));
  return chained(asin(a.value), slope, a);
}

template <class T>
[[gnu::always_inline]] inline Dual<T> acos(const Dual<T>& a) {
  const T slope = T(-1) / sqrt((T(1) - a.value) * (T(1) + a.value));
  return chained(acos(a.value), slope, a);
}

template <class T>
[[gnu::always_inline]] inline Dual<T> atan2(const Dual<T>& y, const Dual<T>& x) {
  const T inverse = T(1) / (x.value * x.value + y.value * y.value);
  return chained(atan2(y.value, x.value), x.value * inverse, y, -y.value * inverse, x);
}

/// ∂(xʸ)/∂x. At x = 0 a power of 1 keeps its slope, and the others have 0 or none.
template <class T>
[[gnu::always_inline]] inline T slope_of_power(const T& x, const T& y, const T& value) {
  const T at_zero = select(y == T(1), T(1), T(0));
  return select(x == T(0), at_zero, y * (value / x));
}

/// A varying exponent has a slope for x > 0 only.
template <class T>
[[gnu::always_inline]] inline Dual<T> pow(const Dual<T>& x, const Dual<T>& y) {
  const T value = pow(x.value, y.value);
  return chained(value, slope_of_power(x.value, y.value, value), x, value * log(x.value), y);
}

template <class T>
[[gnu::always_inline]] inline Dual<T> pow(const Dual<T>& x, const T& y) {
  const T value = pow(x.value, y);
  return chained(value, slope_of_power(x.value, y, value), x);
}

/// (x − y·n)′ with n held.
template <class T>
[[gnu::always_inline]] inline Dual<T> mod(const Dual<T>& x, const Dual<T>& y) {
  return chained(mod(x.value, y.value), T(1), x, -floor(x.value / y.value), y);
}

template <class T>
[[gnu::always_inline]] inline Dual<T> mod(const Dual<T>& x, const T& y) {
  return {mod(x.value, y), x.dx, x.dy, x.dz};
}

}  // namespace octomarch::ops
