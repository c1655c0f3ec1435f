// Transcendental functions of our own, from + − × ÷ and bit patterns only, so that every ISA gives the same bits: the
// machine's libraries, and xsimd's, differ with the presence of fused multiply-add. Lanes only: `T` has Real, Integer,
// bits() and from_bits().
//
// Largest errors found against long double, in float and double alike (tests/cpp/test_math.cpp): log2 3.8 ulp, exp2
// 1.2 ulp, power 3.0·(1 + |y·log2 x|) ulp.
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
};

/// Base-2 logarithm of positive normal numbers; garbage elsewhere. x = m·2ᵉ with m in [√½, √2), and
/// log2(m) = 2/ln 2·(s + s³/3 + s⁵/5 + …), s = (m − 1)/(m + 1), |s| ≤ 0.172, cut where the rest is below half an ulp.
template <class T>
T log2(const T& x) {
  using Real = typename T::Real;
  using Integer = typename T::Integer;
  using Bits = typename T::Bits;
  constexpr int kShift = Ieee<Real>::kMantissaBits;
  constexpr Integer kMantissa = (Integer(1) << kShift) - 1;
  constexpr Real kUlpIsOne = Ieee<Real>::kIsFloat ? Real(0x1p23) : Real(0x1p52);

  // Split: a whole number laid into the mantissa of 2²³ (2⁵²) is that power plus the number.
  const Bits bits = x.bits();
  const Bits exponent_bits = (bits >> kShift) | T(kUlpIsOne).bits();
  const T raw_exponent = T::from_bits(exponent_bits) - T(kUlpIsOne + Real(Ieee<Real>::kBias));
  const T raw_mantissa = T::from_bits((bits & Bits(kMantissa)) | T(Real(1)).bits());
  const auto large = raw_mantissa > T(Real(1.4142135623730951));
  const T mantissa = select(large, raw_mantissa * T(Real(0.5)), raw_mantissa);
  const T exponent = select(large, raw_exponent + T(Real(1)), raw_exponent);

  const T s = (mantissa - T(Real(1))) / (mantissa + T(Real(1)));
  const T s2 = s * s;
  constexpr int kTerms = Ieee<Real>::kIsFloat ? 5 : 11;
  T sum = T(Real(1) / Real(2 * kTerms - 1));
  for (int term = kTerms - 1; term >= 1; --term) sum = sum * s2 + T(Real(1) / Real(2 * term - 1));
  return exponent + s * sum * T(Real(2.8853900817779268));  // 2/ln 2
}

/// 2ˣ. Below 2⁻¹²⁶ (2⁻¹⁰²²) the result is 0, above 2¹²⁷ (2¹⁰²³) +inf. x = n + f with |f| ≤ ½, and 2ᶠ from the series of
/// exp(f·ln 2), cut where the rest is below half an ulp.
template <class T>
T exp2(const T& x) {
  using Real = typename T::Real;
  constexpr int kShift = Ieee<Real>::kMantissaBits;
  constexpr Real kLowest = Real(1 - Ieee<Real>::kBias);
  constexpr Real kHighest = Real(Ieee<Real>::kBias);
  constexpr Real kMagic = Ieee<Real>::kIsFloat ? Real(0x1.8p23) : Real(0x1.8p52);

  const T clamped = min(max(x, T(kLowest)), T(kHighest));
  const T whole = floor(clamped + T(Real(0.5)));
  const T f = (clamped - whole) * T(Real(0.6931471805599453));  // ln 2
  constexpr int kDegree = Ieee<Real>::kIsFloat ? 7 : 13;
  T sum = T(Real(1));
  for (int k = kDegree; k >= 1; --k) sum = sum * f * T(Real(1) / Real(k)) + T(Real(1));

  const T power = T::from_bits((whole + T(kMagic + Real(Ieee<Real>::kBias))).bits() << kShift);
  const T finite = select(x < T(kLowest), T(Real(0)), sum * power);
  return select(x > T(kHighest), T(std::numeric_limits<Real>::infinity()), finite);
}

/// xʸ for x ≥ 0 and y > 0, with 0ʸ = 0 (numbers below the normal ones count as 0).
template <class T>
T power(const T& x, const T& y) {
  using Real = typename T::Real;
  const T result = exp2(y * log2(x));
  return select(x < T(std::numeric_limits<Real>::min()), T(Real(0)), result);
}

}  // namespace octomarch::ops
