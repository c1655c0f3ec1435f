// Builders: the only way to make nodes. Each validates its arguments at once, throws ArgumentError that names the
// argument and the value, and returns an interned node. Lengths in scene units, angles in degrees.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "octomarch/graph/grid.hpp"
#include "octomarch/graph/node.hpp"
#include "octomarch/graph/scene.hpp"

namespace octomarch {

// Primitives ----------------------------------------------------------------------------------------------------------

/// `radius` ≥ 0, finite.
NodePtr sphere(double radius);
/// `size`: full edge lengths, each ≥ 0 and finite. `kind`: kBox, kBoxExterior or kBoxMaximum.
NodePtr box(const Vec3& size, NodeKind kind = NodeKind::kBox);
/// Half-space below the plane through `point`; `normal` need not be unit, but finite and not zero.
NodePtr plane(const Vec3& normal, const Vec3& point);
/// `height`: full height, endless when absent. `axis`: any finite direction that is not zero.
NodePtr cylinder(double radius, std::optional<double> height, const Vec3& axis);
/// Along `axis` from `radius_bottom` at −height/2 to `radius_top` at height/2.
NodePtr capped_cone(double radius_bottom, double radius_top, double height, const Vec3& axis);
/// `radius`: of the centre line; `tube_radius`: of the tube.
NodePtr torus(double radius, double tube_radius, const Vec3& axis);
/// Segment a–b thickened by `radius`; a = b is a sphere.
NodePtr capsule(const Vec3& a, const Vec3& b, double radius);
/// |x| + |y| + |z| ≤ radius.
NodePtr octahedron(double radius);
/// Square base with edges of `edge` at y = −height/2, apex at height/2.
NodePtr pyramid(double edge, double height);
/// Flat: endless along z. `size`: full edge lengths.
NodePtr rectangle(const std::array<double, 2>& size);
/// Flat. `corners`: x, y after x, y; at least three points, either way round. Where edges cross, what they enclose twice
/// is outside.
NodePtr polygon(std::vector<double> corners);
/// The field between samples on a grid that fills `box`; `size` of them along each axis, at least two, the last index
/// changing fastest. Its slope is measured. O(values).
NodePtr grid(const std::array<std::size_t, 3>& size, std::vector<float> values, const Aabb& box,
             Interpolation interpolation);
/// The user's own field. `lipschitz`: bound of its slope; where absent it is found by interval analysis over `bounds`,
/// to which the shape is cut. Throws ArgumentError where no finite bound is found.
NodePtr field(NodePtr expression, std::optional<double> lipschitz, const std::optional<Aabb>& bounds);
/// Inside where the expression is not 0.
NodePtr solid(NodePtr expression);

// Expressions ---------------------------------------------------------------------------------------------------------

/// Any number but NaN.
NodePtr constant(double value);
/// `index`: see nodes.def, 0 to 5.
NodePtr coordinate(int index);
/// A node of the expression `kind` without parameters over its operands.
NodePtr expression(NodeKind kind, std::vector<NodePtr> operands);
/// Gradient noise at the point (x, y, z). `seed` ≥ 0.
NodePtr noise(NodePtr x, NodePtr y, NodePtr z, int seed);
/// `texels`: 3·width·height finite numbers, row 0 at the top.
NodePtr image(int width, int height, std::vector<float> texels);
/// `wrap`: see nodes.def. `channel`: 0, 1 or 2.
NodePtr texel(NodePtr image, NodePtr u, NodePtr v, int channel, int wrap);

// Operators -----------------------------------------------------------------------------------------------------------

/// kUnion, kIntersection, kDifference or kMetaballs of at least one shape. `smooth` = blend distance k ≥ 0 of the quadratic
/// polynomial blend min(a, b) − max(k − |a − b|, 0)²/(4k) (I. Quilez, "smooth minimum", 2013), or of the exponential one
/// for metaballs; 0 is the hard operator.
NodePtr combine(NodeKind kind, std::vector<NodePtr> shapes, double smooth);
NodePtr complement(NodePtr shape);
/// Grown by `radius` on all sides.
NodePtr round(NodePtr shape, double radius);
/// A wall of `thickness`, half of it on either side of the surface.
NodePtr shell(NodePtr shape, double thickness);
/// Field plus `expression`. `lipschitz`: bound of its slope, else found by interval analysis over all space.
NodePtr displace(NodePtr shape, NodePtr expression, std::optional<double> lipschitz);
/// A flat shape given `height` along z, about z = 0.
NodePtr extrude(NodePtr shape, double height);
/// A flat shape turned about the y axis, after a move by `offset` ≥ 0 away from it.
NodePtr revolve(NodePtr shape, double offset);

NodePtr translate(NodePtr shape, const Vec3& offset);
/// Turned as the orthonormal, right-handed matrix turns.
NodePtr rotate(NodePtr shape, const Mat3& parent_from_child);
/// Right-handed turn by `degrees` about `axis` through the origin (Rodrigues). Quarter turns are exact.
NodePtr rotate(NodePtr shape, double degrees, const Vec3& axis);
/// `factor` > 0.
NodePtr scale(NodePtr shape, double factor);
/// `factors` > 0 along x, y, z.
NodePtr stretch(NodePtr shape, const Vec3& factors);
/// The part where coordinate `axis` (0, 1, 2) is ≥ 0, and its mirror image.
NodePtr mirror(NodePtr shape, int axis);
/// Cut through the origin, drawn apart by `lengths` ≥ 0 (in all) along x, y, z, and filled.
NodePtr elongate(NodePtr shape, const Vec3& lengths);
/// Turned about coordinate `axis` by `degrees` per unit along it. The shape must be bounded across the axis.
NodePtr twist(NodePtr shape, double degrees, int axis);
/// Bent in the x-y plane by `degrees` per unit along x. The shape must be bounded in x and y.
NodePtr bend(NodePtr shape, double degrees);
/// `period` > 0 on repeated axes and 0 on the others, at least one repeated; `counts` ≥ 1, or 0 for endless.
NodePtr repeat(NodePtr shape, const Vec3& period, const std::array<int, 3>& counts);
NodePtr paint(NodePtr shape, const Material& material);

// Many at once ---------------------------------------------------------------------------------------------------------
// Unions of shapes whose numbers stand in arrays, one row for each, at least one: the nodes that the builders above make
// of them one by one. Messages name the row.

/// Balls. `centers`: three numbers for each of `radii`.
NodePtr spheres(std::span<const double> centers, std::span<const double> radii, double smooth);
/// Exact boxes. `centers`, `sizes`: three numbers for each.
NodePtr boxes(std::span<const double> centers, std::span<const double> sizes, double smooth);
/// `a`, `b`: three numbers for each of `radii`.
NodePtr capsules(std::span<const double> a, std::span<const double> b, std::span<const double> radii, double smooth);
/// Copies of `shape`, each scaled, turned and moved as a matrix says: see motion_of(). `matrices`: twelve numbers for each.
NodePtr instances(const NodePtr& shape, std::span<const double> matrices, double rounding, double smooth);

/// The material that a kPaint node carries.
Material material_of(const Node& paint);

}  // namespace octomarch
