// What a number of a program can be over a region. Operators are instantiated over ranges as they are over lanes: every
// operation takes the ends of its operands to the ends of its result by the arithmetic of Real itself, rounded as kernels
// round. Since rounding is monotone, a range then holds what kernels compute, to the last bit, and no margin is needed;
// only functions that are approximated have one. prune.cpp decides with ranges which operand an operator takes.
//
// A range that reaches from −∞ to ∞ also stands for NaN, and whatever is made of it is such a range again.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "octomarch/base/interval.hpp"

namespace octomarch {

/// What a comparison of ranges can be.
struct Truth {
  bool may_hold;
  bool may_fail;

  friend Truth operator&(const Truth& a, const Truth& b) {
    return {a.may_hold && b.may_hold, a.may_fail || b.may_fail};
  }
  friend Truth operator|(const Truth& a, const Truth& b) {
    return {a.may_hold || b.may_hold, a.may_fail && b.may_fail};
  }
  friend Truth operator!(const Truth& a) { return {a.may_fail, a.may_hold}; }
};

template <class RealType>
struct Range {
  using Real = RealType;
  Real lo;
  Real hi;

  Range() : Range(Real(0)) {}
  Range(Real value) : Range(value, value) {}  // NOLINT(google-explicit-constructor): numbers mix in
  /// Ends that are no numbers, or in the wrong order, make it the whole line.
  Range(Real low, Real high) : lo(low), hi(high) {
    if (!(lo <= hi)) *this = whole();
  }

  static Range whole() {
    Range all;
    all.lo = -std::numeric_limits<Real>::infinity();
    all.hi = std::numeric_limits<Real>::infinity();
    return all;
  }
  bool is_whole() const {
    return lo == -std::numeric_limits<Real>::infinity() && hi == std::numeric_limits<Real>::infinity();
  }
  bool is_finite() const { return magnitude() <= std::numeric_limits<Real>::max(); }
  /// Largest |x| in it.
  Real magnitude() const { return std::max(std::fabs(lo), std::fabs(hi)); }

  friend Range operator+(const Range& a, const Range& b) { return {a.lo + b.lo, a.hi + b.hi}; }
  friend Range operator-(const Range& a, const Range& b) { return {a.lo - b.hi, a.hi - b.lo}; }
  friend Range operator-(const Range& a) { return {-a.hi, -a.lo}; }
  friend Range operator*(const Range& a, const Range& b) {
    const Real largest = a.hi * b.hi;
    if (a.lo >= Real(0) && b.lo >= Real(0) && largest <= std::numeric_limits<Real>::max())
      return {a.lo * b.lo, largest};
    const Real products[4] = {a.lo * b.lo, a.lo * b.hi, a.hi * b.lo, a.hi * b.hi};
    return enclosing(products);
  }
  friend Range operator/(const Range& a, const Range& b) {
    if (!(b.lo > Real(0) || b.hi < Real(0))) return whole();
    const Real quotients[4] = {a.lo / b.lo, a.lo / b.hi, a.hi / b.lo, a.hi / b.hi};
    return enclosing(quotients);
  }

  friend Truth operator<(const Range& a, const Range& b) { return {a.lo < b.hi, !(a.hi < b.lo)}; }
  friend Truth operator<=(const Range& a, const Range& b) { return {a.lo <= b.hi, !(a.hi <= b.lo)}; }
  friend Truth operator>(const Range& a, const Range& b) { return b < a; }
  friend Truth operator>=(const Range& a, const Range& b) { return b <= a; }
  friend Truth operator==(const Range& a, const Range& b) {
    return {a.lo <= b.hi && b.lo <= a.hi, !(a.lo == a.hi && b.lo == b.hi && a.lo == b.lo)};
  }

