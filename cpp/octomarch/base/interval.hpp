// Interval arithmetic with outward rounding: what a number can be, given what it is made of. Nothing comes before this
// file; graph/expression_bounds.cpp bounds the slopes of the user's fields with it.
//
// Results of + − × ÷ and sqrt are the rounded ones where those are exact, else one number farther out; of library
// functions, which err by less than two units in the last place on the platforms there are, four farther out.
// R. E. Moore, R. B. Kearfott, M. J. Cloud, "Introduction to Interval Analysis", SIAM, 2009.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "octomarch/base/types.hpp"

namespace octomarch {

/// All numbers from lo to hi, which may be infinite; never NaN, never empty.
class Interval {
 public:
  Interval() : Interval(0.0) {}
  Interval(double value) : Interval(value, value) {}  // NOLINT(google-explicit-constructor): numbers mix in
  /// Ends in either order would be a mistake; a NaN end is an unknown one, so infinite.
  Interval(double lo, double hi) : lo_(std::isnan(lo) ? -kInfinity : lo), hi_(std::isnan(hi) ? kInfinity : hi) {}

  static Interval whole() { return {-kInfinity, kInfinity}; }

  double lo() const { return lo_; }
  double hi() const { return hi_; }
  bool is_point() const { return lo_ == hi_; }
  bool contains(double value) const { return lo_ <= value && value <= hi_; }
  /// Largest |x| in the interval.
  double magnitude() const { return std::max(std::fabs(lo_), std::fabs(hi_)); }

  friend bool operator==(const Interval&, const Interval&) = default;

