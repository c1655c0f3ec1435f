// Transcendental functions of our own, from + − × ÷ √ and bit patterns only, so that every ISA gives the same bits: the
// machine's libraries, and xsimd's, differ with the presence of fused multiply-add. Lanes only: `T` has Real, Integer,
// Bits, bits() and from_bits(), and the operations of kernels/lanes.hpp. Derivatives are in ops/dual_math.hpp.
//
// NaN gives NaN, and beyond that infinities, zeros and their signs are as in C unless a function says otherwise. Numbers
// below the normal ones are taken and given as they are.
//
// Polynomials are minimax fits (Remez, 220 bits) of the function that the comment names, made for this file, with
// coefficients rounded from the lowest and the others fitted again; other constants are rounded from 300 digits.
#pragma once

#include <cstddef>
#include <cstdint>
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
  static constexpr Real kSmallest = std::numeric_limits<Real>::min();
  static constexpr Real kLargest = std::numeric_limits<Real>::max();
  static constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
  static constexpr Real kNan = std::numeric_limits<Real>::quiet_NaN();
};

/// Constants and coefficients, lowest first. A pair _hi + _lo has twice the digits; _short has half of them.
template <class Real>
struct MathConstants;

template <>
struct MathConstants<float> {
  // ln 2 without the digits that a whole exponent needs in a product; 1/ln 2 and ln 2 with 12 digits.
  static constexpr float kLn2Hi = 0x1.62e4p-1F, kLn2Lo = 0x1.7f7d1cp-20F;
  static constexpr float kLog2eShort = 0x1.716p+0F, kLog2eRest = -0x1.7135a8p-13F;
  static constexpr float kLn2Short = 0x1.62ep-1F, kLn2Rest = 0x1.0bfbe8p-15F;
  // 2/ln 2 and 2/(3·ln 2).
  static constexpr float kAtanh1Hi = 0x1.715476p+1F, kAtanh1Lo = 0x1.4ae0cp-25F;
  static constexpr float kAtanh3Hi = 0x1.ec709ep-1F, kAtanh3Lo = -0x1.e2fe02p-28F;
  // (exp(r) − 1 − r)/r² on |r| ≤ ln 2/2, to 2⁻²⁸ of exp; (2ᶠ − 1 − f·ln 2)/f² on |f| ≤ ½, to 2⁻²⁸ of 2ᶠ.
  static constexpr float kExp[] = {0x1.fffffcp-2F, 0x1.55548cp-3F, 0x1.55585cp-5F, 0x1.123df2p-7F, 0x1.6ac43p-10F};
  static constexpr float kExp2[] = {0x1.ebfbdcp-3F, 0x1.c6af84p-5F, 0x1.3b2db4p-7F, 0x1.5f06acp-10F, 0x1.41a036p-13F};
  // (2·atanh(s)/s − 2)/s² over s², s ≤ 0.1717, to 2⁻³⁵; the same in base 2 without its first two terms, to 2⁻³⁶.
  static constexpr float kLog[] = {0x1.555554p-1F, 0x1.999c28p-2F, 0x1.23d32p-2F, 0x1.f15cecp-3F};
  static constexpr float kPow[] = {0x1.27770ep-1F, 0x1.a5bbf2p-2F, 0x1.59ef54p-2F};
  // (sin(r)/r − 1)/r² and (cos(r) − 1 + r²/2)/r⁴ over r², |r| ≤ π/4, to 2⁻²⁸ and 2⁻³³.
  static constexpr float kSin[] = {-0x1.555546p-3F, 0x1.11077cp-7F, -0x1.9955acp-13F};
  static constexpr float kCos[] = {0x1.55554ap-5F, -0x1.6c0c18p-10F, 0x1.99dfeap-16F};
  // π/2 in four parts; multiples of the first three up to kTurns are exact.
  static constexpr float kTurns = 4096;
  static constexpr float kHalfPi[] = {0x1.922p+0F, -0x1.2aep-18F, -0x1.deap-31F, 0x1.184698p-44F};
  // (atan(t)/t − 1)/t² over t², |t| ≤ tan(π/8), to 2⁻³⁰; (asin(s)/s − 1)/s² over s², |s| ≤ ½, to 2⁻³⁰.
  static constexpr float kAtan[] = {-0x1.55554ap-2F, 0x1.9991e6p-3F, -0x1.23ba04p-3F, 0x1.b22a2cp-4F, -0x1.f3035ep-5F};
  static constexpr float kAsin[] = {0x1.55554cp-3F, 0x1.3338aep-4F, 0x1.6ca77cp-5F,
                                    0x1.04cceep-5F, 0x1.d57352p-7F, 0x1.34ccc6p-5F};
  // π/4 without the digits that a factor up to 4 needs.
  static constexpr float kQuarterPiHi = 0x1.922p-1F, kQuarterPiLo = -0x1.2aeef4p-19F;
  static constexpr float kHalfPiHi = 0x1.921fb6p+0F, kHalfPiLo = -0x1.777a5cp-25F;
};

