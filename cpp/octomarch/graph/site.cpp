#include "octomarch/graph/site.hpp"

#include <algorithm>
#include <cmath>

namespace octomarch {
namespace {

double largest_magnitude(const Vec3& v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

/// The nearest multiple of `grid`, where that is a number of some precision.
double rounded(double x, double grid) {
  constexpr double kExact = 0x1p52;
  const double cells = x / grid;
  return std::fabs(cells) < kExact ? std::nearbyint(cells) * grid : x;
}

/// What is left of the way to the bounds.
double lead_over(const Site& site, double distance, double min_distance) {
  const bool is_far = distance > kFar * site.radius && distance < kTooFar * site.radius;
  return is_far ? std::max(distance - 2.0 * site.radius - min_distance, 0.0) : 0.0;
}

}  // namespace

Site site_of(const std::optional<Aabb>& focus, const Aabb& bounds) {
  Site site;
  site.bounds = bounds;
  site.focus = focus;
  if (!focus) return site;
  const double diagonal = length(focus->hi - focus->lo);
  site.radius = diagonal > 0.0 ? 0.5 * diagonal : 0.5;
  const Vec3 middle = focus->lo * 0.5 + focus->hi * 0.5;
  if (!(largest_magnitude(middle) > kFar * site.radius)) return site;
  const double grid = std::exp2(std::ceil(std::log2(site.radius)));
  site.anchor = {rounded(middle.x, grid), rounded(middle.y, grid), rounded(middle.z, grid)};
  site.bounds = counted_from(site.anchor, bounds);
  site.focus = counted_from(site.anchor, *focus);
  return site;
}

Site counted_from(const Vec3& anchor, const Site& site) {
  Site moved = site;
  moved.anchor = anchor;
  const Vec3 move = anchor - site.anchor;
  moved.bounds = counted_from(move, site.bounds);
  if (site.focus) moved.focus = counted_from(move, *site.focus);
  return moved;
}

Vec3 anchor_seen_from(const Site& site, const Vec3& eye, double rounding, double epsilon) {
  if (!site.focus) return largest_magnitude(eye) > kFarEye ? eye : site.anchor;
  const Vec3 from_anchor = eye - site.anchor;
  const bool is_coarse = rounding * largest_magnitude(from_anchor) > epsilon;
  return is_coarse && contains(*site.focus, from_anchor) ? eye : site.anchor;
}

double lead_of(const Site& site, const Vec3& from, double min_distance) {
  if (is_empty(site.bounds)) return 0.0;
  const auto outside = [](double x, double lo, double hi) { return std::max({lo - x, x - hi, 0.0}); };
  const Aabb& box = site.bounds;
  const Vec3 away{outside(from.x, box.lo.x, box.hi.x), outside(from.y, box.lo.y, box.hi.y),
                  outside(from.z, box.lo.z, box.hi.z)};
  if (2.0 * largest_magnitude(away) <= kFar * site.radius) return 0.0;  // most queries' rays: no root for them
  return lead_over(site, length(away), min_distance);
}

double parallel_lead_of(const Site& site, const Vec3& from, const Vec3& direction, double min_distance) {
  if (is_empty(site.bounds)) return 0.0;
  const auto along = [](double x, double d, double lo, double hi) {
    return d == 0.0 ? 0.0 : ((d > 0.0 ? lo : hi) - x) * d;
  };
  const Aabb& box = site.bounds;
  return lead_over(site,
                   along(from.x, direction.x, box.lo.x, box.hi.x) + along(from.y, direction.y, box.lo.y, box.hi.y) +
                       along(from.z, direction.z, box.lo.z, box.hi.z),
                   min_distance);
}

}  // namespace octomarch
