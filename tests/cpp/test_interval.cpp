// base/interval.hpp: every result holds what numbers of the operands give, and is exact where it can be.
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "octomarch/base/interval.hpp"

namespace octomarch {
namespace {

constexpr int kSamples = 20'000;

/// Numbers of all sizes, and those at which functions turn.
double number(std::mt19937_64& random) {
  constexpr std::array kSpecial{0.0, 1.0, -1.0, 0.5, 1e-300, -1e300, 1.5707963267948966, 3.141592653589793, 1e9};
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  switch (random() % 4) {
    case 0: return kSpecial[random() % kSpecial.size()];
    case 1: return 10.0 * uniform(random);
    case 2: return static_cast<double>(static_cast<int>(random() % 21) - 10);
    default: return std::ldexp(uniform(random), static_cast<int>(random() % 200) - 100);
  }
}

Interval interval(std::mt19937_64& random) {
  const double a = number(random);
  const double b = random() % 8 == 0 ? a : number(random);
  return {std::min(a, b), std::max(a, b)};
}

/// An end of the interval, or a number within.
double member(const Interval& a, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  const double t = uniform(random);
  const double within = a.lo() * (1.0 - t) + a.hi() * t;
  return random() % 3 == 0 ? a.lo() : random() % 2 == 0 ? a.hi() : std::clamp(within, a.lo(), a.hi());
}

bool holds(const Interval& a, long double x) {
  return static_cast<long double>(a.lo()) <= x && x <= static_cast<long double>(a.hi());
}

}  // namespace

TEST_CASE("results hold what members give") {
  std::mt19937_64 random(1);  // NOLINT(bugprone-random-generator-seed): the same numbers each time
  for (int i = 0; i < kSamples; ++i) {
    const Interval a = interval(random);
    const Interval b = interval(random);
    const long double x = member(a, random);
    const long double y = member(b, random);
    CAPTURE(x);
    CAPTURE(y);
    CHECK(holds(a + b, x + y));
    CHECK(holds(a - b, x - y));
    CHECK(holds(a * b, x * y));
    if (y != 0.0L) CHECK(holds(a / b, x / y));
    CHECK(holds(min(a, b), std::min(x, y)));
    CHECK(holds(max(a, b), std::max(x, y)));
    CHECK(holds(hull(a, b), x));
    CHECK(holds(atan2(a, b), std::atan2(x, y)));
    CHECK(holds(-a, -x));
    CHECK(holds(abs(a), std::fabs(x)));
    CHECK(holds(square(a), x * x));
    CHECK(holds(floor(a), std::floor(x)));
    CHECK(holds(exp(a), std::exp(x)));
    CHECK(holds(sin(a), std::sin(x)));
    CHECK(holds(cos(a), std::cos(x)));
    CHECK(holds(tan(a), std::tan(x)));
    CHECK(holds(atan(a), std::atan(x)));
    if (x >= 0.0L) CHECK(holds(sqrt(a), std::sqrt(x)));
    if (x > 0.0L) CHECK(holds(log(a), std::log(x)));
    if (std::fabs(x) <= 1.0L) CHECK(holds(asin(a), std::asin(x)));
    if (std::fabs(x) <= 1.0L) CHECK(holds(acos(a), std::acos(x)));
  }
}

TEST_CASE("exact where the rounded result is") {
  const Interval a{1.0, 3.0};
  CHECK(a + 2.0 == Interval{3.0, 5.0});
  CHECK(a - a == Interval{-2.0, 2.0});
  CHECK(a * Interval{-2.0, 4.0} == Interval{-6.0, 12.0});
  CHECK(Interval{-2.0, 2.0} / Interval{-8.0, -4.0} == Interval{-0.5, 0.5});
  CHECK(square(Interval{-3.0, 1.0}) == Interval{0.0, 9.0});
  CHECK(sqrt(Interval{4.0, 9.0}) == Interval{2.0, 3.0});
}

TEST_CASE("one number out where it is not") {
  const Interval sum = Interval(1.0) + 1e-30;
  CHECK(sum.lo() < 1.0 + 1e-30);
  CHECK(sum.hi() > 1.0);
  const Interval third = Interval(1.0) / 3.0;
  CHECK(third.lo() < third.hi());
  CHECK(std::nextafter(std::nextafter(third.lo(), 1.0), 1.0) == third.hi());
}

TEST_CASE("without bounds") {
  const Interval whole = Interval::whole();
  CHECK(whole * 0.0 == Interval(0.0));
  CHECK(whole + whole == whole);
  CHECK(whole / whole == whole);
  CHECK(Interval(1.0) / Interval{-1.0, 1.0} == whole);
  CHECK(Interval{kInfinity, kInfinity} - kInfinity == whole);
  CHECK(Interval{1.0, kInfinity} / Interval{2.0, kInfinity} == Interval{0.0, kInfinity});
  CHECK(sin(whole) == Interval{-1.0, 1.0});
  CHECK(cos(Interval{0.0, kInfinity}) == Interval{-1.0, 1.0});
  CHECK(tan(whole) == whole);
  CHECK(square(whole) == Interval{0.0, kInfinity});
  CHECK(exp(whole) == Interval{0.0, kInfinity});
  CHECK(Interval(1e308) * 10.0 == Interval{std::numeric_limits<double>::max(), kInfinity});
}

}  // namespace octomarch
