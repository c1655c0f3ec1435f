// ops/math.hpp against long double: the functions that kernels have of their own, since libraries differ between
// instruction sets. Here one lane wide; tests/test_lanes.py says that all widths give the same bits, and
// tests/test_math_accuracy.py measures against more digits.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include <doctest/doctest.h>

#define OCTOMARCH_ISA math_test
#include "octomarch/kernels/lanes.hpp"
#include "octomarch/ops/math.hpp"

namespace octomarch::kernels::math_test {
namespace {

// Of power, by (1 + |y·log2 x|); what the comment on top of ops/math.hpp says, rounded up.
constexpr double kPowerUlps = 2.5;

constexpr int kSamples = 400'000;

constexpr double kGolden = 1.6180339887498949;
constexpr double kRootOfTwo = 1.4142135623730951;
constexpr double kPi = 3.141592653589793;

template <class Real>
constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
template <class Real>
constexpr Real kSmallest = std::numeric_limits<Real>::min();
template <class Real>
constexpr Real kLargest = std::numeric_limits<Real>::max();
template <class Real>
constexpr Real kLeast = std::numeric_limits<Real>::denorm_min();
template <class Real>
constexpr Real kNan = std::numeric_limits<Real>::quiet_NaN();

// A function of ours as one of numbers: OURS(sin)(x).
#define OURS(name) [](auto x) { return ops::name(Lanes<decltype(x)>(x)).v; }
#define OURS2(name) [](auto x, auto y) { return ops::name(Lanes<decltype(x)>(x), Lanes<decltype(x)>(y)).v; }
#define TRUTH(name) [](long double x) { return std::name(x); }

constexpr auto kPow = OURS2(pow);
constexpr auto kAtan2 = OURS2(atan2);
constexpr auto kMod = OURS2(mod);

/// Distance of `found` from the truth in units of the last place that the truth has in Real.
template <class Real>
double ulps(Real found, long double truth) {
  int exponent = 0;
  std::frexp(truth, &exponent);
  exponent = std::max(exponent, std::numeric_limits<Real>::min_exponent);
  const long double ulp = std::ldexp(1.0L, exponent - std::numeric_limits<Real>::digits);
  return static_cast<double>(std::fabs(static_cast<long double>(found) - truth) / ulp);
}

/// The same number, a zero's sign included, or both NaN.
template <class Real>
bool same(Real a, Real b) {
  return (std::isnan(a) && std::isnan(b)) || (a == b && std::signbit(a) == std::signbit(b));
}

/// Member i of a sequence that fills [lo, hi) evenly: multiples of an irrational number without their whole parts.
template <class Real>
Real spread(int i, double irrational, double lo, double hi) {
  const double multiple = i * irrational;
  return static_cast<Real>(lo + (hi - lo) * (multiple - std::floor(multiple)));
}

/// Numbers of every size and both signs.
template <class Real>
Real of_every_size(int i) {
  constexpr int kExponents = std::numeric_limits<Real>::max_exponent - std::numeric_limits<Real>::min_exponent;
  const Real mantissa = spread<Real>(i, kGolden, 1, 2);
  const Real x = std::ldexp(mantissa, std::numeric_limits<Real>::min_exponent + i / 2 % kExponents);
  return i % 2 == 0 ? x : -x;
}

/// Checks a function over [lo, hi) and over numbers of every size between, against `limit` ulp.
template <class Real, class Ours, class Truth>
void check_accuracy(const char* name, double lo, double hi, double limit, Ours ours, Truth truth) {
  double worst = 0;
  Real worst_at = 0;
  for (int i = 0; i < kSamples; ++i) {
    const Real x = i % 2 == 0 ? spread<Real>(i, kGolden, lo, hi) : of_every_size<Real>(i / 2);
    if (x < lo || x > hi) continue;
    const long double expected = truth(static_cast<long double>(x));
    if (std::fabs(expected) > static_cast<long double>(kLargest<Real>)) continue;
    const double error = ulps(ours(x), expected);
    if (!(error <= worst)) {
      worst = error;
      worst_at = x;
    }
  }
  INFO(std::string(name), " at ", worst_at);
  CHECK(worst < limit);
}

}  // namespace

// Limits are what docs/accuracy.md says, rounded up: samples need not have met the worst.
TEST_CASE_TEMPLATE("errors against long double", Real, float, double) {
  constexpr double kTop = static_cast<double>(kLargest<Real>);
  const double overflow = std::log(kTop);
  check_accuracy<Real>("exp", -1.2 * overflow, overflow, 0.8, OURS(exp), TRUTH(exp));
  check_accuracy<Real>("exp", -1, 1, 0.8, OURS(exp), TRUTH(exp));
  check_accuracy<Real>("exp2", -1.7 * overflow, std::log2(kTop), 0.8, OURS(exp2), TRUTH(exp2));
  check_accuracy<Real>("exp2", -1, 1, 0.8, OURS(exp2), TRUTH(exp2));
  check_accuracy<Real>("log", 0, kTop, 1.0, OURS(log), TRUTH(log));
  check_accuracy<Real>("log", 0.5, 2, 1.0, OURS(log), TRUTH(log));
  check_accuracy<Real>("log2", 0, kTop, 1.0, OURS(log2), TRUTH(log2));
  check_accuracy<Real>("log2", 0.5, 2, 1.0, OURS(log2), TRUTH(log2));
  check_accuracy<Real>("log1p", -1, kTop, 1.0, OURS(log1p), TRUTH(log1p));
  check_accuracy<Real>("log1p", -0.75, 1.5, 1.0, OURS(log1p), TRUTH(log1p));
  check_accuracy<Real>("sin", -kTop, kTop, 0.9, OURS(sin), TRUTH(sin));
  check_accuracy<Real>("sin", -10, 10, 0.9, OURS(sin), TRUTH(sin));
  check_accuracy<Real>("cos", -kTop, kTop, 0.9, OURS(cos), TRUTH(cos));
  check_accuracy<Real>("cos", -10, 10, 0.9, OURS(cos), TRUTH(cos));
  check_accuracy<Real>("tan", -kTop, kTop, 2.5, OURS(tan), TRUTH(tan));
  check_accuracy<Real>("tan", -10, 10, 2.5, OURS(tan), TRUTH(tan));
  check_accuracy<Real>("atan", -kTop, kTop, 1.0, OURS(atan), TRUTH(atan));
  check_accuracy<Real>("atan", -4, 4, 1.0, OURS(atan), TRUTH(atan));
  check_accuracy<Real>("asin", -1, 1, 1.25, OURS(asin), TRUTH(asin));
  check_accuracy<Real>("acos", -1, 1, 1.25, OURS(acos), TRUTH(acos));
}

// The last place of x is far wider there than what is left of it, so a reduction that is a little short loses all.
TEST_CASE_TEMPLATE("angles next to multiples of a quarter turn", Real, float, double) {
  for (int i = 1; i < kSamples; ++i) {
    const double quarters = std::floor(std::exp2(spread<double>(i, kGolden, 0, 50)));
    const Real x = static_cast<Real>(quarters * (kPi / 2));
    for (const Real near : {x, std::nextafter(x, Real(0)), std::nextafter(x, kInfinity<Real>)}) {
      const long double angle = near;
      REQUIRE(ulps(OURS(sin)(near), std::sin(angle)) < 0.9);
      REQUIRE(ulps(OURS(cos)(near), std::cos(angle)) < 0.9);
    }
  }
}

TEST_CASE("the hardest angles, and known ones") {
  // Of all doubles the closest to a multiple of π/2 (Kahan; J.-M. Muller, Elementary Functions, 3rd ed., ch. 11), and
  // of all floats.
  const double hardest = std::ldexp(6381956970095103.0, 797);
  CHECK(ulps(OURS(cos)(hardest), std::cos(static_cast<long double>(hardest))) < 0.9);
  CHECK(std::fabs(OURS(cos)(hardest)) < 5e-19);
  const float hardest_float = std::ldexp(16367173.0F, 72);
  CHECK(ulps(OURS(cos)(hardest_float), std::cos(static_cast<long double>(hardest_float))) < 0.9);
  CHECK(OURS(sin)(1e6) == doctest::Approx(-0.34999350217129294).epsilon(1e-15));
  CHECK(OURS(sin)(1e22) == doctest::Approx(-0.8522008497671888).epsilon(1e-15));
  CHECK(OURS(sin)(1e6F) == doctest::Approx(-0.34999350217129294).epsilon(1e-7));
}

TEST_CASE_TEMPLATE("results are bounded", Real, float, double) {
  const Real half_pi = OURS(asin)(Real(1));
  for (int i = 0; i < kSamples; ++i) {
    const Real x = of_every_size<Real>(i);
    REQUIRE(std::fabs(OURS(sin)(x)) <= Real(1));
    REQUIRE(std::fabs(OURS(cos)(x)) <= Real(1));
    REQUIRE(std::fabs(OURS(atan)(x)) <= half_pi);
    REQUIRE(std::fabs(kAtan2(x, of_every_size<Real>(i / 3))) <= OURS(acos)(Real(-1)));
    REQUIRE(OURS(exp)(x) >= Real(0));
  }
}

TEST_CASE_TEMPLATE("atan2 and pow against long double", Real, float, double) {
  constexpr double kDigits = std::numeric_limits<Real>::max_exponent;
  double worst_atan2 = 0;
  double worst_pow = 0;
  for (int i = 0; i < kSamples; ++i) {
    const Real y = i % 2 == 0 ? of_every_size<Real>(i / 2) : spread<Real>(i, kGolden, -2, 2);
    const Real x = i % 2 == 0 ? of_every_size<Real>(i / 3) : spread<Real>(i, kRootOfTwo, -2, 2);
    const long double angle = std::atan2(static_cast<long double>(y), static_cast<long double>(x));
    worst_atan2 = std::max(worst_atan2, ulps(kAtan2(y, x), angle));

    // Results of every size: the exponent is what takes the base there.
    const Real base = i % 2 == 0 ? std::fabs(of_every_size<Real>(i / 2)) : spread<Real>(i, kGolden, 0.9, 1.1);
    const double bits = std::log2(static_cast<double>(base));
    const Real exponent = static_cast<Real>(spread<double>(i, kRootOfTwo, -kDigits, kDigits) / bits);
    const long double power = std::pow(static_cast<long double>(base), static_cast<long double>(exponent));
    if (power > static_cast<long double>(kLargest<Real>)) continue;
    worst_pow = std::max(worst_pow, ulps(kPow(base, exponent), power));
  }
  CHECK(worst_atan2 < 1.0);
  CHECK(worst_pow < 1.5);
}

TEST_CASE_TEMPLATE("exact where they can be", Real, float, double) {
  for (int n = std::numeric_limits<Real>::min_exponent - 1; n < std::numeric_limits<Real>::max_exponent; ++n) {
    const Real power = std::ldexp(Real(1), n);
    CHECK(OURS(log2)(power) == static_cast<Real>(n));
    CHECK(OURS(exp2)(static_cast<Real>(n)) == power);
    CHECK(kPow(Real(2), static_cast<Real>(n)) == power);
  }
  for (int i = 0; i < 2000; ++i) {
    const Real x = static_cast<Real>(i);
    CHECK(kPow(x, Real(1)) == x);
    CHECK(kPow(x, Real(2)) == x * x);
    CHECK(kPow(x * x, Real(0.5)) == x);
    CHECK(kPow(-x, Real(1)) == -x);
  }
  CHECK(same(OURS(exp)(Real(0)), Real(1)));
  CHECK(same(OURS(log)(Real(1)), Real(0)));
  CHECK(same(OURS(cos)(Real(0)), Real(1)));
  CHECK(same(OURS(acos)(Real(1)), Real(0)));
}

// C says what they are, and the C library here follows it.
TEST_CASE_TEMPLATE("special arguments as C has them", Real, float, double) {
  const std::vector<Real> special = {
      Real(0),      Real(1),        Real(2),         Real(3),         Real(0.5),
      Real(7),      Real(1e6),      Real(0x1p60),    kSmallest<Real>, kSmallest<Real> / 2,
      kLeast<Real>, kLargest<Real>, kInfinity<Real>, kNan<Real>};
  // Equal, or within the last place where neither is 0 or infinite.
  const auto agrees = [](Real found, Real c) {
    return same(found, c) || (std::isfinite(c) && c != 0 && ulps(found, static_cast<long double>(c)) <= 3);
  };
#define CHECK_SPECIAL(name) CHECK_MESSAGE(agrees(OURS(name)(x), std::name(x)), #name "(", x, ") = ", OURS(name)(x))
  for (const Real positive : special) {
    for (const Real x : {positive, -positive}) {
      CHECK_SPECIAL(exp);
      CHECK_SPECIAL(exp2);
      CHECK_SPECIAL(log);
      CHECK_SPECIAL(log2);
      CHECK_SPECIAL(log1p);
      CHECK_SPECIAL(sin);
      CHECK_SPECIAL(cos);
      CHECK_SPECIAL(tan);
      CHECK_SPECIAL(atan);
      CHECK_SPECIAL(asin);
      CHECK_SPECIAL(acos);
      for (const Real other : special) {
        for (const Real y : {other, -other}) {
          CHECK_MESSAGE(agrees(kAtan2(x, y), std::atan2(x, y)), "atan2(", x, ", ", y, ") = ", kAtan2(x, y));
          const Real power = std::isnan(x) || std::isnan(y) ? kNan<Real> : std::pow(x, y);
          CHECK_MESSAGE(agrees(kPow(x, y), power), "pow(", x, ", ", y, ") = ", kPow(x, y));
        }
      }
    }
  }
#undef CHECK_SPECIAL
}

TEST_CASE_TEMPLATE("what is too small becomes denormal, then zero", Real, float, double) {
  const Real lowest = static_cast<Real>(std::numeric_limits<Real>::min_exponent - std::numeric_limits<Real>::digits);
  CHECK(OURS(exp2)(lowest) == kLeast<Real>);
  CHECK(OURS(exp2)(lowest - 2) == Real(0));
  CHECK(OURS(exp2)(Real(-1e6)) == Real(0));
  CHECK(OURS(exp)(Real(-1e6)) == Real(0));
  CHECK(OURS(exp)(Real(1e6)) == kInfinity<Real>);
  CHECK(kPow(Real(0.5), -lowest) == kLeast<Real>);
}

TEST_CASE_TEMPLATE("mod stays within its period", Real, float, double) {
  CHECK(kMod(Real(5.5), Real(2)) == Real(1.5));
  CHECK(kMod(Real(-0.5), Real(2)) == Real(1.5));
  CHECK(kMod(Real(5.5), Real(-2)) == Real(-0.5));
  CHECK(kMod(Real(-4), Real(2)) == Real(0));
  CHECK(kMod(-kLeast<Real>, Real(1)) == Real(0));  // 1 − 10⁻⁴⁵ would round to 1
  for (const Real x : {kNan<Real>, kInfinity<Real>, -kInfinity<Real>}) CHECK(std::isnan(kMod(x, Real(2))));
  CHECK(std::isnan(kMod(Real(1), Real(0))));
  CHECK(std::isnan(kMod(Real(1), kNan<Real>)));
  for (int i = 0; i < kSamples; ++i) {
    const Real x = of_every_size<Real>(i);
    const Real y = i % 3 == 0 ? of_every_size<Real>(i / 3) : spread<Real>(i, kRootOfTwo, -3, 3);
    const Real rest = kMod(x, y);
    REQUIRE((y > 0 ? rest >= 0 && rest < y : rest <= 0 && rest > y));
  }
}

TEST_CASE_TEMPLATE("powers as highlights take them", Real, float, double) {
  constexpr auto kPower = OURS2(power);
  double worst = 0;
  for (int i = 0; i < kSamples; ++i) {
    const Real x = spread<Real>(i, kGolden, 0, 1);
    const Real y = std::exp2(spread<Real>(i, kRootOfTwo, 0, 13));  // up to the largest exponent, 8192
    const long double truth = std::pow(static_cast<long double>(x), static_cast<long double>(y));
    if (truth < static_cast<long double>(kSmallest<Real>)) {
      CHECK(kPower(x, y) <= kSmallest<Real>);
      continue;
    }
    // a relative error of y·log2(x), rounded, becomes that many times its size in the result
    const long double amplified = 1 + std::fabs(y * std::log2(static_cast<long double>(x)));
    worst = std::max(worst, static_cast<double>(ulps(kPower(x, y), truth) / amplified));
  }
  CHECK(worst < kPowerUlps);
  MESSAGE("largest error of power: ", worst, " (1 + |y log2 x|) ulp");
  for (const Real y : {Real(1), Real(30), Real(8192)}) {
    CHECK(kPower(Real(1), y) == Real(1));
    CHECK(kPower(Real(0), y) == Real(0));
    CHECK(kPower(kSmallest<Real> / 2, y) == Real(0));
  }
}

}  // namespace octomarch::kernels::math_test