template <>
struct MathConstants<double> {
  static constexpr double kLn2Hi = 0x1.62e42fefa4p-1, kLn2Lo = -0x1.8432a1b0e2634p-43;
  static constexpr double kLog2eShort = 0x1.7154768p+0, kLog2eRest = -0x1.6a3e80f444178p-27;
  static constexpr double kLn2Short = 0x1.62e43p-1, kLn2Rest = -0x1.05c610ca86c39p-29;
  static constexpr double kAtanh1Hi = 0x1.71547652b82fep+1, kAtanh1Lo = 0x1.777d0ffda0d24p-55;
  static constexpr double kAtanh3Hi = 0x1.ec709dc3a03fdp-1, kAtanh3Lo = 0x1.d27f05548af0cp-55;
  // To 2⁻⁵⁶ and 2⁻⁵⁸.
  static constexpr double kExp[] = {0x1.000000000000ap-1,  0x1.55555555554fap-3,  0x1.55555555508b1p-5,
                                    0x1.1111111127b6fp-7,  0x1.6c16c1842404ap-10, 0x1.a01a012a6dd17p-13,
                                    0x1.a0199a1279e87p-16, 0x1.71df25299280ap-19, 0x1.28ad74575b3dep-22,
                                    0x1.ad7fc0a45a0cep-26};
  static constexpr double kExp2[] = {0x1.ebfbdff82c5a1p-3,  0x1.c6b08d704a045p-5,  0x1.3b2ab6fba076cp-7,
                                     0x1.5d87fe78c38e2p-10, 0x1.4309130dd3a7fp-13, 0x1.ffcbfbc75f8c9p-17,
                                     0x1.62bfc9c4a0dd5p-20, 0x1.b5265353412ecp-24, 0x1.e6181bad4283ep-28,
                                     0x1.e7c6e8e03cab0p-32};
  // To 2⁻⁵⁹ and 2⁻⁶⁹.
  static constexpr double kLog[] = {0x1.5555555555592p-1, 0x1.999999997fddap-2, 0x1.24924941ff17ep-2,
                                    0x1.c71c51f4793bcp-3, 0x1.746644c568fd0p-3, 0x1.39a100eec3bb9p-3,
                                    0x1.2f0de55f03698p-3};
  static constexpr double kPow[] = {0x1.2776c50ef9bfep-1, 0x1.a61762a7ae1b4p-2, 0x1.484b13d78c684p-2,
                                    0x1.0c9a84b73050bp-2, 0x1.c68f42cb18c6cp-3, 0x1.89f78a4afccb6p-3,
                                    0x1.5b2cd0f1c0247p-3, 0x1.3d28df0d3abf2p-3, 0x1.03f0082d79adfp-3};
  // To 2⁻⁵⁸ and 2⁻⁶⁴.
  static constexpr double kSin[] = {-0x1.5555555555549p-3, 0x1.111111110f89ep-7,   -0x1.a01a019c14706p-13,
                                    0x1.71de35793db8fp-19, -0x1.ae5e66e468ac0p-26, 0x1.5d931393235dfp-33};
  static constexpr double kCos[] = {0x1.555555555554cp-5,   -0x1.6c16c16c15212p-10, 0x1.a01a019cbd1f2p-16,
                                    -0x1.27e4f8107e487p-22, 0x1.1ee9ef7d28867p-29,  -0x1.8fb01aa1fd319p-37};
  static constexpr double kTurns = 33554432;
  static constexpr double kHalfPi[] = {0x1.921fb54p+0, 0x1.10b4612p-30, -0x1.676733ap-60, -0x1.d1fc8f8cbb5bfp-89};
  // To 2⁻⁵⁹ and 2⁻⁵⁹.
  static constexpr double kAtan[] = {-0x1.555555555553ep-2, 0x1.9999999995a3bp-3,  -0x1.24924922b6f40p-3,
                                     0x1.c71c70e944700p-4,  -0x1.745cf92c848f2p-4, 0x1.3b111dfbeedc1p-4,
                                     -0x1.10ebe903dce31p-4, 0x1.df11bc81c0673p-5,  -0x1.9cdc70b26f74ep-5,
                                     0x1.37eb54dab7a4dp-5,  -0x1.2593fc80a1d60p-6};
  static constexpr double kAsin[] = {
      0x1.5555555555576p-3, 0x1.333333332e234p-4,  0x1.6db6db720e285p-5, 0x1.f1c71a9499a22p-6, 0x1.6e8bdf115ebe3p-6,
      0x1.1c49ead2aa7fep-6, 0x1.ca2039e9fbcd7p-7,  0x1.757efe0ac633dp-7, 0x1.616612a51ef97p-7, 0x1.e343c238b69fbp-9,
      0x1.647eb8570fca9p-6, -0x1.59524b1740b9fp-6, 0x1.0bb71118f0180p-5};
  static constexpr double kQuarterPiHi = 0x1.921fb54443p-1, kQuarterPiLo = -0x1.73dcb3b399d74p-44;
  static constexpr double kHalfPiHi = 0x1.921fb54442d18p+0, kHalfPiLo = 0x1.1a62633145c07p-54;
};

