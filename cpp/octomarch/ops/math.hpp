// Transcendental functions of our own, from + − × ÷ √ and bit patterns only, so that every ISA gives the same bits: the
// machine's libraries, and xsimd's, differ with the presence of fused multiply-add. Lanes only, see math_parts.hpp.
// Derivatives are in dual_math.hpp.
//
// NaN gives NaN; infinities, zeros and their signs are as in C unless a function says otherwise. Numbers below the
// normal ones are taken and given as they are.
//
// Largest errors found, in units of the last place, float and double (docs/accuracy.md says how):
//   exp 0.78 0.77   exp2 0.78 0.77   log   0.91 0.89   log2  0.85 0.80   log1p 0.91 0.88   pow 0.80 1.30
//   sin 0.83 0.81   cos  0.84 0.78   tan   2.36 2.25   asin  1.11 1.09   acos  1.10 1.08
//   atan 0.91 0.80  atan2 0.95 0.93
#pragma once

#include "octomarch/ops/math_constants.hpp"
#include "octomarch/ops/math_parts.hpp"
#include "octomarch/ops/math_reduction.hpp"

namespace octomarch::ops {

/// A positive normal number as (1 + f)·2ᵉ with 1 + f in (√½, √2].
template <class T>
struct Split {
  T exponent;
  T f;
};

template <class T>
[[gnu::always_inline]] inline Split<T> split(const T& x) {
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
[[gnu::always_inline]] inline Split<T> split_any(const T& x) {
  using Real = typename T::Real;
  constexpr int kUp = Ieee<Real>::kMantissaBits + 1;
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
[[gnu::always_inline]] inline LogSeries<T> log_series(const T& f) {
  using Real = typename T::Real;
  const T half_square = T(Real(0.5)) * f * f;
  const T s = f / (T(Real(2)) + f);
  const T z = s * s;
  return {half_square, s * (half_square + z * polynomial(z, MathConstants<T>::kLog)), s};
}

/// Logarithms' results where x is not a positive finite number.
template <class T>
[[gnu::always_inline]] inline T log_or_special(const T& x, const T& log) {
  using I = Ieee<typename T::Real>;
  const T above = select(x <= T(I::kLargest), log, x);
  const T at_zero = select(x == T(typename T::Real(0)), T(-I::kInfinity), above);
  return select(x < T(typename T::Real(0)), T(I::kNan), at_zero);
}

/// Natural logarithm.
template <class T>
[[gnu::always_inline]] inline T log(const T& x) {
  using C = MathConstants<T>;
  const auto [exponent, f] = split_any(x);
  const LogSeries<T> series = log_series(f);
  const Pair<T> sum = ordered_sum(exponent * T(C::kLn2Hi), f);
  const T small = exponent * T(C::kLn2Lo) - (series.half_square - series.rest);
  return log_or_special(x, sum.hi + (sum.lo + small));
}

/// Logarithm to base 2, exact for powers of two.
template <class T>
[[gnu::always_inline]] inline T log2(const T& x) {
  using C = MathConstants<T>;
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
[[gnu::always_inline]] inline T log1p(const T& x) {
  using Real = typename T::Real;
  using Integer = typename T::Integer;
  using Bits = typename T::Bits;
  using C = MathConstants<T>;
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
  return select(abs(x) < T(Ieee<Real>::kNegligible), x, result);
}

/// eˣ. Overflow gives +inf, and small results become denormal, then 0.
template <class T>
[[gnu::always_inline]] inline T exp(const T& x) {
  using Real = typename T::Real;
  using C = MathConstants<T>;
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
[[gnu::always_inline]] inline T exp2_of_parts(const T& n, const T& f, const T& more) {
  using Real = typename T::Real;
  using C = MathConstants<T>;
  const T f_hi = upper_half(f);
  const T linear = f_hi * T(C::kLn2Short);
  const T rest = (f - f_hi) * T(C::kLn2Short) + (f * T(C::kLn2Rest) + more * T(Real(0.6931471805599453)));
  const Pair<T> sum = ordered_sum(T(Real(1)), linear);
  return scaled(sum.hi + (sum.lo + (rest + f * f * polynomial(f, C::kExp2))), n);
}

/// 2ˣ, exact for whole x. Overflow gives +inf, and small results become denormal, then 0.
template <class T>
[[gnu::always_inline]] inline T exp2(const T& x) {
  using Real = typename T::Real;
  const T held = clamped(x, Ieee<Real>::kIsFloat ? Real(-151) : Real(-1076), Real(Ieee<Real>::kBias + 2));
  const T n = nearest(held);
  return exp2_of_parts(n, held - n, T(Real(0)));
}

/// log2 of a positive number with about 1.5 times the digits of T: 2/ln 2·(s + s³/3 + …), s = f/(2 + f).
template <class T>
[[gnu::always_inline]] inline Pair<T> log2_in_two_parts(const T& x) {
  using Real = typename T::Real;
  using C = MathConstants<T>;
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
[[gnu::always_inline]] inline T pow(const T& x, const T& y) {
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

/// xʸ for 0 ≤ x and y > 0, with 0ʸ = 0 (numbers below the normal ones count as 0): a fast one for highlights, good to
/// 2·(1 + |y·log2 x|) ulp.
template <class T>
[[gnu::always_inline]] inline T power(const T& x, const T& y) {
  using Real = typename T::Real;
  const auto [exponent, f] = split(x);
  const LogSeries<T> series = log_series(f);
  const T log2_of_mantissa = (f - (series.half_square - series.rest)) * T(Real(1.4426950408889634));
  const T result = exp2(y * (exponent + log2_of_mantissa));
  return select(x < T(Ieee<Real>::kSmallest), T(Real(0)), result);
}

/// sin and cos of r + r_lo, |r| ≤ π/4 (a little more).
template <class T>
struct SinCos {
  T sin;
  T cos;
};

template <class T>
[[gnu::always_inline]] inline SinCos<T> sin_cos_reduced(const Reduced<T>& angle) {
  using Real = typename T::Real;
  using C = MathConstants<T>;
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
[[gnu::always_inline]] inline T in_quadrant(const typename T::Bits& quadrant, const SinCos<T>& left) {
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
[[gnu::always_inline]] inline SinCos<T> sin_cos(const T& x) {
  using Real = typename T::Real;
  using Bits = typename T::Bits;
  const Reduced<T> angle = reduce(x);
  const SinCos<T> left = sin_cos_reduced(angle);
  const T sin = in_quadrant(angle.quadrant, left);
  return {select(abs(x) < T(Ieee<Real>::kNegligible), x, sin),
          in_quadrant(angle.quadrant + Bits(typename T::Integer(1)), left)};
}

/// Sine; NaN of infinities, as of cos and tan. Arguments of any size are reduced with full accuracy.
template <class T>
[[gnu::always_inline]] inline T sin(const T& x) {
  return sin_cos(x).sin;
}

template <class T>
[[gnu::always_inline]] inline T cos(const T& x) {
  return sin_cos(x).cos;
}

template <class T>
[[gnu::always_inline]] inline T tan(const T& x) {
  const SinCos<T> both = sin_cos(x);
  return both.sin / both.cos;
}

/// k·π/4 + atan(above/below), 0 ≤ k ≤ 4 and |above/below| ≤ tan(π/8).
template <class T>
[[gnu::always_inline]] inline T angle_of(const T& k, const Pair<T>& above, const Pair<T>& below) {
  using Real = typename T::Real;
  using C = MathConstants<T>;
  const T inverse = T(Real(1)) / below.hi;
  const T t = above.hi * inverse;
  const Pair<T> back = exact_product(t, below.hi);
  const T t_lo = (((above.hi - back.hi) - back.lo) + (above.lo - t * below.lo)) * inverse;
  const T z = t * t;
  const Pair<T> sum = ordered_sum(k * T(C::kQuarterPiHi), t);
  return sum.hi + (sum.lo + (t_lo + (t * z * polynomial(z, C::kAtan) + k * T(C::kQuarterPiLo))));
}

template <class T>
[[gnu::always_inline]] inline T atan(const T& x) {
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
[[gnu::always_inline]] inline T atan2(const T& y, const T& x) {
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
  const T divisor = max(T(I::kLeast), select(endless, one, longer));
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
[[gnu::always_inline]] inline AsinSeries<T> asin_series(const T& x) {
  using Real = typename T::Real;
  const T half = T(Real(0.5));
  const T magnitude = abs(x);
  const auto large = magnitude > half;
  const T z = select(large, (T(Real(1)) - magnitude) * half, magnitude * magnitude);
  const T s = select(large, sqrt(z), magnitude);
  return {large, s, s * z * polynomial(z, MathConstants<T>::kAsin)};
}

/// Arc sine; NaN outside [−1, 1].
template <class T>
[[gnu::always_inline]] inline T asin(const T& x) {
  using C = MathConstants<T>;
  const AsinSeries<T> series = asin_series(x);
  const Pair<T> sum = ordered_sum(T(C::kHalfPiHi), -(series.s + series.s));
  const T large = sum.hi + (sum.lo + (T(C::kHalfPiLo) - (series.tail + series.tail)));
  return with_sign_of(select(series.large, large, series.s + series.tail), x);
}

/// Arc cosine, from 0 to π; NaN outside [−1, 1].
template <class T>
[[gnu::always_inline]] inline T acos(const T& x) {
  using Real = typename T::Real;
  using C = MathConstants<T>;
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
[[gnu::always_inline]] inline T mod(const T& x, const T& y) {
  const T zero = T(typename T::Real(0));
  const T period = abs(y);
  const T along = with_sign_of(x, y);
  const T rest = max(zero, along - period * floor(along / period));
  return with_sign_of(select(rest >= period, zero, rest), y);
}

}  // namespace octomarch::ops
