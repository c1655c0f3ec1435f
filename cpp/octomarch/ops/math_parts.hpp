// What the functions of math.hpp are built of: IEEE layout, sums and products with the error of their rounding, powers
// of two. Lanes only: `T` has Real, Integer, Bits, bits() and from_bits(), see kernels/lanes.hpp.
#pragma once

#include <cstddef>
#include <limits>

namespace octomarch::ops {

/// Layout of IEEE numbers: bits of the mantissa that are stored, and the exponent's bias.
template <class Real>
struct Ieee {
  static constexpr int kMantissaBits = std::numeric_limits<Real>::digits - 1;
  static constexpr int kBias = std::numeric_limits<Real>::max_exponent - 1;
  static constexpr bool kIsFloat = kMantissaBits == 23;
  /// The last place of 1.5·2²³ (2⁵²) is 1: adding it rounds to a whole number, in the lowest bits and as a difference.
  static constexpr Real kMagic = kIsFloat ? Real(0x1.8p23) : Real(0x1.8p52);
  static constexpr Real kUlpIsOne = kIsFloat ? Real(0x1p23) : Real(0x1p52);
  static constexpr Real kLeast = std::numeric_limits<Real>::denorm_min();
  static constexpr Real kSmallest = std::numeric_limits<Real>::min();
  static constexpr Real kLargest = std::numeric_limits<Real>::max();
  static constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
  static constexpr Real kNan = std::numeric_limits<Real>::quiet_NaN();
  /// Below it, a quarter of the last place of 1, functions with f(x) = x + O(x²) give x.
  static constexpr Real kNegligible = std::numeric_limits<Real>::epsilon() / 4;
};

/// hi + lo, an unevaluated sum that has twice the digits of T.
template <class T>
struct Pair {
  T hi;
  T lo;
};

/// a + b without error, if |a| ≥ |b|, or a is 0 or a multiple of b's last place (Dekker 1971).
template <class T>
[[gnu::always_inline]] inline Pair<T> ordered_sum(const T& a, const T& b) {
  const T hi = a + b;
  return {hi, b - (hi - a)};
}

/// a + b without error (Knuth).
template <class T>
[[gnu::always_inline]] inline Pair<T> exact_sum(const T& a, const T& b) {
  const T hi = a + b;
  const T from_b = hi - a;
  return {hi, (a - (hi - from_b)) + (b - from_b)};
}

/// The upper half of a's digits; what it leaves of a is exact.
template <class T>
[[gnu::always_inline]] inline T upper_half(const T& a) {
  using Integer = typename T::Integer;
  constexpr int kDropped = Ieee<typename T::Real>::kIsFloat ? 12 : 27;
  return T::from_bits(a.bits() & typename T::Bits(~((Integer(1) << kDropped) - 1)));
}

/// a·b with the error of its rounding (Dekker 1971).
template <class T>
[[gnu::always_inline]] inline Pair<T> exact_product(const T& a, const T& b) {
  const T product = a * b;
  const T a_hi = upper_half(a);
  const T b_hi = upper_half(b);
  const T a_lo = a - a_hi;
  const T b_lo = b - b_hi;
  return {product, (((a_hi * b_hi - product) + a_hi * b_lo) + a_lo * b_hi) + a_lo * b_lo};
}

template <class T, class Real, std::size_t Count>
[[gnu::always_inline]] inline T polynomial(const T& x, const Real (&coefficients)[Count]) {
  T sum = T(coefficients[Count - 1]);
  for (std::size_t i = Count - 1; i-- > 0;) sum = sum * x + T(coefficients[i]);
  return sum;
}

template <class T>
[[gnu::always_inline]] inline typename T::Bits sign_bit(const T& a) {
  return a.bits() & T(typename T::Real(-0.0)).bits();
}

/// a with its sign turned where b has one.
template <class T>
[[gnu::always_inline]] inline T with_sign_of(const T& a, const T& b) {
  return T::from_bits(a.bits() ^ sign_bit(b));
}

/// Nearest whole number, of |x| below 2²² (2⁵¹).
template <class T>
[[gnu::always_inline]] inline T nearest(const T& x) {
  constexpr auto kMagic = Ieee<typename T::Real>::kMagic;
  return (x + T(kMagic)) - T(kMagic);
}

/// 2ⁿ for a whole n from the smallest to the largest exponent of normal numbers.
template <class T>
[[gnu::always_inline]] inline T power_of_two(const T& n) {
  using I = Ieee<typename T::Real>;
  return T::from_bits((n + T(I::kMagic + I::kBias)).bits() << I::kMantissaBits);
}

/// a·2ⁿ, n whole and up to twice as large; results below the normal numbers are rounded once.
template <class T>
[[gnu::always_inline]] inline T scaled(const T& a, const T& n) {
  const T half = nearest(n * T(typename T::Real(0.5)));
  return a * power_of_two(half) * power_of_two(n - half);
}

/// x held within [lo, hi]; NaN stays.
template <class T>
[[gnu::always_inline]] inline T clamped(const T& x, typename T::Real lo, typename T::Real hi) {
  return min(T(hi), max(T(lo), x));
}

}  // namespace octomarch::ops