/// 2/π in words of 24 bits.
inline constexpr std::uint32_t kTwoOverPi[] = {
    0xA2F983, 0x6E4E44, 0x1529FC, 0x2757D1, 0xF534DD, 0xC0DB62, 0x95993C, 0x439041, 0xFE5163, 0xABDEBB,
    0xC561B7, 0x246E3A, 0x424DD2, 0xE00649, 0x2EEA09, 0xD1921C, 0xFE1DEB, 0x1CB129, 0xA73EE8, 0x8235F5,
    0x2EBB44, 0x84E99C, 0x7026B4, 0x5F7E41, 0x3991D6, 0x398353, 0x39F49C, 0x845F8B, 0xBDF928, 0x3B1FF8,
    0x97FFDE, 0x05980F, 0xEF2F11, 0x8B5A0A, 0x6D1F6D, 0x367ECF, 0x27CB09, 0xB74F46, 0x3F669E, 0x5FEA2D,
    0x7527BA, 0xC7EBE5, 0xF17B3D, 0x0739F7, 0x8A5292, 0xEA6BFB, 0x5FB11F, 0x8D5D08, 0x560330};

/// hi + lo, an unevaluated sum that has twice the digits of T.
template <class T>
struct Pair {
  T hi;
  T lo;
};

/// a + b without error, if |a| ≥ |b|, or a is 0 or a multiple of b's last place (Dekker 1971).
template <class T>
Pair<T> ordered_sum(const T& a, const T& b) {
  const T hi = a + b;
  return {hi, b - (hi - a)};
}

/// a + b without error (Knuth).
template <class T>
Pair<T> exact_sum(const T& a, const T& b) {
  const T hi = a + b;
  const T from_b = hi - a;
  return {hi, (a - (hi - from_b)) + (b - from_b)};
}

/// The upper half of a's digits; what it leaves of a is exact.
template <class T>
T upper_half(const T& a) {
  using Integer = typename T::Integer;
  constexpr int kDropped = Ieee<typename T::Real>::kIsFloat ? 12 : 27;
  return T::from_bits(a.bits() & typename T::Bits(~((Integer(1) << kDropped) - 1)));
}

/// a·b with the error of its rounding (Dekker 1971).
template <class T>
Pair<T> exact_product(const T& a, const T& b) {
  const T product = a * b;
  const T a_hi = upper_half(a);
  const T b_hi = upper_half(b);
  const T a_lo = a - a_hi;
  const T b_lo = b - b_hi;
  return {product, (((a_hi * b_hi - product) + a_hi * b_lo) + a_lo * b_hi) + a_lo * b_lo};
}

template <class T, class Real, std::size_t Count>
T polynomial(const T& x, const Real (&coefficients)[Count]) {
  T sum = T(coefficients[Count - 1]);
  for (std::size_t i = Count - 1; i-- > 0;) sum = sum * x + T(coefficients[i]);
  return sum;
}

template <class T>
typename T::Bits sign_bit(const T& a) {
  return a.bits() & T(typename T::Real(-0.0)).bits();
}

/// a with its sign turned where b has one.
template <class T>
T with_sign_of(const T& a, const T& b) {
  return T::from_bits(a.bits() ^ sign_bit(b));
}

/// Nearest whole number, of |x| below 2²² (2⁵¹).
template <class T>
T nearest(const T& x) {
  constexpr auto kMagic = Ieee<typename T::Real>::kMagic;
  return (x + T(kMagic)) - T(kMagic);
}

/// 2ⁿ for a whole n from the smallest to the largest exponent of normal numbers.
template <class T>
T power_of_two(const T& n) {
  using I = Ieee<typename T::Real>;
  return T::from_bits((n + T(I::kMagic + I::kBias)).bits() << I::kMantissaBits);
}

/// a·2ⁿ, n whole and up to twice as large; results below the normal numbers are rounded once.
template <class T>
T scaled(const T& a, const T& n) {
  const T half = nearest(n * T(typename T::Real(0.5)));
  return a * power_of_two(half) * power_of_two(n - half);
}

/// x held within [lo, hi]; NaN stays.
template <class T>
T clamped(const T& x, typename T::Real lo, typename T::Real hi) {
  return min(T(hi), max(T(lo), x));
}

/// A positive normal number as (1 + f)·2ᵉ with 1 + f in (√½, √2].
template <class T>
struct Split {
  T exponent;
  T f;
};