 private:
  static Range enclosing(const Real (&ends)[4]) {
    Real low = ends[0];
    Real high = ends[0];
    for (const Real end : ends) {
      if (std::isnan(end)) return whole();
      low = std::min(low, end);
      high = std::max(high, end);
    }
    return {low, high};
  }
};

template <class Real>
const Range<Real>& value_of(const Range<Real>& a) {
  return a;
}

template <class Real>
Range<Real> hull(const Range<Real>& a, const Range<Real>& b) {
  return {std::min(a.lo, b.lo), std::max(a.hi, b.hi)};
}

template <class Real>
Range<Real> select(const Truth& truth, const Range<Real>& a, const Range<Real>& b) {
  if (!truth.may_fail) return a;
  return truth.may_hold ? hull(a, b) : b;
}

template <class Real>
Range<Real> min(const Range<Real>& a, const Range<Real>& b) {
  if (a.is_whole() || b.is_whole()) return Range<Real>::whole();
  return {std::min(a.lo, b.lo), std::min(a.hi, b.hi)};
}

template <class Real>
Range<Real> max(const Range<Real>& a, const Range<Real>& b) {
  if (a.is_whole() || b.is_whole()) return Range<Real>::whole();
  return {std::max(a.lo, b.lo), std::max(a.hi, b.hi)};
}

template <class Real>
Range<Real> abs(const Range<Real>& a) {
  if (a.lo >= Real(0) || a.is_whole()) return a;
  return a.hi <= Real(0) ? -a : Range<Real>(Real(0), a.magnitude());
}

template <class Real>
Range<Real> square(const Range<Real>& a) {
  if (a.is_whole()) return a;
  const Range<Real> size = abs(a);
  return {size.lo * size.lo, size.hi * size.hi};
}

/// Of a number below 0 there is none.
template <class Real>
Range<Real> sqrt(const Range<Real>& a) {
  if (!(a.lo >= Real(0))) return Range<Real>::whole();
  return {std::sqrt(a.lo), std::sqrt(a.hi)};
}

template <class Real>
Range<Real> floor(const Range<Real>& a) {
  return {std::floor(a.lo), std::floor(a.hi)};
}

/// A result known in double, with room for what an approximation in Real, or roundings on the way to it, may be off.
template <class Real>
Range<Real> approximated(const Interval& exact, double magnitude) {
  constexpr double kPart = static_cast<double>(std::numeric_limits<Real>::epsilon()) * 64.0;
  const double room = magnitude * kPart + static_cast<double>(std::numeric_limits<Real>::min());
  return {static_cast<Real>(exact.lo() - room), static_cast<Real>(exact.hi() + room)};
}

/// A function of approximated numbers by its bounds over intervals. Of infinity it may be no number.
template <class Real, class Function>
Range<Real> by_interval(const Range<Real>& a, Function&& function) {
  if (!a.is_finite()) return Range<Real>::whole();
  const Interval exact = function(Interval(static_cast<double>(a.lo), static_cast<double>(a.hi)));
  return approximated<Real>(exact, exact.magnitude());
}

template <class Real>
Range<Real> exp(const Range<Real>& a) {
  return by_interval(a, [](const Interval& x) { return exp(x); });
}

template <class Real>
Range<Real> log(const Range<Real>& a) {
  return a.lo >= Real(0) ? by_interval(a, [](const Interval& x) { return log(x); }) : Range<Real>::whole();
}

template <class Real>
Range<Real> log1p(const Range<Real>& a) {
  return log(a + Range<Real>(Real(1)));
}

template <class Real>
Range<Real> sin(const Range<Real>& a) {
  return by_interval(a, [](const Interval& x) { return sin(x); });
}

template <class Real>
Range<Real> cos(const Range<Real>& a) {
  return by_interval(a, [](const Interval& x) { return cos(x); });
}

template <class Real>
Range<Real> tan(const Range<Real>& a) {
  return by_interval(a, [](const Interval& x) { return tan(x); });
}

template <class Real>
Range<Real> atan(const Range<Real>& a) {
  return by_interval(a, [](const Interval& x) { return atan(x); });
}

// No part of a field that is marched hangs on these often enough for bounds of their own.
template <class Real>
Range<Real> asin(const Range<Real>& /*a*/) {
  return Range<Real>::whole();
}

template <class Real>
Range<Real> acos(const Range<Real>& /*a*/) {
  return Range<Real>::whole();
}

template <class Real>
Range<Real> atan2(const Range<Real>& /*y*/, const Range<Real>& /*x*/) {
  return Range<Real>::whole();
}

template <class Real>
Range<Real> mod(const Range<Real>& /*a*/, const Range<Real>& /*b*/) {
  return Range<Real>::whole();
}

template <class Real>
Range<Real> pow(const Range<Real>& /*a*/, const Range<Real>& /*b*/) {
  return Range<Real>::whole();
}

}  // namespace octomarch
