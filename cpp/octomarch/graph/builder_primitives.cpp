// Builders of primitives: arguments as users give them become node parameters. The bindings come before it, intern()
// after.
#include <algorithm>
#include <utility>

#include "octomarch/graph/builder.hpp"
#include "octomarch/graph/checks.hpp"
#include "octomarch/graph/expression_bounds.hpp"

namespace octomarch {
namespace {

/// Number of the coordinate axis along which the unit vector `v` points, if it does, either way.
std::optional<double> coordinate_axis(const Vec3& v) {
  if (v.y == 0.0 && v.z == 0.0) return 0.0;
  if (v.x == 0.0 && v.z == 0.0) return 1.0;
  if (v.x == 0.0 && v.y == 0.0) return 2.0;
  return std::nullopt;
}

/// The shortest rotation that takes +y to the unit vector `to`, to.y ≥ 0: I + [v]× + [v]×²/(1 + to.y), v = y × to.
Mat3 rotation_from_y(const Vec3& to) {
  const double scale = 1.0 / (1.0 + to.y);
  const double shear = -to.x * to.z * scale;
  return {1.0 - to.x * to.x * scale, to.x, shear, -to.x, to.y, -to.z, shear, to.z, 1.0 - to.z * to.z * scale};
}

/// `shape`, which stands along +y, turned to stand along `axis`.
NodePtr stood_along(NodePtr shape, const Vec3& axis) {
  const Vec3 unit = normalized(axis);
  if (unit.y == 1.0) return shape;
  // the shortest rotation has no limit towards −y: there, and below, it is turned over first
  if (unit.y >= 0.0) return rotate(std::move(shape), rotation_from_y(unit));
  constexpr Mat3 kOver{1, 0, 0, 0, -1, 0, 0, 0, -1};
  return rotate(std::move(shape), rotation_from_y(unit * -1.0) * kOver);
}

/// A primitive that is symmetric about `axis`, and under its reversal; its last parameter becomes the axis number.
/// Along a direction that is no coordinate axis it is the y primitive, turned.
NodePtr axial(NodeKind kind, std::vector<double> parameters, const Vec3& axis) {
  require_direction(axis, "axis");
  const Vec3 unit = normalized(axis);
  const std::optional<double> number = coordinate_axis(unit);
  parameters.push_back(number.value_or(1.0));
  NodePtr shape = intern(kind, std::move(parameters), {});
  if (number) return shape;
  const double leading = unit.y != 0.0 ? unit.y : unit.x;
  return rotate(std::move(shape), rotation_from_y(leading < 0.0 ? unit * -1.0 : unit));
}

}  // namespace

NodePtr sphere(double radius) {
  require_length(radius, "radius");
  return intern(NodeKind::kSphere, {radius}, {});
}

NodePtr box(const Vec3& size, NodeKind kind) {
  require_lengths(size, "size");
  require(kind == NodeKind::kBox || kind == NodeKind::kBoxExterior || kind == NodeKind::kBoxMaximum, "kind", "a box",
          name(kind));
  return intern(kind, {0.5 * size.x, 0.5 * size.y, 0.5 * size.z}, {});
}

NodePtr plane(const Vec3& normal, const Vec3& point) {
  require_direction(normal, "normal");
  require_finite(point, "point");
  const Vec3 unit = normalized(normal);
  const double offset = -dot(unit, point);
  require(std::isfinite(offset), "point", "near enough for its distance from the origin to be finite", text(point));
  return intern(NodeKind::kPlane, {unit.x, unit.y, unit.z, offset}, {});
}

NodePtr cylinder(double radius, std::optional<double> height, const Vec3& axis) {
  require_length(radius, "radius");
  if (!height) return axial(NodeKind::kCylinder, {radius}, axis);
  require(is_length(*height), "height", "finite and >= 0, or absent for an endless cylinder", text(*height));
  return axial(NodeKind::kCappedCylinder, {radius, 0.5 * *height}, axis);
}

NodePtr torus(double radius, double tube_radius, const Vec3& axis) {
  require_length(radius, "radius");
  require_length(tube_radius, "tube_radius");
  return axial(NodeKind::kTorus, {radius, tube_radius}, axis);
}

NodePtr capsule(const Vec3& a, const Vec3& b, double radius) {
  require_finite(a, "a");
  require_finite(b, "b");
  require_length(radius, "radius");
  return intern(NodeKind::kCapsule, {a.x, a.y, a.z, b.x, b.y, b.z, radius}, {});
}

NodePtr capped_cone(double radius_bottom, double radius_top, double height, const Vec3& axis) {
  require_length(radius_bottom, "radius_bottom");
  require_length(radius_top, "radius_top");
  require_length(height, "height");
  require_direction(axis, "axis");
  return stood_along(intern(NodeKind::kCappedCone, {radius_bottom, radius_top, 0.5 * height}, {}), axis);
}

NodePtr octahedron(double radius) {
  require_length(radius, "radius");
  return intern(NodeKind::kOctahedron, {radius}, {});
}

NodePtr pyramid(double edge, double height) {
  require_length(edge, "edge");
  require_length(height, "height");
  return intern(NodeKind::kPyramid, {0.5 * edge, 0.5 * height}, {});
}

NodePtr rectangle(const std::array<double, 2>& size) {
  require(is_length(size[0]) && is_length(size[1]), "size", "finite and >= 0 on both axes",
          "(" + text(size[0]) + ", " + text(size[1]) + ")");
  return intern(NodeKind::kRectangle, {0.5 * size[0], 0.5 * size[1]}, {});
}

NodePtr polygon(std::vector<double> corners) {
  require(corners.size() >= 6 && corners.size() % 2 == 0, "corners", "three points or more", corners.size() / 2);
  for (const double coordinate : corners) require(std::isfinite(coordinate), "corners", "finite", text(coordinate));
  return intern(NodeKind::kPolygon, std::move(corners), {});
}

NodePtr grid(const std::array<std::size_t, 3>& size, std::vector<float> values, const Aabb& box,
             Interpolation interpolation) {
  require_grid(size, values);
  require_grid_box(box);
  const Vec3 edges = box.hi - box.lo;
  const auto spacing = [&](double edge, std::size_t axis) { return edge / static_cast<double>(size[axis] - 1); };
  const GridSamples samples{
      values, size, {spacing(edges.x, 0), spacing(edges.y, 1), spacing(edges.z, 2)}, interpolation};
  const double slope = steepest_slope(samples);
  require(std::isfinite(slope), "values", "such that their slope is finite", text(slope));
  // where the samples can be distances, the box's is one too; else it is as steep as the field
  constexpr double kNearly = 1.0 + 0x1p-10;
  const bool is_distance = slope == 0.0 || (slope >= 0.5 && steepest_edge(samples) <= kNearly);
  std::vector<double> parameters{static_cast<double>(size[0]),
                                 static_cast<double>(size[1]),
                                 static_cast<double>(size[2]),
                                 interpolation == Interpolation::kCubic ? 1.0 : 0.0,
                                 slope,
                                 is_distance ? 1.0 : slope};
  parameters.insert(parameters.end(), {box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z});
  return intern(NodeKind::kGrid, std::move(parameters), {}, std::move(values));
}

NodePtr field(NodePtr expression, std::optional<double> lipschitz, const std::optional<Aabb>& bounds) {
  require_field_expression(expression);
  if (lipschitz) require_length(*lipschitz, "lipschitz");
  const Aabb box = bounds.value_or(Aabb{});
  require_field_bounds(box);
  if (!lipschitz) {
    lipschitz = expression_bounds(*expression, box).slope;
    require(std::isfinite(*lipschitz), "lipschitz",
            "given, or found within bounds; the expression's slope has none here", "none");
  }
  return intern(NodeKind::kField, {*lipschitz, box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z},
                {std::move(expression)});
}

NodePtr solid(NodePtr expression) {
  require_field_expression(expression);
  return intern(NodeKind::kSolid, {}, {std::move(expression)});
}

}  // namespace octomarch