template <class T>
Split<T> split(const T& x) {
  using Real = typename T::Real;
  using Integer = typename T::Integer;
  using I = Ieee<Real>;
  constexpr Integer kMantissa = (Integer(1) << I::kMantissaBits) - 1;

  // A whole number laid into the mantissa of 2²³ (2⁵²) is that power plus the number.
  const typename T::Bits bits = x.bits();
  const T raw_exponent =
      T::from_bits((bits >> I::kMantissaBits) | T(I::kUlpIsOne).bits()) - T(I::kUlpIsOne + Real(I::kBias));
  const T mantissa = T::from_bits((bits & typename T::Bits(kMantissa)) | T(Real(1)).bits());
  const auto large = mantissa > T(Real(1.4142135623730951));
  return {select(large, raw_exponent + T(Real(1)), raw_exponent),
          select(large, mantissa * T(Real(0.5)), mantissa) - T(Real(1))};
}

/// The same for positive numbers below the normal ones too.
template <class T>
Split<T> split_any(const T& x) {
  using Real = typename T::Real;
  constexpr int kUp = std::numeric_limits<Real>::digits;
  const auto tiny = x < T(Ieee<Real>::kSmallest);
  const Split<T> parts = split(select(tiny, x * T(Ieee<Real>::kUlpIsOne * 2), x));
  return {select(tiny, parts.exponent - T(Real(kUp)), parts.exponent), parts.f};
}

/// log(1 + f) = f − half_square + rest, for 1 + f in (√½, √2]: with s = f/(2 + f) it is 2·atanh(s) (fdlibm, e_log.c).
template <class T>
struct LogSeries {
  T half_square;
  T rest;
  T s;
};

template <class T>
LogSeries<T> log_series(const T& f) {
  using Real = typename T::Real;
  const T half_square = T(Real(0.5)) * f * f;
  const T s = f / (T(Real(2)) + f);
  const T z = s * s;
  return {half_square, s * (half_square + z * polynomial(z, MathConstants<Real>::kLog)), s};
}

/// Logarithms' results where x is not a positive finite number.
template <class T>
T log_or_special(const T& x, const T& log) {
  using I = Ieee<typename T::Real>;
  const T above = select(x <= T(I::kLargest), log, x);
  const T at_zero = select(x == T(typename T::Real(0)), T(-I::kInfinity), above);
  return select(x < T(typename T::Real(0)), T(I::kNan), at_zero);
}

/// Natural logarithm.
template <class T>
T log(const T& x) {
  using C = MathConstants<typename T::Real>;
  const auto [exponent, f] = split_any(x);
  const LogSeries<T> series = log_series(f);
  const Pair<T> sum = ordered_sum(exponent * T(C::kLn2Hi), f);
  const T small = exponent * T(C::kLn2Lo) - (series.half_square - series.rest);
  return log_or_special(x, sum.hi + (sum.lo + small));
}

/// Logarithm to base 2, exact for powers of two.
template <class T>
T log2(const T& x) {
  using C = MathConstants<typename T::Real>;
  const auto [exponent, f] = split_any(x);
  const LogSeries<T> series = log_series(f);
  const T hi = upper_half(f - series.half_square);
  const T lo = ((f - hi) - series.half_square) + series.rest;
  const Pair<T> sum = ordered_sum(exponent, hi * T(C::kLog2eShort));
  const T small = (hi + lo) * T(C::kLog2eRest) + lo * T(C::kLog2eShort);
  return log_or_special(x, sum.hi + (sum.lo + small));
}

/// log(1 + x), accurate near 0 too; NaN below −1.
template <class T>
T log1p(const T& x) {
  using Real = typename T::Real;
  using Integer = typename T::Integer;
  using Bits = typename T::Bits;
  using C = MathConstants<Real>;
  using I = Ieee<Real>;
  constexpr Integer kExponent = Integer(2 * I::kBias + 1) << I::kMantissaBits;
  constexpr Integer kTwice = Integer(2 * I::kBias) << I::kMantissaBits;

  // 1 + x = u + lost. With u = (1 + f)·2ᵉ, `lost` joins f at its scale, 2⁻ᵉ.
  const Pair<T> u = exact_sum(T(Real(1)), x);
  const auto [exponent, rounded_f] = split(u.hi);
  const T unit = T::from_bits(Bits(kTwice) - (u.hi.bits() & Bits(kExponent)));
  const T half_if_large = select(u.hi * unit > T(Real(1.4142135623730951)), T(Real(0.5)), T(Real(1)));
  const Pair<T> f = ordered_sum(rounded_f, u.lo * unit * half_if_large);

  const LogSeries<T> series = log_series(f.hi);
  const Pair<T> sum = ordered_sum(exponent * T(C::kLn2Hi), f.hi);
  const T slope = T(Real(1)) - (series.s + series.s);  // of log(1 + f), nearly
  const T small = exponent * T(C::kLn2Lo) - ((series.half_square - series.rest) - f.lo * slope);
  const T result = log_or_special(u.hi, sum.hi + (sum.lo + small));
  return select(abs(x) < T(std::numeric_limits<Real>::epsilon() / 4), x, result);
}

