// base/types.hpp at its limits: unit vectors of extreme length, boxes that are empty or endless.
#include <cmath>

#include <doctest/doctest.h>

#include "octomarch/base/types.hpp"

namespace octomarch {
namespace {

TEST_CASE("normalized keeps its direction where squares would overflow or underflow") {
  for (const double length_of_input : {1e-300, 1.0, 1e300}) {
    const Vec3 unit = normalized({3.0 * length_of_input, 0.0, -4.0 * length_of_input});
    CHECK(unit.x == doctest::Approx(0.6));
    CHECK(unit.y == 0.0);
    CHECK(unit.z == doctest::Approx(-0.8));
  }
}

TEST_CASE("length neither overflows nor underflows") {
  CHECK(length({3e200, 4e200, 0.0}) == doctest::Approx(5e200));
  CHECK(length({3e-200, 4e-200, 0.0}) == doctest::Approx(5e-200).epsilon(1e-12));
}

TEST_CASE("a box is whole space by default, and empty when one axis is reversed") {
  CHECK_FALSE(is_bounded(Aabb{}));
  CHECK_FALSE(is_empty(Aabb{}));
  CHECK(is_empty(Aabb{.lo = {0.0, 1.0, 0.0}, .hi = {1.0, 0.0, 1.0}}));
  CHECK_FALSE(is_empty(Aabb{.lo = {0.0, 0.0, 0.0}, .hi = {0.0, 0.0, 0.0}}));
}

TEST_CASE("a matrix times its transpose is the identity for a rotation") {
  const double c = std::cos(0.3);
  const double s = std::sin(0.3);
  const Mat3 turn = {c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0};
  const Mat3 product = turn * transposed(turn);
  for (std::size_t i = 0; i < product.size(); ++i) CHECK(product[i] == doctest::Approx(kIdentity3[i]));
  CHECK(cross({1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}) == Vec3{0.0, 0.0, 1.0});
}

}  // namespace
}  // namespace octomarch
