// Where a shape is, for arithmetic on numbers as small as they can be: what coordinates are counted from, and how far a ray
// may go at once before it is near anything. Comes after analysis.hpp; programs are compiled at a site, and pictures, queries
// and the reference keep to it alike.
#pragma once

#include <optional>

#include "octomarch/base/types.hpp"

namespace octomarch {

/// What is more than this many radii away is far.
inline constexpr double kFar = 16.0;
/// At this many radii a double's own rounding moves rays by 1/4000 of one; from there on they are left alone.
inline constexpr double kTooFar = 0x1p40;
/// An eye at this distance from the origin is far from it where nothing is bounded, and the scene's size counts as 1.
inline constexpr double kFarEye = 1024.0;

struct Site {
  Vec3 anchor;                ///< where coordinates are counted from: the origin, unless the shape is far from it
  Aabb bounds;                ///< of the solid, from the anchor
  std::optional<Aabb> focus;  ///< of the bounded parts, likewise
  double radius = kInfinity;  ///< half the scene's size: of the bounded parts' diagonal; infinite where there are none
  double inner_offset = 0.0;  ///< the farthest that operators move coordinates back; 0 where the anchor is the origin
};

/// The site of a shape that fills `bounds`, and whose bounded parts fill `focus`. The anchor is the middle of the focus where
/// that is far from the origin, on a grid of powers of two.
Site site_of(const std::optional<Aabb>& focus, const Aabb& bounds);

/// The same place with another anchor.
Site counted_from(const Vec3& anchor, const Site& site);

/// The anchor of pictures from an eye. It is the eye itself where that is far and no part of the shape is bounded, or where it
/// stands amid the bounded parts and roundings there, of its largest coordinate times `rounding`, are more than `epsilon`.
Vec3 anchor_seen_from(const Site& site, const Vec3& eye, double rounding, double epsilon);

/// How far a ray from a point (counted from the anchor) is moved along at once, in double: up to two radii from the bounds
/// where they are far, less `min_distance`; else 0. At its start, t = min_distance + radius from there, it is outside of them.
double lead_of(const Site& site, const Vec3& from, double min_distance);

/// The same for all rays along a unit direction from a plane through `from` that is square to it.
double parallel_lead_of(const Site& site, const Vec3& from, const Vec3& direction, double min_distance);

}  // namespace octomarch