/// eˣ. Overflow gives +inf, and small results become denormal, then 0.
template <class T>
T exp(const T& x) {
  using Real = typename T::Real;
  using C = MathConstants<Real>;
  // Bounds beyond which the result is 0 or +inf.
  const T held =
      clamped(x, Ieee<Real>::kIsFloat ? Real(-104) : Real(-746), Ieee<Real>::kIsFloat ? Real(89) : Real(710));
  const T n = nearest(held * T(Real(1.4426950408889634)));
  const T upper = held - n * T(C::kLn2Hi);
  const T lower = n * T(C::kLn2Lo);
  const T r = upper - lower;
  const T lost = (upper - r) - lower;
  const Pair<T> sum = ordered_sum(T(Real(1)), r);
  return scaled(sum.hi + (sum.lo + (lost + r * r * polynomial(r, C::kExp))), n);
}

/// 2^(n + f + more), |f| ≤ ½ and `more` small beside 1.
template <class T>
T exp2_of_parts(const T& n, const T& f, const T& more) {
  using Real = typename T::Real;
  using C = MathConstants<Real>;
  const T f_hi = upper_half(f);
  const T linear = f_hi * T(C::kLn2Short);
  const T rest = (f - f_hi) * T(C::kLn2Short) + (f * T(C::kLn2Rest) + more * T(Real(0.6931471805599453)));
  const Pair<T> sum = ordered_sum(T(Real(1)), linear);
  return scaled(sum.hi + (sum.lo + (rest + f * f * polynomial(f, C::kExp2))), n);
}

/// 2ˣ, exact for whole x. Overflow gives +inf, and small results become denormal, then 0.
template <class T>
T exp2(const T& x) {
  using Real = typename T::Real;
  const T held = clamped(x, Ieee<Real>::kIsFloat ? Real(-151) : Real(-1076), Real(Ieee<Real>::kBias + 2));
  const T n = nearest(held);
  return exp2_of_parts(n, held - n, T(Real(0)));
}

/// log2 of a positive number with about 1.5 times the digits of T: 2/ln 2·(s + s³/3 + …), s = f/(2 + f).
template <class T>
Pair<T> log2_in_two_parts(const T& x) {
  using Real = typename T::Real;
  using C = MathConstants<Real>;
  const auto [exponent, f] = split_any(x);
  const Pair<T> below = ordered_sum(T(Real(2)), f);
  const T inverse = T(Real(1)) / below.hi;
  const T s = f * inverse;
  const Pair<T> back = exact_product(s, below.hi);
  const T s_lo = (((f - back.hi) - back.lo) - s * below.lo) * inverse;

  const Pair<T> square = exact_product(s, s);
  const T z = square.hi;
  const T z_lo = square.lo + (s + s) * s_lo;
  const Pair<T> third = exact_product(z, T(C::kAtanh3Hi));
  const Pair<T> later = ordered_sum(third.hi, z * z * polynomial(z, C::kPow));
  const Pair<T> factor = ordered_sum(T(C::kAtanh1Hi), later.hi);
  const T third_lo = third.lo + (z * T(C::kAtanh3Lo) + z_lo * T(C::kAtanh3Hi));
  const T factor_lo = factor.lo + (T(C::kAtanh1Lo) + (later.lo + third_lo));
  const Pair<T> log = exact_product(s, factor.hi);
  const Pair<T> sum = ordered_sum(exponent, log.hi);
  return {sum.hi, sum.lo + (log.lo + (s * factor_lo + s_lo * factor.hi))};
}

/// xʸ as C's pow, but for NaN, which always gives NaN: negative x need a whole y.
template <class T>
T pow(const T& x, const T& y) {
  using Real = typename T::Real;
  using I = Ieee<Real>;
  const T zero = T(Real(0));
  const T magnitude = abs(x);

  // The least logarithm is an ulp: this y already gives 0 or +inf for all but |x| = 1.
  constexpr Real kHugeExponent = I::kIsFloat ? Real(0x1p36) : Real(0x1p70);
  constexpr Real kBeyond = I::kIsFloat ? Real(200) : Real(1200);
  const Pair<T> log = log2_in_two_parts(magnitude);
  const T held_y = clamped(y, -kHugeExponent, kHugeExponent);
  const Pair<T> product = exact_product(held_y, log.hi);
  const T held = clamped(product.hi, -kBeyond, kBeyond);
  const T product_lo = select(held == product.hi, product.lo + held_y * log.lo, zero);
  const T n = nearest(held);
  const Pair<T> f = ordered_sum(held - n, product_lo);
  const T usual = exp2_of_parts(n, f.hi, f.lo);

  const auto endless = magnitude > T(I::kLargest);
  const T towards = select(endless, y, -y);
  const T extreme = select(towards > zero, T(I::kInfinity), select(towards == zero, T(Real(1)), zero));
  const T unsigned_result = select(endless | (magnitude == zero), extreme, usual);

  const T half = y * T(Real(0.5));
  const auto whole = floor(y) == y;
  const auto odd = whole & !(floor(half) == half);
  const T result = select(odd, with_sign_of(unsigned_result, x), unsigned_result);
  const auto undefined = (x < zero) & !whole & !endless;
  const auto numbers = (x == x) & (y == y);
  return select(numbers, select(undefined, T(I::kNan), result), x + y);
}

