// Validation and canonical form: arguments as users give them become node parameters. The bindings come before it,
// intern() after. Operations that change nothing return the shape they were given.
#include "octomarch/graph/builder.hpp"

#include <algorithm>
#include <charconv>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "octomarch/base/error.hpp"

namespace octomarch {
namespace {

/// Shortest text that reads back as `value`; NaN without a sign.
std::string text(double value) {
  if (std::isnan(value)) return "nan";
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

std::string text(const Vec3& v) { return "(" + text(v.x) + ", " + text(v.y) + ", " + text(v.z) + ")"; }

bool is_length(double value) { return std::isfinite(value) && value >= 0.0; }
bool is_fraction(double value) { return value >= 0.0 && value <= 1.0; }

void require_length(double value, std::string_view argument) {
  require(is_length(value), argument, "finite and >= 0", text(value));
}

void require_finite(const Vec3& value, std::string_view argument) {
  require(is_finite(value), argument, "finite", text(value));
}

void require_direction(const Vec3& value, std::string_view argument) {
  require(is_finite(value) && value != Vec3{}, argument, "finite and not zero", text(value));
}

void require_shape(const NodePtr& shape) { require(shape != nullptr, "shape", "a shape", "none"); }

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

NodePtr rotated(NodePtr shape, const Mat3& parent_from_child) {
  return intern(NodeKind::kRotate, {parent_from_child.begin(), parent_from_child.end()}, {std::move(shape)});
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
  return rotated(std::move(shape), rotation_from_y(leading < 0.0 ? unit * -1.0 : unit));
}

struct SineCosine {
  double sine;
  double cosine;
};

/// Sine and cosine of an angle in degrees, exact at quarter turns.
SineCosine sine_cosine(double degrees) {
  const double turned = std::remainder(degrees, 360.0);
  const double quarters = std::nearbyint(turned / 90.0);
  const double radians = (turned - 90.0 * quarters) * (std::numbers::pi / 180.0);
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
  return {c + d * a.x * a.x,       d * a.x * a.y - s * a.z, d * a.x * a.z + s * a.y,
          d * a.x * a.y + s * a.z, c + d * a.y * a.y,       d * a.y * a.z - s * a.x,
          d * a.x * a.z - s * a.y, d * a.y * a.z + s * a.x, c + d * a.z * a.z};
}

void require_material(const Material& material) {
  const Vec3& color = material.color;
  require(is_length(color.x) && is_length(color.y) && is_length(color.z), "color", "finite and >= 0 in every channel",
          text(color));
  require(is_fraction(material.roughness), "roughness", "between 0 and 1", text(material.roughness));
  require(is_fraction(material.specular), "specular", "between 0 and 1", text(material.specular));
  require(is_fraction(material.metallic), "metallic", "between 0 and 1", text(material.metallic));
}

}  // namespace

NodePtr sphere(double radius) {
  require_length(radius, "radius");
  return intern(NodeKind::kSphere, {radius}, {});
}

NodePtr box(const Vec3& size) {
  require(is_length(size.x) && is_length(size.y) && is_length(size.z), "size", "finite and >= 0 on every axis",
          text(size));
  return intern(NodeKind::kBox, {0.5 * size.x, 0.5 * size.y, 0.5 * size.z}, {});
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

NodePtr combine(NodeKind kind, std::vector<NodePtr> shapes, double smooth) {
  require(kind == NodeKind::kUnion || kind == NodeKind::kIntersection || kind == NodeKind::kDifference, "kind",
          "union, intersection or difference", name(kind));
  require(!shapes.empty(), "shapes", "at least one shape", "none");
  require(std::ranges::find(shapes, nullptr) == shapes.end(), "shapes", "all shapes", "none among them");
  require_length(smooth, "smooth");
  if (shapes.size() == 1) return std::move(shapes.front());
  return intern(kind, {smooth}, std::move(shapes));
}

NodePtr complement(NodePtr shape) {
  require_shape(shape);
  if (shape->kind() == NodeKind::kComplement) return shape->children().front();
  return intern(NodeKind::kComplement, {}, {std::move(shape)});
}

NodePtr translate(NodePtr shape, const Vec3& offset) {
  require_shape(shape);
  require_finite(offset, "offset");
  if (offset == Vec3{}) return shape;
  return intern(NodeKind::kTranslate, {offset.x, offset.y, offset.z}, {std::move(shape)});
}

NodePtr rotate(NodePtr shape, double degrees, const Vec3& axis) {
  require_shape(shape);
  require(std::isfinite(degrees), "degrees", "finite", text(degrees));
  require_direction(axis, "axis");
  if (std::remainder(degrees, 360.0) == 0.0) return shape;
  return rotated(std::move(shape), rodrigues(normalized(axis), sine_cosine(degrees)));
}

NodePtr scale(NodePtr shape, double factor) {
  require_shape(shape);
  require(std::isfinite(factor) && factor > 0.0, "factor", "finite and > 0", text(factor));
  if (factor == 1.0) return shape;
  return intern(NodeKind::kScale, {factor}, {std::move(shape)});
}

NodePtr repeat(NodePtr shape, const Vec3& period, const std::array<int, 3>& counts) {
  require_shape(shape);
  require(is_length(period.x) && is_length(period.y) && is_length(period.z) && period != Vec3{}, "period",
          "finite and > 0 on the repeated axes, 0 on the others", text(period));
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

NodePtr paint(NodePtr shape, const Material& material) {
  require_shape(shape);
  require_material(material);
  const Vec3& color = material.color;
  return intern(NodeKind::kPaint, {color.x, color.y, color.z, material.roughness, material.specular, material.metallic},
                {std::move(shape)});
}

Material material_of(const Node& paint) {
  return {{paint.parameter(0), paint.parameter(1), paint.parameter(2)},
          paint.parameter(3),
          paint.parameter(4),
          paint.parameter(5)};
}

}  // namespace octomarch
