// Intervals of the transcendental functions, from the library's functions at their ends.
#include "octomarch/base/interval.hpp"

#include <numbers>

namespace octomarch {
namespace {

using rounding::far_above;
using rounding::far_below;

constexpr double kPi = std::numbers::pi;
const Interval kAngles{far_below(-kPi), far_above(kPi)};

/// Interval of a function that grows.
template <class Function>
Interval growing(const Interval& a, const Function& f) {
  return {far_below(f(a.lo())), far_above(f(a.hi()))};
}

/// Can `a` hold a number start + n·period? Ends too large to tell can. The margin is above all roundings here.
bool may_hold(const Interval& a, double start, double period) {
  constexpr double kLargest = 1e8;
  constexpr double kMargin = 1e-6;
  if (a.magnitude() > kLargest) return true;
  return std::floor((a.hi() - start) / period + kMargin) >= std::ceil((a.lo() - start) / period - kMargin);
}

}  // namespace

Interval exp(const Interval& a) {
  const Interval result = growing(a, [](double x) { return std::exp(x); });
  return {std::max(result.lo(), 0.0), result.hi()};
}

Interval log(const Interval& a) {
  return growing({std::max(a.lo(), 0.0), std::max(a.hi(), 0.0)}, [](double x) { return std::log(x); });
}

Interval cos(const Interval& a) {
  const double low = std::min(std::cos(a.lo()), std::cos(a.hi()));  // NaN at an infinite end, where both turns lie
  const double high = std::max(std::cos(a.lo()), std::cos(a.hi()));
  return {may_hold(a, kPi, 2.0 * kPi) ? -1.0 : std::max(far_below(low), -1.0),
          may_hold(a, 0.0, 2.0 * kPi) ? 1.0 : std::min(far_above(high), 1.0)};
}

Interval sin(const Interval& a) {
  const double low = std::min(std::sin(a.lo()), std::sin(a.hi()));
  const double high = std::max(std::sin(a.lo()), std::sin(a.hi()));
  return {may_hold(a, -0.5 * kPi, 2.0 * kPi) ? -1.0 : std::max(far_below(low), -1.0),
          may_hold(a, 0.5 * kPi, 2.0 * kPi) ? 1.0 : std::min(far_above(high), 1.0)};
}

Interval tan(const Interval& a) {
  if (may_hold(a, 0.5 * kPi, kPi)) return Interval::whole();
  return growing(a, [](double x) { return std::tan(x); });
}

Interval asin(const Interval& a) {
  return growing(a, [](double x) { return std::asin(std::clamp(x, -1.0, 1.0)); });
}

Interval acos(const Interval& a) {
  const Interval result = -growing(a, [](double x) { return -std::acos(std::clamp(x, -1.0, 1.0)); });
  return {std::max(result.lo(), 0.0), result.hi()};
}

Interval atan(const Interval& a) {
  return growing(a, [](double x) { return std::atan(x); });
}

Interval atan2(const Interval& y, const Interval& x) {
  if (y.contains(0.0) && x.lo() <= 0.0) return kAngles;
  // the angle has no extreme inside of a box without the origin, nor inside of its edges: corners alone decide
  const auto corners = {std::atan2(y.lo(), x.lo()), std::atan2(y.lo(), x.hi()), std::atan2(y.hi(), x.lo()),
                        std::atan2(y.hi(), x.hi())};
  return {far_below(std::min(corners)), far_above(std::max(corners))};
}

}  // namespace octomarch