/// xʸ for 0 ≤ x and y > 0, with 0ʸ = 0 (numbers below the normal ones count as 0): a fast one for highlights, with a
/// relative error that grows with |y·log2 x|.
template <class T>
T power(const T& x, const T& y) {
  using Real = typename T::Real;
  const auto [exponent, f] = split(x);
  const LogSeries<T> series = log_series(f);
  const T log2_of_mantissa = (f - (series.half_square - series.rest)) * T(Real(1.4426950408889634));
  const T result = exp2(y * (exponent + log2_of_mantissa));
  return select(x < T(Ieee<Real>::kSmallest), T(Real(0)), result);
}

/// An angle less a multiple of π/2: r + r_lo within ±π/4 (a little more), and the multiple in the lowest bits.
template <class T>
struct Reduced {
  T r;
  T r_lo;
  typename T::Bits quadrant;
};

/// Reduction after Payne and Hanek (1983) for finite |x| of any size: of the products of x with 2/π, only those words
/// that reach below 4 are looked at. Rare, so kept out of the way.
template <class T>
[[gnu::noinline]] Reduced<T> reduce_large(const T& x) {
  using Real = typename T::Real;
  using Integer = typename T::Integer;
  using C = MathConstants<Real>;
  using I = Ieee<Real>;
  constexpr Integer kMantissa = (Integer(1) << I::kMantissaBits) - 1;
  constexpr int kWordBits = I::kIsFloat ? 12 : 24;
  constexpr int kWindow = 9;
  constexpr int kStarts = (I::kBias - I::kMantissaBits - 2) / kWordBits + 1;
  constexpr auto kWord = [](int i) {
    if constexpr (!I::kIsFloat) return Real(kTwoOverPi[i]);
    return Real((kTwoOverPi[i / 2] >> (i % 2 == 0 ? 12 : 0)) & 0xFFF);
  };
  constexpr Real kWordUnit = Real(1) / Real(1 << kWordBits);

  // |x| = m·2ᵉ with a whole m; word i of 2/π counts in units of 2^(−kWordBits·(i + 1)).
  const typename T::Bits bits = abs(x).bits();
  const T m = T::from_bits((bits & typename T::Bits(kMantissa)) | T(I::kUlpIsOne).bits());
  const T e = T::from_bits((bits >> I::kMantissaBits) | T(I::kUlpIsOne).bits()) -
              T(I::kUlpIsOne + Real(I::kBias + I::kMantissaBits));
  const T start = max(T(Real(0)), floor((e - T(Real(1.5))) * T(kWordUnit * Real(1 << kWordBits) / Real(kWordBits))));
  T window[kWindow];
  for (T& word : window) word = T(Real(0));
  for (int i = 0; i < kStarts; ++i) {
    const auto here = start == T(Real(i));
    for (int k = 0; k < kWindow; ++k) window[k] = select(here, T(kWord(i + k)), window[k]);
  }

  // The products, largest first, each without the multiples of 4; what is summed stays within ±½ and exact enough.
  T unit = power_of_two(e - (start + T(Real(1))) * T(Real(kWordBits)));
  const T m_hi = upper_half(m);
  const T halves[] = {m_hi, m - m_hi};
  T whole = T(Real(0));
  Pair<T> rest = {T(Real(0)), T(Real(0))};
  for (const T& word : window) {
    for (const T& half : halves) {
      const T product = half * word * unit;
      const T within = product - floor(product * T(Real(0.25)) + T(Real(0.5))) * T(Real(4));
      const Pair<T> sum = exact_sum(rest.hi, within);
      const T n = nearest(sum.hi);
      whole = whole + n;
      rest = ordered_sum(sum.hi - n, rest.lo + sum.lo);
    }
    unit = unit * T(kWordUnit);
  }
  const Pair<T> r = exact_product(rest.hi, T(C::kHalfPiHi));
  const T r_lo = r.lo + (rest.hi * T(C::kHalfPiLo) + rest.lo * T(C::kHalfPiHi));
  return {with_sign_of(r.hi, x), with_sign_of(r_lo, x), (with_sign_of(whole, x) + T(I::kMagic)).bits()};
}

