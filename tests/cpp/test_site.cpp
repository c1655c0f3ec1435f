// graph/site.hpp: what coordinates count from, and how far rays are moved along.
#include <doctest/doctest.h>

#include "octomarch/graph/site.hpp"

namespace octomarch {
namespace {

Aabb cube_at(const Vec3& middle, double half) {
  return {middle - Vec3{half, half, half}, middle + Vec3{half, half, half}};
}

Site site_of_cube(const Vec3& middle, double half = 1.0) {
  const Aabb box = cube_at(middle, half);
  return site_of(box, box);
}

TEST_CASE("the anchor is the origin unless the focus is far from it") {
  CHECK(site_of_cube({27.0, 0.0, 0.0}).anchor == Vec3{});
  CHECK(site_of_cube({1000.3, 0.9, -3e8}).anchor == Vec3{1000.0, 0.0, -3e8});  // radius 1.7, a grid of twos
  CHECK(site_of(std::nullopt, Aabb{}).anchor == Vec3{});
}

TEST_CASE("the anchor of a point, or of what is far beyond its own size, is its place") {
  CHECK(site_of_cube({100.0, 0.0, 0.0}, 0.0).anchor == Vec3{100.0, 0.0, 0.0});
  CHECK(site_of_cube({1e300, 0.0, 0.0}, 1e-300).anchor == Vec3{1e300, 0.0, 0.0});
}

TEST_CASE("without a focus pictures count from a far eye") {
  const Site endless = site_of(std::nullopt, Aabb{});
  CHECK(anchor_seen_from(endless, {1000.0, 2.0, 0.0}, 1e-6, 1e-4) == Vec3{});
  CHECK(anchor_seen_from(endless, {0.0, 2.0, -2000.0}, 1e-6, 1e-4) == Vec3{0.0, 2.0, -2000.0});
  CHECK(anchor_seen_from(site_of_cube({}), {0.0, 2.0, -2000.0}, 1e-6, 1e-4) == Vec3{});
}

TEST_CASE("amid a large focus pictures count from the eye where coordinates are too coarse for epsilon") {
  const Site large = site_of_cube({}, 1e5);
  CHECK(anchor_seen_from(large, {9e4, 0.0, 0.0}, 1e-6, 1e-2) == Vec3{9e4, 0.0, 0.0});
  CHECK(anchor_seen_from(large, {9e4, 0.0, 0.0}, 1e-6, 0.1) == Vec3{});
  CHECK(anchor_seen_from(large, {9e4, 0.0, 0.0}, 1e-15, 1e-2) == Vec3{});
  CHECK(anchor_seen_from(large, {2e5, 0.0, 0.0}, 1e-6, 1e-2) == Vec3{});
}

TEST_CASE("rays are moved along where the bounds are far, and stay two radii away") {
  const Site site = site_of_cube({});
  CHECK(lead_of(site, {20.0, 0.0, 0.0}, 0.0) == 0.0);
  CHECK(lead_of(site, {0.0, 1001.0, 0.0}, 0.0) == doctest::Approx(1000.0 - 2.0 * site.radius));
  CHECK(lead_of(site, {0.0, 1001.0, 0.0}, 500.0) == doctest::Approx(500.0 - 2.0 * site.radius));
  CHECK(lead_of(site, {0.0, 1001.0, 0.0}, 1000.0) == 0.0);
  CHECK(lead_of(site, {1e30, 0.0, 0.0}, 0.0) == 0.0);
  CHECK(lead_of(site_of(cube_at({}, 1.0), Aabb{}), {0.0, 1001.0, 0.0}, 0.0) == 0.0);
}

TEST_CASE("parallel rays are moved by the way to the plane that touches the bounds") {
  const Site site = site_of_cube({});
  CHECK(parallel_lead_of(site, {300.0, 0.0, 1001.0}, {0.0, 0.0, -1.0}, 0.0) ==
        doctest::Approx(1000.0 - 2.0 * site.radius));
  CHECK(parallel_lead_of(site, {300.0, 0.0, 1001.0}, {0.0, 0.0, 1.0}, 0.0) == 0.0);
  const Aabb floor{.lo = {-kInfinity, -kInfinity, -kInfinity}, .hi = {kInfinity, 0.0, kInfinity}};
  const Site on_floor = site_of(cube_at({}, 1.0), floor);
  CHECK(parallel_lead_of(on_floor, {0.0, 1000.0, 0.0}, {0.0, -1.0, 0.0}, 0.0) > 990.0);
  CHECK(parallel_lead_of(on_floor, {0.0, 1000.0, 0.0}, {0.6, -0.8, 0.0}, 0.0) == 0.0);
}

}  // namespace
}  // namespace octomarch
