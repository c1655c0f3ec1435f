// Builders: the only way to make nodes. Each validates its arguments at once, throws ArgumentError that names the
// argument and the value, and returns an interned node. Lengths in scene units, angles in degrees.
#pragma once

#include <optional>
#include <span>

#include "octomarch/graph/node.hpp"
#include "octomarch/graph/scene.hpp"

namespace octomarch {

/// `radius` ≥ 0, finite.
NodePtr sphere(double radius);
/// `size`: full edge lengths, each ≥ 0 and finite.
NodePtr box(const Vec3& size);
/// Half-space below the plane through `point`; `normal` need not be unit, but finite and not zero.
NodePtr plane(const Vec3& normal, const Vec3& point);
/// `height`: full height, endless when absent. `axis`: any finite direction that is not zero.
NodePtr cylinder(double radius, std::optional<double> height, const Vec3& axis);
/// `radius`: of the centre line; `tube_radius`: of the tube.
NodePtr torus(double radius, double tube_radius, const Vec3& axis);
/// Segment a–b thickened by `radius`; a = b is a sphere.
NodePtr capsule(const Vec3& a, const Vec3& b, double radius);

/// kUnion, kIntersection or kDifference of at least one shape. `smooth` = blend distance k ≥ 0 of the quadratic
/// polynomial blend min(a, b) − max(k − |a − b|, 0)²/(4k) (I. Quilez, "smooth minimum", 2013); 0 is the hard operator.
NodePtr combine(NodeKind kind, std::vector<NodePtr> shapes, double smooth);
NodePtr complement(NodePtr shape);

NodePtr translate(NodePtr shape, const Vec3& offset);
/// Right-handed turn by `degrees` about `axis` through the origin (Rodrigues). Quarter turns are exact.
NodePtr rotate(NodePtr shape, double degrees, const Vec3& axis);
/// `factor` > 0.
NodePtr scale(NodePtr shape, double factor);
/// `period` > 0 on repeated axes and 0 on the others, at least one repeated; `counts` ≥ 1, or 0 for endless.
NodePtr repeat(NodePtr shape, const Vec3& period, const std::array<int, 3>& counts);
NodePtr paint(NodePtr shape, const Material& material);

/// The material that a kPaint node carries.
Material material_of(const Node& paint);

}  // namespace octomarch