 private:
  double lo_;
  double hi_;
};

namespace rounding {

/// The next number, as std::nextafter, which is a call that costs more than the arithmetic around it.
inline double above(double value) {
  if (value == 0.0) return std::numeric_limits<double>::denorm_min();
  if (value == kInfinity) return value;
  return std::bit_cast<double>(std::bit_cast<std::int64_t>(value) + (value > 0.0 ? 1 : -1));
}

inline double below(double value) { return -above(-value); }

/// Below this the error of a product or quotient may itself be lost to underflow.
inline constexpr double kTrusted = 0x1p-960;

/// `rounded`, moved one number out unless its error is known to be zero. An overflow moves back to the largest number.
template <bool up>
double outward(double rounded, double error) {
  if (error == 0.0) return rounded;
  return up ? above(rounded) : below(rounded);
}

/// Error of the rounded sum (D. E. Knuth, TAOCP vol. 2, 4.2.2); NaN where a number is infinite or overflows.
inline double sum_error(double a, double b, double sum) {
  const double part = sum - a;
  return (a - (sum - part)) + (b - part);
}

template <bool up>
double add(double a, double b) {
  const double sum = a + b;
  if (std::isinf(a) || std::isinf(b)) return sum;
  return outward<up>(sum, sum_error(a, b, sum));
}

template <bool up>
double multiply(double a, double b) {
  if (a == 0.0 || b == 0.0) return 0.0;  // also 0·∞: every number of an unbounded interval is finite
  const double product = a * b;
  if (std::isinf(a) || std::isinf(b)) return product;
  return outward<up>(product, std::fabs(product) < kTrusted ? 1.0 : std::fma(a, b, -product));
}

template <bool up>
double divide(double a, double b) {
  if (a == 0.0 || (std::isinf(b) && !std::isinf(a))) return 0.0;
  const double quotient = a / b;
  if (std::isinf(a)) return quotient;
  const bool small = std::fabs(quotient) < kTrusted || std::fabs(a) < kTrusted;
  return outward<up>(quotient, small ? 1.0 : std::fma(quotient, b, -a));
}

template <bool up>
double square_root(double a) {
  const double root = std::sqrt(a);
  if (std::isinf(a)) return root;
  return outward<up>(root, a < kTrusted && a != 0.0 ? 1.0 : std::fma(root, root, -a));
}

inline double far_below(double value) { return below(below(below(below(value)))); }
inline double far_above(double value) { return above(above(above(above(value)))); }

}  // namespace rounding

inline Interval hull(const Interval& a, const Interval& b) {
  return {std::min(a.lo(), b.lo()), std::max(a.hi(), b.hi())};
}

/// Contract: both hold the number that is meant, so they overlap but for roundings.
inline Interval overlap(const Interval& a, const Interval& b) {
  const double lo = std::max(a.lo(), b.lo());
  const double hi = std::min(a.hi(), b.hi());
  return {std::min(lo, hi), std::max(lo, hi)};
}

inline Interval operator-(const Interval& a) { return {-a.hi(), -a.lo()}; }

inline Interval operator+(const Interval& a, const Interval& b) {
  return {rounding::add<false>(a.lo(), b.lo()), rounding::add<true>(a.hi(), b.hi())};
}

inline Interval operator-(const Interval& a, const Interval& b) { return a + (-b); }

/// By the operands' signs, which say what ends the least and the greatest product are made of.
inline Interval operator*(const Interval& a, const Interval& b) {
  constexpr auto kDown = rounding::multiply<false>;
  constexpr auto kUp = rounding::multiply<true>;
  if (a.lo() >= 0.0) {
    return {kDown(b.lo() >= 0.0 ? a.lo() : a.hi(), b.lo()), kUp(b.hi() >= 0.0 ? a.hi() : a.lo(), b.hi())};
  }
  if (a.hi() <= 0.0) {
    return {kDown(b.hi() >= 0.0 ? a.lo() : a.hi(), b.hi()), kUp(b.lo() >= 0.0 ? a.hi() : a.lo(), b.lo())};
  }
  if (b.lo() >= 0.0) return {kDown(a.lo(), b.hi()), kUp(a.hi(), b.hi())};
  if (b.hi() <= 0.0) return {kDown(a.hi(), b.lo()), kUp(a.lo(), b.lo())};
  return {std::min(kDown(a.lo(), b.hi()), kDown(a.hi(), b.lo())), std::max(kUp(a.lo(), b.lo()), kUp(a.hi(), b.hi()))};
}

/// The whole line where b holds 0.
inline Interval operator/(const Interval& a, const Interval& b) {
  using rounding::divide;
  if (b.contains(0.0)) return Interval::whole();
  const bool positive = b.lo() > 0.0;
  const double low = positive ? a.lo() : -a.hi();  // of a with b's sign moved into it
  const double high = positive ? a.hi() : -a.lo();
  const double near = positive ? b.lo() : -b.hi();
  const double far = positive ? b.hi() : -b.lo();
  return {divide<false>(low, low < 0.0 ? near : far), divide<true>(high, high > 0.0 ? near : far)};
}

inline Interval abs(const Interval& a) {
  if (a.lo() >= 0.0) return a;
  if (a.hi() <= 0.0) return -a;
  return {0.0, a.magnitude()};
}

inline Interval square(const Interval& a) {
  const Interval size = abs(a);
  return {rounding::multiply<false>(size.lo(), size.lo()), rounding::multiply<true>(size.hi(), size.hi())};
}

inline Interval min(const Interval& a, const Interval& b) {
  return {std::min(a.lo(), b.lo()), std::min(a.hi(), b.hi())};
}

inline Interval max(const Interval& a, const Interval& b) {
  return {std::max(a.lo(), b.lo()), std::max(a.hi(), b.hi())};
}

inline Interval floor(const Interval& a) { return {std::floor(a.lo()), std::floor(a.hi())}; }

/// Of the numbers ≥ 0 in it; so is log, and asin and acos of those in [−1, 1]. Others have none.
inline Interval sqrt(const Interval& a) {
  return {rounding::square_root<false>(std::max(a.lo(), 0.0)), rounding::square_root<true>(std::max(a.hi(), 0.0))};
}

Interval exp(const Interval& a);
Interval log(const Interval& a);
Interval sin(const Interval& a);
Interval cos(const Interval& a);
/// The whole line where it has a pole.
Interval tan(const Interval& a);
Interval asin(const Interval& a);
Interval acos(const Interval& a);
Interval atan(const Interval& a);
/// [−π, π] where the point (x, y) may be the origin, or may cross the negative half of the x axis.
Interval atan2(const Interval& y, const Interval& x);

}  // namespace octomarch
