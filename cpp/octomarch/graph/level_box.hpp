// Boxes that hold level sets, and what operators do to them. The analysis carries them up the graph; primitives begin them.
#pragma once

#include <array>
#include <span>

#include "octomarch/graph/analysis.hpp"

namespace octomarch {

using Axis3 = std::array<double, 3>;

inline Axis3 array_of(const Vec3& v) { return {v.x, v.y, v.z}; }
inline Vec3 vector_of(const Axis3& a) { return {a[0], a[1], a[2]}; }

/// The smaller, or larger, of each coordinate.
Vec3 smaller(const Vec3& a, const Vec3& b);
Vec3 larger(const Vec3& a, const Vec3& b);

bool is_bounded(const LevelBox& box);
LevelBox hull(const LevelBox& a, const LevelBox& b);
LevelBox overlap(const LevelBox& a, const LevelBox& b);
LevelBox grown(const LevelBox& box, double level);
LevelBox moved(const LevelBox& box, const Vec3& offset);
LevelBox scaled(const LevelBox& box, double factor);
/// Bounds of the rotated box. An axis that is empty at level 0 counts as a point there.
LevelBox rotated(const LevelBox& box, std::span<const double> rotation);
/// factors · (child's box); a level c is one of c/min(factors) in the child.
LevelBox stretched(const LevelBox& box, const Vec3& factors);
/// What lies where the coordinate is ≥ 0, and its mirror image.
LevelBox mirrored(const LevelBox& box, double axis);
/// Within `radius` of an axis and, along it, where the child is.
LevelBox within_cylinder(const LevelBox& box, double radius, std::size_t axis);
/// A flat shape's, between z = ±half_height.
LevelBox between(const LevelBox& box, double half_height);
/// A flat shape's, moved by `offset` along x and turned about y.
LevelBox revolved(const LevelBox& box, double offset);
/// Of all copies of a kRepeat node.
LevelBox repeated(const LevelBox& box, const Node& node);

}  // namespace octomarch
