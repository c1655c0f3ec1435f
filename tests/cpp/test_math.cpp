// ops/math.hpp against long double: the functions that kernels have of their own, since libraries differ between
// instruction sets. Here one lane wide; tests/test_lanes.py says that all widths give the same bits.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <doctest/doctest.h>

#define OCTOMARCH_ISA math_test
#include "octomarch/kernels/lanes.hpp"
#include "octomarch/ops/math.hpp"

namespace octomarch::kernels::math_test {
namespace {

// What the comment on top of ops/math.hpp says, rounded up: samples need not have met the worst.
constexpr double kLog2Ulps = 4.0;
constexpr double kExp2Ulps = 1.5;
constexpr double kPowerUlps = 3.5;

constexpr int kSamples = 2'000'000;

template <class Real>
constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
template <class Real>
constexpr Real kSmallest = std::numeric_limits<Real>::min();

template <class Real>
Real log2_of(Real x) {
  return ops::log2(Lanes<Real>(x)).v;
}
template <class Real>
Real exp2_of(Real x) {
  return ops::exp2(Lanes<Real>(x)).v;
}
template <class Real>
Real power_of(Real x, Real y) {
  return ops::power(Lanes<Real>(x), Lanes<Real>(y)).v;
}

/// Distance of `found` from the truth in units of the last place that the truth has in Real.
template <class Real>
double ulps(Real found, long double truth) {
  int exponent = 0;
  std::frexp(truth, &exponent);
  exponent = std::max(exponent, std::numeric_limits<Real>::min_exponent);
  const long double ulp = std::ldexp(1.0L, exponent - std::numeric_limits<Real>::digits);
  return static_cast<double>(std::fabs(static_cast<long double>(found) - truth) / ulp);
}

/// Member i of a sequence that fills [lo, hi) evenly: multiples of an irrational number without their whole parts.
template <class Real>
Real spread(int i, double irrational, double lo, double hi) {
  const double multiple = i * irrational;
  return static_cast<Real>(lo + (hi - lo) * (multiple - std::floor(multiple)));
}

constexpr double kGolden = 1.6180339887498949;
constexpr double kRootOfTwo = 1.4142135623730951;

}  // namespace

TEST_CASE_TEMPLATE("log2 of normal numbers", Real, float, double) {
  constexpr int kExponents = std::numeric_limits<Real>::max_exponent - std::numeric_limits<Real>::min_exponent;
  double worst = 0;
  for (int i = 0; i < kSamples; ++i) {
    // every other one in [½, 2), where the result is near 0
    const int exponent = i % 2 == 0 ? std::numeric_limits<Real>::min_exponent + i / 2 % kExponents : -(i / 2 % 2);
    const Real x = std::ldexp(spread<Real>(i, kGolden, 1, 2), exponent);
    worst = std::max(worst, ulps(log2_of(x), std::log2(static_cast<long double>(x))));
  }
  CHECK(worst < kLog2Ulps);
  MESSAGE("largest error of log2: ", worst, " ulp");
}

TEST_CASE_TEMPLATE("exp2 of all that gives a normal number", Real, float, double) {
  constexpr double kLowest = std::numeric_limits<Real>::min_exponent - 1;
  constexpr double kHighest = std::numeric_limits<Real>::max_exponent - 1;
  double worst = 0;
  for (int i = 0; i < kSamples; ++i) {
    const Real x = i % 2 == 0 ? spread<Real>(i, kGolden, kLowest, kHighest) : spread<Real>(i, kGolden, -2, 2);
    worst = std::max(worst, ulps(exp2_of(x), std::exp2(static_cast<long double>(x))));
  }
  CHECK(worst < kExp2Ulps);
  MESSAGE("largest error of exp2: ", worst, " ulp");
}

TEST_CASE_TEMPLATE("powers as highlights take them", Real, float, double) {
  double worst = 0;
  for (int i = 0; i < kSamples; ++i) {
    const Real x = spread<Real>(i, kGolden, 0, 1);
    const Real y = std::exp2(spread<Real>(i, kRootOfTwo, 0, 13));  // up to the largest exponent, 8192
    const long double truth = std::pow(static_cast<long double>(x), static_cast<long double>(y));
    if (truth < static_cast<long double>(kSmallest<Real>)) {
      CHECK(power_of(x, y) <= kSmallest<Real>);
      continue;
    }
    // a relative error of y·log2(x), rounded, becomes that many times its size in the result
    const long double amplified = 1 + std::fabs(y * std::log2(static_cast<long double>(x)));
    worst = std::max(worst, static_cast<double>(ulps(power_of(x, y), truth) / amplified));
  }
  CHECK(worst < kPowerUlps);
  MESSAGE("largest error of power: ", worst, " (1 + |y log2 x|) ulp");
}

TEST_CASE_TEMPLATE("exact where they can be", Real, float, double) {
  for (int n = std::numeric_limits<Real>::min_exponent - 1; n < std::numeric_limits<Real>::max_exponent; ++n) {
    const Real power = std::ldexp(Real(1), n);
    CHECK(log2_of(power) == static_cast<Real>(n));
    CHECK(exp2_of(static_cast<Real>(n)) == power);
  }
  for (const Real y : {Real(1), Real(30), Real(8192)}) {
    CHECK(power_of(Real(1), y) == Real(1));
    CHECK(power_of(Real(0), y) == Real(0));
    CHECK(power_of(kSmallest<Real> / 2, y) == Real(0));
  }
}

TEST_CASE_TEMPLATE("exp2 beyond the numbers", Real, float, double) {
  CHECK(exp2_of(Real(-1e6)) == Real(0));
  CHECK(exp2_of(-kInfinity<Real>) == Real(0));
  CHECK(exp2_of(Real(1e6)) == kInfinity<Real>);
  CHECK(exp2_of(kInfinity<Real>) == kInfinity<Real>);
}

}  // namespace octomarch::kernels::math_test
