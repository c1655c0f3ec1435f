// Builders of operators, over distances and over points. Operations that change nothing return the shape they were given.
#include <algorithm>
#include <numbers>
#include <utility>

#include "octomarch/graph/analysis.hpp"
#include "octomarch/graph/builder.hpp"
#include "octomarch/graph/checks.hpp"
#include "octomarch/graph/expression_bounds.hpp"

namespace octomarch {
namespace {

constexpr double kRadians = std::numbers::pi / 180.0;

struct SineCosine {
  double sine;
  double cosine;
};

/// Sine and cosine of an angle in degrees, exact at quarter turns.
SineCosine sine_cosine(double degrees) {
  const double turned = std::remainder(degrees, 360.0);
  const double quarters = std::nearbyint(turned / 90.0);
  const double radians = (turned - 90.0 * quarters) * kRadians;
  const double s = std::sin(radians);
  const double c = std::cos(radians);
  if (quarters == 0.0) return {s, c};
  if (quarters == 1.0) return {c, -s};
  if (quarters == -1.0) return {-c, s};
  return {-s, -c};
}

/// Rodrigues' rotation cos·I + (1 − cos)·aaᵀ + sin·[a]× about the unit vector `a`.
Mat3 rodrigues(const Vec3& a, const SineCosine& angle) {
  const double s = angle.sine;
  const double c = angle.cosine;
  const double d = 1.0 - c;
  const auto diagonal = [&](double axis) { return std::fabs(axis) == 1.0 ? 1.0 : c + d * axis * axis; };
  return {diagonal(a.x),           d * a.x * a.y - s * a.z, d * a.x * a.z + s * a.y,
          d * a.x * a.y + s * a.z, diagonal(a.y),           d * a.y * a.z - s * a.x,
          d * a.x * a.z - s * a.y, d * a.y * a.z + s * a.x, diagonal(a.z)};
}

void require_flat(const NodePtr& shape) {
  require_shape(shape);
  require(shape->is_flat(), "shape", "flat, the same at every z", name(shape->kind()));
}

/// How far the solid reaches from coordinate axis `axis`.
double radius_about(const Node& shape, int axis) {
  const LevelBox box = analyse(shape).at(&shape).level;
  const std::array<double, 3> reach{std::fmax(std::fabs(box.lo.x), std::fabs(box.hi.x)),
                                    std::fmax(std::fabs(box.lo.y), std::fabs(box.hi.y)),
                                    std::fmax(std::fabs(box.lo.z), std::fabs(box.hi.z))};
  const auto across = static_cast<std::size_t>(axis);
  return std::hypot(reach[(across + 1) % 3], reach[(across + 2) % 3]);
}

}  // namespace

NodePtr combine(NodeKind kind, std::vector<NodePtr> shapes, double smooth) {
  require(kind == NodeKind::kUnion || kind == NodeKind::kIntersection || kind == NodeKind::kDifference ||
              kind == NodeKind::kMetaballs,
          "kind", "union, intersection, difference or metaballs", name(kind));
  require(!shapes.empty(), "shapes", "at least one shape", "none");
  for (const NodePtr& shape : shapes) require_shape(shape, "shapes");
  require_length(smooth, kind == NodeKind::kMetaballs ? "k" : "smooth");
  if (kind == NodeKind::kMetaballs && smooth == 0.0) kind = NodeKind::kUnion;
  if (shapes.size() == 1) return std::move(shapes.front());
  return intern(kind, {smooth}, std::move(shapes));
}

NodePtr complement(NodePtr shape) {
  require_shape(shape);
  if (shape->kind() == NodeKind::kComplement) return shape->children().front();
  return intern(NodeKind::kComplement, {}, {std::move(shape)});
}

NodePtr round(NodePtr shape, double radius) {
  require_shape(shape);
  require_length(radius, "radius");
  if (radius == 0.0) return shape;
  return intern(NodeKind::kRound, {radius}, {std::move(shape)});
}

NodePtr shell(NodePtr shape, double thickness) {
  require_shape(shape);
  require_length(thickness, "thickness");
  return intern(NodeKind::kShell, {0.5 * thickness}, {std::move(shape)});
}

NodePtr displace(NodePtr shape, NodePtr expression, std::optional<double> lipschitz) {
  require_shape(shape);
  require_field_expression(expression);
  if (lipschitz) require_length(*lipschitz, "lipschitz");
  const ExpressionBounds bounds = expression_bounds(*expression, Aabb{});
  if (!lipschitz) lipschitz = bounds.slope;
  require(std::isfinite(*lipschitz), "lipschitz", "given: the expression's slope has no bound that could be found",
          "none");
  const double amplitude = std::fmax(std::fabs(bounds.lo), std::fabs(bounds.hi));
  return intern(NodeKind::kDisplace, {*lipschitz, amplitude}, {std::move(shape), std::move(expression)});
}

NodePtr extrude(NodePtr shape, double height) {
  require_flat(shape);
  require_length(height, "height");
  return intern(NodeKind::kExtrude, {0.5 * height}, {std::move(shape)});
}

NodePtr revolve(NodePtr shape, double offset) {
  require_flat(shape);
  require_length(offset, "offset");
  return intern(NodeKind::kRevolve, {offset}, {std::move(shape)});
}

NodePtr translate(NodePtr shape, const Vec3& offset) {
  require_shape(shape);
  require_finite(offset, "offset");
  if (offset == Vec3{}) return shape;
  if (shape->kind() == NodeKind::kTranslate) {
    const auto p = shape->parameters();
    const Vec3 sum = Vec3{p[0], p[1], p[2]} + offset;
    if (is_finite(sum)) return translate(shape->children().front(), sum);
  }
  return intern(NodeKind::kTranslate, {offset.x, offset.y, offset.z}, {std::move(shape)});
}

NodePtr rotate(NodePtr shape, const Mat3& parent_from_child) {
  require_shape(shape);
  if (parent_from_child == kIdentity3) return shape;
  return intern(NodeKind::kRotate, {parent_from_child.begin(), parent_from_child.end()}, {std::move(shape)});
}

NodePtr rotate(NodePtr shape, double degrees, const Vec3& axis) {
  require_shape(shape);
  require(std::isfinite(degrees), "degrees", "finite", text(degrees));
  require_direction(axis, "axis");
  if (std::remainder(degrees, 360.0) == 0.0) return shape;
  return rotate(std::move(shape), rodrigues(normalized(axis), sine_cosine(degrees)));
}

NodePtr scale(NodePtr shape, double factor) {
  require_shape(shape);
  require(std::isfinite(factor) && factor > 0.0, "factor", "finite and > 0", text(factor));
  if (factor == 1.0) return shape;
  return intern(NodeKind::kScale, {factor}, {std::move(shape)});
}

NodePtr stretch(NodePtr shape, const Vec3& factors) {
  require_shape(shape);
  require(is_finite(factors) && factors.x > 0.0 && factors.y > 0.0 && factors.z > 0.0, "factors",
          "finite and > 0 on every axis", text(factors));
  if (factors.x == factors.y && factors.y == factors.z) return scale(std::move(shape), factors.x);
  return intern(NodeKind::kStretch, {factors.x, factors.y, factors.z}, {std::move(shape)});
}

NodePtr mirror(NodePtr shape, int axis) {
  require_shape(shape);
  require_axis_number(axis);
  return intern(NodeKind::kMirror, {static_cast<double>(axis)}, {std::move(shape)});
}

NodePtr elongate(NodePtr shape, const Vec3& lengths) {
  require_shape(shape);
  require_lengths(lengths, "lengths");
  if (lengths == Vec3{}) return shape;
  return intern(NodeKind::kElongate, {0.5 * lengths.x, 0.5 * lengths.y, 0.5 * lengths.z}, {std::move(shape)});
}

NodePtr twist(NodePtr shape, double degrees, int axis) {
  require_shape(shape);
  require(std::isfinite(degrees), "degrees", "finite", text(degrees));
  require_axis_number(axis);
  if (degrees == 0.0) return shape;
  const double radius = radius_about(*shape, axis);
  require(std::isfinite(radius), "shape", "bounded across the axis that it is twisted about", name(shape->kind()));
  return intern(NodeKind::kTwist, {degrees * kRadians, radius, static_cast<double>(axis)}, {std::move(shape)});
}

NodePtr bend(NodePtr shape, double degrees) {
  require_shape(shape);
  require(std::isfinite(degrees), "degrees", "finite", text(degrees));
  if (degrees == 0.0) return shape;
  const double radius = radius_about(*shape, 2);
  require(std::isfinite(radius), "shape", "bounded in x and y", name(shape->kind()));
  return intern(NodeKind::kBend, {degrees * kRadians, radius}, {std::move(shape)});
}

NodePtr repeat(NodePtr shape, const Vec3& period, const std::array<int, 3>& counts) {
  require_shape(shape);
  require(is_length(period) && period != Vec3{}, "period", "finite and > 0 on the repeated axes, 0 on the others",
          text(period));
  const Vec3 asked{static_cast<double>(counts[0]), static_cast<double>(counts[1]), static_cast<double>(counts[2])};
  require(std::ranges::all_of(counts, [](int count) { return count >= 0; }), "counts",
          ">= 1 on every axis, or 0 for endless", text(asked));
  std::vector<double> parameters{period.x, period.y, period.z, asked.x, asked.y, asked.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // One copy stands where the shape stands: such an axis is not repeated. The count of any axis not repeated is 0.
    if (parameters[3 + axis] == 1.0) parameters[axis] = 0.0;
    if (parameters[axis] == 0.0) parameters[3 + axis] = 0.0;
  }
  if (std::all_of(parameters.begin(), parameters.begin() + 3, [](double p) { return p == 0.0; })) return shape;
  return intern(NodeKind::kRepeat, std::move(parameters), {std::move(shape)});
}

}  // namespace octomarch
