// The rules for traces. See trace.hpp.
#include "octomarch/reference/trace.hpp"

#include <algorithm>
#include <cmath>

namespace octomarch::reference {
namespace {

/// The least that a function can be whose ends are at least `first` and `last`, and whose rates lie in `rise`: where the
/// steepest fall from the one meets the steepest rise to the other.
double least_between(double first, double last, const Interval& rise) {
  const double fall = rise.lo();
  const double climb = rise.hi();
  if (fall >= 0.0) return first;
  if (climb <= 0.0) return last;
  constexpr double kLargest = 0x1p1000;  // lest the difference below be infinite
  if (fall < -kLargest || climb > kLargest) {
    return std::max(rounding::add<false>(first, fall), rounding::add<false>(last, -climb));
  }
  const double share = climb / (climb - fall);  // of the first end
  const double dip = fall * share;
  const double meeting = first * share + last * (1.0 - share) + dip;
  constexpr double kRounding = 0x1p-50;  // of six operations, twice over
  const double error = kRounding * (std::fabs(first) + std::fabs(last) + std::fabs(dip));
  return meeting - error - std::numeric_limits<double>::min();
}

Interval doubled(const Interval& a) { return {2.0 * a.lo(), 2.0 * a.hi()}; }

/// a/b where b ≥ 0, which may be 0 only where a is too.
Interval over_positive(const Interval& a, const Interval& b) {
  using rounding::divide;
  const double low = a.lo() >= 0.0 ? b.hi() : b.lo();
  const double high = a.hi() > 0.0 ? b.lo() : b.hi();
  return {a.lo() == 0.0 ? 0.0
          : low == 0.0  ? -kInfinity
                        : divide<false>(a.lo(), low),
          a.hi() == 0.0 ? 0.0
          : high == 0.0 ? kInfinity
                        : divide<true>(a.hi(), high)};
}

/// v·v′, half the rate of ‖v‖². Where v goes straight it only grows.
Interval dot_with_rates(std::span<const Trace> v) {
  Interval anywhere;
  Interval first;
  Interval last;
  bool is_straight = true;
  for (const Trace& a : v) {
    anywhere = anywhere + a.over * a.rise;
    first = first + a.first * a.rise;
    last = last + a.last * a.rise;
    is_straight = is_straight && a.is_straight;
  }
  return is_straight ? overlap(anywhere, hull(first, last)) : anywhere;
}

/// One end of min(a, b) − max(k − |a − b|, 0)²/(4k).
Interval smoothed(double a, double b, double k) {
  const Interval least = std::min(a, b);
  if (std::isinf(a) || std::isinf(b)) return least;  // below by up to k/4, which is no matter there
  const Interval both = max(Interval(k) - abs(Interval(a) - Interval(b)), 0.0);
  return least - both / Interval(4.0 * k) * both;
}

Interval melted(double a, double b, double k) {
  const Interval least = std::min(a, b);
  if (std::isinf(a) || std::isinf(b)) return least;
  const Interval apart = abs(Interval(a) - Interval(b)) / Interval(k);
  return least - Interval(k) * log(Interval(1.0) + exp(-apart));
}

/// f of intervals by their ends, f growing with each of its operands.
template <class Function>
Interval by_ends(const Function& f, const Interval& a, const Interval& b) {
  return {f(a.lo(), b.lo()).lo(), f(a.hi(), b.hi()).hi()};
}

}  // namespace

Trace undefined() {
  const Interval whole = Interval::whole();
  return {whole, whole, whole, whole, false, true};
}

Trace tightened(const Trace& a) {
  Trace result = a;
  const Interval by_rates{least_between(a.first.lo(), a.last.lo(), a.rise),
                          -least_between(-a.first.hi(), -a.last.hi(), -a.rise)};
  result.over = overlap(a.over, by_rates);
  return result;
}

Trace operator+(const Trace& a, const Trace& b) {
  Trace sum = mapped([](const Interval& x, const Interval& y) { return x + y; }, a.rise + b.rise, a, b);
  sum.is_straight = a.is_straight && b.is_straight;
  return sum;
}

Trace operator-(const Trace& a) { return {-a.over, -a.first, -a.last, -a.rise, a.is_straight, a.is_undefined}; }

Trace operator-(const Trace& a, const Trace& b) { return a + (-b); }

Trace operator*(const Trace& a, const Trace& b) {
  return mapped([](const Interval& x, const Interval& y) { return x * y; }, a.over * b.rise + b.over * a.rise, a, b);
}

Trace operator*(const Trace& a, const Interval& factor) {
  return {a.over * factor, a.first * factor, a.last * factor, a.rise * factor, a.is_straight, a.is_undefined};
}

Trace operator/(const Trace& a, const Trace& b) {
  if (b.over.contains(0.0)) return undefined();
  const Interval quotient = a.over / b.over;
  return mapped([](const Interval& x, const Interval& y) { return x / y; }, (a.rise - quotient * b.rise) / b.over, a,
                b);
}

Trace operator/(const Trace& a, const Interval& divisor) {
  return {a.over / divisor, a.first / divisor, a.last / divisor, a.rise / divisor, a.is_straight, a.is_undefined};
}

Trace square(const Trace& a) {
  return mapped([](const Interval& x) { return square(x); }, doubled(a.over) * a.rise, a);
}

Trace sqrt(const Trace& a) {
  if (a.over.lo() < 0.0) return undefined();
  const auto root = [](const Interval& x) { return sqrt(x); };
  return mapped(root, over_positive(a.rise, doubled(sqrt(a.over))), a);
}

Trace abs(const Trace& a) {
  if (a.over.lo() >= 0.0) return a;
  if (a.over.hi() <= 0.0) return -a;
  return mapped([](const Interval& x) { return abs(x); }, hull(a.rise, -a.rise), a);
}

Trace min(const Trace& a, const Trace& b) {
  if (a.is_undefined || b.is_undefined) return undefined();
  if (a.over.hi() <= b.over.lo()) return a;
  if (b.over.hi() <= a.over.lo()) return b;
  return mapped([](const Interval& x, const Interval& y) { return min(x, y); }, hull(a.rise, b.rise), a, b);
}

Trace max(const Trace& a, const Trace& b) { return -min(-a, -b); }

double speed(std::span<const Trace> v) {
  double squared = 0.0;
  for (const Trace& a : v) {
    const double rate = a.rise.magnitude();
    squared = rounding::add<true>(squared, rounding::multiply<true>(rate, rate));
  }
  return rounding::square_root<true>(squared);
}

Trace no_faster(Trace a, double most) {
  a.rise = overlap(a.rise, {-most, most});
  return tightened(a);
}

Trace length(std::span<const Trace> v) {
  Trace result = constant(0.0);
  for (const Trace& a : v) {
    result.over = result.over + square(a.over);
    result.first = result.first + square(a.first);
    result.last = result.last + square(a.last);
    result.is_undefined = result.is_undefined || a.is_undefined;
  }
  result = {sqrt(result.over), sqrt(result.first), sqrt(result.last), {}, false, result.is_undefined};
  const double most = speed(v);
  result.rise = overlap(over_positive(dot_with_rates(v), result.over), {-most, most});
  return tightened(result);
}

Interval blend(const Interval& a, const Interval& b, const Interval& share) {
  const auto mixed = [&](double of_b) { return (Interval(1.0) - Interval(of_b)) * a + Interval(of_b) * b; };
  return share.is_point() ? mixed(share.lo()) : hull(mixed(share.lo()), mixed(share.hi()));
}

Trace smooth_minimum(const Trace& a, const Trace& b, double k) {
  if (k == 0.0 || a.is_undefined || b.is_undefined) return min(a, b);
  const Interval ahead = a.over - b.over;
  if (ahead.hi() <= -k) return a;
  if (ahead.lo() >= k) return b;
  const auto value = [k](const Interval& x, const Interval& y) {
    return by_ends([k](double p, double q) { return smoothed(p, q, k); }, x, y);
  };
  const Interval share = Interval(0.5) + ahead / Interval(2.0 * k);  // of b
  return mapped(value, blend(a.rise, b.rise, min(max(share, 0.0), 1.0)), a, b);
}

Trace exponential_minimum(const Trace& a, const Trace& b, double k) {
  const auto value = [k](const Interval& x, const Interval& y) {
    return by_ends([k](double p, double q) { return melted(p, q, k); }, x, y);
  };
  const Interval share = Interval(1.0) / (Interval(1.0) + exp((b.over - a.over) / Interval(k)));  // of b
  return mapped(value, blend(a.rise, b.rise, min(max(share, 0.0), 1.0)), a, b);
}

}  // namespace octomarch::reference
