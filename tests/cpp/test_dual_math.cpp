// ops/dual_math.hpp: derivatives by the chain rule against closed forms in long double, and none of them NaN or infinite
// where a function has no derivative.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>
#include <vector>

#include <doctest/doctest.h>

#define OCTOMARCH_ISA dual_math_test
#include "octomarch/kernels/lanes.hpp"
#include "octomarch/ops/dual_math.hpp"

namespace octomarch::kernels::dual_math_test {
namespace {

template <class Real>
using Number = Dual<Lanes<Real>>;

/// A variable whose derivative stands in dx, or in dy.
template <class Real>
Number<Real> along_x(Real value) {
  return {value, Real(1), Real(0), Real(0)};
}
template <class Real>
Number<Real> along_y(Real value) {
  return {value, Real(0), Real(1), Real(0)};
}

template <class Real>
constexpr Real kInfinity = std::numeric_limits<Real>::infinity();

/// The plain value bit for bit, and derivatives within a few roundings.
template <class Real>
void check(const Number<Real>& found, Lanes<Real> value, long double dx, long double dy) {
  const long double tolerance = 8 * static_cast<long double>(std::numeric_limits<Real>::epsilon());
  CHECK(found.value.v == value.v);
  CHECK(std::fabs(static_cast<long double>(found.dx.v) - dx) <= tolerance * std::fabs(dx));
  CHECK(std::fabs(static_cast<long double>(found.dy.v) - dy) <= tolerance * std::fabs(dy));
  CHECK(found.dz.v == Real(0));
}

template <class Real>
void check_none(const Number<Real>& found) {
  CHECK(found.dx.v == Real(0));
  CHECK(found.dy.v == Real(0));
  CHECK(found.dz.v == Real(0));
}

}  // namespace

TEST_CASE_TEMPLATE("derivatives of one operand", Real, float, double) {
  for (const Real v : {Real(0.0625), Real(0.3), Real(0.7), Real(0.96875)}) {
    for (const Real x : {v, -v}) {
      const Number<Real> a = along_x(x);
      const Lanes<Real> plain = x;
      const long double t = x;
      check(ops::exp(a), ops::exp(plain), std::exp(t), 0);
      check(ops::exp2(a), ops::exp2(plain), std::exp2(t) * std::log(2.0L), 0);
      check(ops::log1p(a), ops::log1p(plain), 1 / (1 + t), 0);
      check(ops::sin(a), ops::sin(plain), std::cos(t), 0);
      check(ops::cos(a), ops::cos(plain), -std::sin(t), 0);
      check(ops::tan(a), ops::tan(plain), 1 / (std::cos(t) * std::cos(t)), 0);
      check(ops::atan(a), ops::atan(plain), 1 / (1 + t * t), 0);
      check(ops::asin(a), ops::asin(plain), 1 / std::sqrt(1 - t * t), 0);
      check(ops::acos(a), ops::acos(plain), -1 / std::sqrt(1 - t * t), 0);
      check(floor(a), floor(plain), 0, 0);
    }
    check(ops::log(along_x(v)), ops::log(Lanes<Real>(v)), 1 / static_cast<long double>(v), 0);
    check(ops::log2(along_x(v)), ops::log2(Lanes<Real>(v)), 1 / (static_cast<long double>(v) * std::log(2.0L)), 0);
  }
}

TEST_CASE_TEMPLATE("derivatives of two operands", Real, float, double) {
  for (const Real x : {Real(0.3), Real(1), Real(2.75)}) {
    for (const Real y : {Real(-2.5), Real(-1), Real(0.5), Real(3)}) {
      const Number<Real> a = along_x(x);
      const Number<Real> b = along_y(y);
      const Lanes<Real> c = x;
      const Lanes<Real> d = y;
      const long double s = x;
      const long double t = y;
      check(a / b, c / d, 1 / t, -s / (t * t));
      check(a / d, c / d, 1 / t, 0);
      check(c / b, c / d, 0, -s / (t * t));
      check(ops::atan2(a, b), ops::atan2(c, d), t / (s * s + t * t), -s / (s * s + t * t));
      check(ops::pow(a, b), ops::pow(c, d), t * std::pow(s, t - 1), std::pow(s, t) * std::log(s));
      check(ops::pow(a, d), ops::pow(c, d), t * std::pow(s, t - 1), 0);
      check(ops::mod(a, b), ops::mod(c, d), 1, -std::floor(s / t));
      check(ops::mod(a, d), ops::mod(c, d), 1, 0);
    }
  }
  check(ops::pow(along_x(Real(-2)), along_y(Real(3))), Lanes<Real>(Real(-8)), 12, 0);
}

TEST_CASE_TEMPLATE("no derivative is zero, never NaN", Real, float, double) {
  const Real zero = 0;
  const Real one = 1;
  check_none(ops::log(along_x(zero)));
  check_none(ops::log2(along_x(zero)));
  check_none(ops::log1p(along_x(-one)));
  check_none(ops::asin(along_x(one)));
  check_none(ops::asin(along_x(-one)));
  check_none(ops::acos(along_x(one)));
  check_none(ops::acos(along_x(-one)));
  check_none(ops::atan2(along_x(zero), along_y(zero)));
  check_none(along_x(one) / along_y(zero));
  check_none(along_x(one) / Lanes<Real>(zero));
  check_none(Lanes<Real>(one) / along_y(zero));
  check_none(ops::pow(along_x(zero), along_y(Real(2))));
  check_none(ops::pow(along_x(zero), along_y(Real(0.5))));
  check_none(ops::pow(along_x(zero), along_y(zero)));
  CHECK(ops::pow(along_x(zero), along_y(one)).dx.v == one);
}

TEST_CASE_TEMPLATE("an overflow that ends in a finite value has a finite slope", Real, float, double) {
  const Number<Real> endless = ops::exp(along_x(Real(1e4)));
  CHECK(endless.value.v == kInfinity<Real>);
  const Number<Real> step = Lanes<Real>(Real(1)) / (endless + Lanes<Real>(Real(1)));
  CHECK(step.value.v == Real(0));
  check_none(step);
  const Number<Real> scaled = along_y(Real(3)) / (endless + Lanes<Real>(Real(1)));
  CHECK(scaled.value.v == Real(0));
  check_none(scaled);
}

}  // namespace octomarch::kernels::dual_math_test