/// Reduction after Cody and Waite, with π/2 in four parts, for up to kTurns quarter turns; beyond, the one above.
template <class T>
Reduced<T> reduce(const T& x) {
  using Real = typename T::Real;
  using C = MathConstants<Real>;
  using I = Ieee<Real>;
  const T shifted = x * T(Real(0.6366197723675814)) + T(I::kMagic);
  const T n = shifted - T(I::kMagic);
  const T first = x - n * T(C::kHalfPi[0]);
  const Pair<T> second = ordered_sum(first, n * T(-C::kHalfPi[1]));
  const Pair<T> third = ordered_sum(second.hi, n * T(-C::kHalfPi[2]));
  Reduced<T> result = {third.hi, (second.lo + third.lo) - n * T(C::kHalfPi[3]), shifted.bits()};

  const auto large = (abs(x) > T(C::kTurns * Real(1.57))) & (abs(x) <= T(I::kLargest));
  if (large.bits() != 0) {
    const Reduced<T> other = reduce_large(x);
    result = {select(large, other.r, result.r), select(large, other.r_lo, result.r_lo),
              select(large, T::from_bits(other.quadrant), T::from_bits(result.quadrant)).bits()};
  }
  return result;
}

/// sin and cos of r + r_lo, |r| ≤ π/4 (a little more).
template <class T>
struct SinCos {
  T sin;
  T cos;
};

template <class T>
SinCos<T> sin_cos_reduced(const Reduced<T>& angle) {
  using Real = typename T::Real;
  using C = MathConstants<Real>;
  const T r = angle.r;
  const T z = r * r;
  const T half_z = T(Real(0.5)) * z;
  const T nearly_cos = T(Real(1)) - half_z;
  const T lost = (T(Real(1)) - nearly_cos) - half_z;
  const T cos = nearly_cos + (lost + (z * z * polynomial(z, C::kCos) - r * angle.r_lo));
  const T sin = r + (angle.r_lo * nearly_cos + r * z * polynomial(z, C::kSin));
  return {sin, cos};
}

/// The sine of an angle in `quadrant`, from sin and cos of what is left of it.
template <class T>
T in_quadrant(const typename T::Bits& quadrant, const SinCos<T>& left) {
  using I = Ieee<typename T::Real>;
  using Integer = typename T::Integer;
  using Bits = typename T::Bits;
  constexpr int kToSign = static_cast<int>(sizeof(Integer)) * 8 - 2;
  const auto odd = T::from_bits((quadrant & Bits(Integer(1))) << I::kMantissaBits) > T(typename T::Real(0));
  const Bits sign = (quadrant & Bits(Integer(2))) << kToSign;
  return T::from_bits(select(odd, left.cos, left.sin).bits() ^ sign);
}

/// Sine and cosine for little more than the price of one.
template <class T>
SinCos<T> sin_cos(const T& x) {
  using Real = typename T::Real;
  using Bits = typename T::Bits;
  const Reduced<T> angle = reduce(x);
  const SinCos<T> left = sin_cos_reduced(angle);
  const T sin = in_quadrant(angle.quadrant, left);
  return {select(abs(x) < T(std::numeric_limits<Real>::epsilon() / 4), x, sin),
          in_quadrant(angle.quadrant + Bits(typename T::Integer(1)), left)};
}

/// Sine; NaN of infinities, as of cos and tan. Arguments of any size are reduced with full accuracy.
template <class T>
T sin(const T& x) {
  return sin_cos(x).sin;
}

template <class T>
T cos(const T& x) {
  return sin_cos(x).cos;
}

template <class T>
T tan(const T& x) {
  const SinCos<T> both = sin_cos(x);
  return both.sin / both.cos;
}

/// k·π/4 + atan(above/below), 0 ≤ k ≤ 4 and |above/below| ≤ tan(π/8).
template <class T>
T angle_of(const T& k, const Pair<T>& above, const Pair<T>& below) {
  using Real = typename T::Real;
  using C = MathConstants<Real>;
  const T inverse = T(Real(1)) / below.hi;
  const T t = above.hi * inverse;
  const Pair<T> back = exact_product(t, below.hi);
  const T t_lo = (((above.hi - back.hi) - back.lo) + (above.lo - t * below.lo)) * inverse;
  const T z = t * t;
  const Pair<T> sum = ordered_sum(k * T(C::kQuarterPiHi), t);
  return sum.hi + (sum.lo + (t_lo + (t * z * polynomial(z, C::kAtan) + k * T(C::kQuarterPiLo))));
}

template <class T>
T atan(const T& x) {
  using Real = typename T::Real;
  const T one = T(Real(1));
  const T zero = T(Real(0));
  const T magnitude = min(T(Real(0x1p60)), abs(x));
  const auto middle = magnitude > T(Real(0.41421356237309503));
  const auto far = magnitude > T(Real(2.414213562373095));
  const Pair<T> less = ordered_sum(-one, magnitude);
  const Pair<T> more = ordered_sum(one, magnitude);
  const Pair<T> above = {select(far, -one, select(middle, less.hi, magnitude)), select(middle & !far, less.lo, zero)};
  const Pair<T> below = {select(far, magnitude, select(middle, more.hi, one)), select(middle & !far, more.lo, zero)};
  const T k = select(far, T(Real(2)), select(middle, one, zero));
  return with_sign_of(angle_of(k, above, below), x);
}

/// The angle of the point (x, y), from −π to π, as C's atan2: of zeros and infinities too.
template <class T>
T atan2(const T& y, const T& x) {
  using Real = typename T::Real;
  using Integer = typename T::Integer;
  using Bits = typename T::Bits;
  using I = Ieee<Real>;
  constexpr Integer kExponent = Integer(2 * I::kBias + 1) << I::kMantissaBits;
  const T one = T(Real(1));
  const T zero = T(Real(0));

  // The larger as a divisor, of two infinities 1 and 1, both at a scale where nothing overflows.
  const T x_size = abs(x);
  const T y_size = abs(y);
  const auto steep = y_size > x_size;
  const T longer = select(steep, y_size, x_size);
  const T shorter = select(steep, x_size, y_size);
  const auto endless = longer > T(I::kLargest);
  const T divisor = max(T(std::numeric_limits<Real>::denorm_min()), select(endless, one, longer));
  const T dividend = select(endless, select(shorter < longer, zero, min(one, shorter)), shorter);
  const Bits exponent = max(T(I::kSmallest), divisor).bits() & Bits(kExponent);
  const T unit = T::from_bits(Bits(kExponent) - exponent);
  const T b = divisor * unit;
  const T a = dividend * unit;

  const auto middle = a > b * T(Real(0.41421356237309503));
  const Pair<T> less = ordered_sum(-b, a);
  const Pair<T> more = ordered_sum(b, a);
  const T turned = select(steep, -one, one);
  const Pair<T> above = {select(middle, less.hi, a) * turned, select(middle, less.lo, zero) * turned};
  const Pair<T> below = {select(middle, more.hi, b), select(middle, more.lo, zero)};

  // Angles count from the x axis, from π/2 back, and from π back.
  const T from_axis = select(middle, one, zero);
  const T k = select(steep, T(Real(2)) - from_axis, from_axis);
  const auto left = with_sign_of(one, x) < zero;
  const T k_seen = select(left, T(Real(4)) - k, k);
  const T mirrored = select(left, -one, one);
  const T angle = angle_of(k_seen, {above.hi * mirrored, above.lo * mirrored}, below);
  return with_sign_of(angle, y);
}

/// s + tail is asin(s), of s = |x| up to ½ and of s = √((1 − |x|)/2) above.
template <class T>
struct AsinSeries {
  decltype(T() < T()) large;
  T s;
  T tail;
};

template <class T>
AsinSeries<T> asin_series(const T& x) {
  using Real = typename T::Real;
  const T half = T(Real(0.5));
  const T magnitude = abs(x);
  const auto large = magnitude > half;
  const T z = select(large, (T(Real(1)) - magnitude) * half, magnitude * magnitude);
  const T s = select(large, sqrt(z), magnitude);
  return {large, s, s * z * polynomial(z, MathConstants<Real>::kAsin)};
}

/// Arc sine; NaN outside [−1, 1].
template <class T>
T asin(const T& x) {
  using C = MathConstants<typename T::Real>;
  const AsinSeries<T> series = asin_series(x);
  const Pair<T> sum = ordered_sum(T(C::kHalfPiHi), -(series.s + series.s));
  const T large = sum.hi + (sum.lo + (T(C::kHalfPiLo) - (series.tail + series.tail)));
  return with_sign_of(select(series.large, large, series.s + series.tail), x);
}

/// Arc cosine, from 0 to π; NaN outside [−1, 1].
template <class T>
T acos(const T& x) {
  using Real = typename T::Real;
  using C = MathConstants<Real>;
  // base ∓ 2·asin(√((1 − |x|)/2)) with base 0 or π, or π/2 − asin(x).
  const AsinSeries<T> series = asin_series(x);
  const T zero = T(Real(0));
  const T two = T(Real(2));
  const auto negative = x < zero;
  const T quarters = select(series.large, select(negative, two, zero), T(Real(1)));
  const T factor = with_sign_of(select(series.large, -two, T(Real(1))), x);
  const Pair<T> sum = ordered_sum(quarters * T(C::kHalfPiHi), -(factor * series.s));
  return sum.hi + (sum.lo + (quarters * T(C::kHalfPiLo) - factor * series.tail));
}

/// x − y·floor(x/y), held within [0, y) for y > 0 and within (y, 0] for y < 0: where rounding leaves that, 0. NaN for
/// y = 0 and for infinities.
template <class T>
T mod(const T& x, const T& y) {
  const T zero = T(typename T::Real(0));
  const T period = abs(y);
  const T along = with_sign_of(x, y);
  const T rest = max(zero, along - period * floor(along / period));
  return with_sign_of(select(rest >= period, zero, rest), y);
}

}  // namespace octomarch::ops
