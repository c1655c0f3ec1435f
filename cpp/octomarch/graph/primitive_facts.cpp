#include "octomarch/graph/primitive_facts.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "octomarch/graph/grid.hpp"
#include "octomarch/graph/level_box.hpp"
#include "octomarch/graph/schema.hpp"

namespace octomarch {
namespace {

LevelBox about_origin(const Vec3& half) { return {half * -1.0, half}; }

/// Half extents of a solid of revolution: `radial` across its axis, `axial` along it.
Vec3 extents(double radial, double axial, double axis) {
  Axis3 half{radial, radial, radial};
  half[static_cast<std::size_t>(axis)] = axial;
  return vector_of(half);
}

/// A plane bounds an axis only when its normal lies along it.
LevelBox plane_box(const Node& node) {
  Axis3 lo{-kInfinity, -kInfinity, -kInfinity};
  Axis3 hi{kInfinity, kInfinity, kInfinity};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (node.parameter(axis) == 1.0) hi[axis] = -node.parameter(3);
    if (node.parameter(axis) == -1.0) lo[axis] = node.parameter(3);
  }
  return {vector_of(lo), vector_of(hi)};
}

LevelBox capsule_box(const Node& node) {
  const Vec3 a{node.parameter(0), node.parameter(1), node.parameter(2)};
  const Vec3 b{node.parameter(3), node.parameter(4), node.parameter(5)};
  const Vec3 radius{node.parameter(6), node.parameter(6), node.parameter(6)};
  return {smaller(a, b) - radius, larger(a, b) + radius};
}

/// Bounds of a polygon's corners; endless along z.
LevelBox polygon_box(const Node& node) {
  LevelBox box{{kInfinity, kInfinity, -kInfinity}, {-kInfinity, -kInfinity, kInfinity}};
  for (std::size_t i = 0; i < node.parameters().size(); i += 2) {
    const Vec3 corner{node.parameter(i), node.parameter(i + 1), 0.0};
    box.lo = {std::min(box.lo.x, corner.x), std::min(box.lo.y, corner.y), box.lo.z};
    box.hi = {std::max(box.hi.x, corner.x), std::max(box.hi.y, corner.y), box.hi.z};
  }
  return box;
}

unsigned plane_symmetry(const Node& node) {
  unsigned mirrors = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (node.parameter(axis) == 0.0) mirrors |= kMirrorX << axis;
  }
  return mirrors;
}

/// A capsule mirrors onto itself where its ends keep their coordinate 0, or change places.
unsigned capsule_symmetry(const Node& node) {
  unsigned mirrors = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool in_mirror = node.parameter(axis) == 0.0 && node.parameter(axis + 3) == 0.0;
    bool exchanged = node.parameter(axis) == -node.parameter(axis + 3);
    for (std::size_t other = 0; other < 3; ++other) {
      if (other != axis) exchanged = exchanged && node.parameter(other) == node.parameter(other + 3);
    }
    if (in_mirror || exchanged) mirrors |= kMirrorX << axis;
  }
  return mirrors;
}

/// A polygon mirrors onto itself where its corners, mirrored, follow each other the other way round.
bool is_mirrored(std::span<const double> corners, std::size_t axis) {
  const std::size_t count = corners.size() / 2;
  const auto is_image = [&](std::size_t i, std::size_t j) {
    return corners[2 * i + axis] == -corners[2 * j + axis] && corners[2 * i + 1 - axis] == corners[2 * j + 1 - axis];
  };
  std::size_t start = 0;
  while (start < count && !is_image(0, start)) ++start;
  if (start == count) return false;
  for (std::size_t i = 0; i < count; ++i) {
    if (!is_image(i, (start + count - i) % count)) return false;
  }
  return true;
}

unsigned polygon_symmetry(const Node& node) {
  unsigned mirrors = kMirrorX << 2U;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (is_mirrored(node.parameters(), axis)) mirrors |= kMirrorX << axis;
  }
  return mirrors;
}

FieldFacts primitive(const LevelBox& box, unsigned symmetry) {
  FieldFacts facts;
  facts.level = box;
  if (is_bounded(box)) facts.focus = box;
  facts.symmetry = symmetry;
  return facts;
}

/// A value c lies no farther outside of the box than c/steepness. What one looks at is the solid in it.
FieldFacts grid_facts(const Node& node) {
  const GridSamples samples = samples_of(node);
  const Aabb box = box_of(node);
  const double growth = 1.0 / node.parameter(5);
  unsigned mirrors = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool is_centred = node.parameter(6 + axis) == -node.parameter(9 + axis);
    if (is_centred && is_mirrored(samples, axis)) mirrors |= kMirrorX << axis;
  }
  FieldFacts facts = primitive({box.lo, box.hi, {growth, growth, growth}}, mirrors);
  const Aabb solid = solid_box(samples, box);
  facts.focus = LevelBox{solid.lo, solid.hi, {growth, growth, growth}};
  facts.lipschitz = std::max(node.parameter(4), node.parameter(5));
  return facts;
}

FieldFacts field_facts(const Node& node) {
  const auto p = node.parameters();
  FieldFacts facts = primitive({{p[1], p[2], p[3]}, {p[4], p[5], p[6]}}, 0);
  const bool is_cut = std::any_of(p.begin() + 1, p.end(), [](double bound) { return std::isfinite(bound); });
  facts.lipschitz = is_cut ? std::max(p[0], 1.0) : p[0];
  return facts;
}

}  // namespace

FieldFacts primitive_facts(const Node& node) {
  const auto p = node.parameters();
  switch (node.kind()) {
    case NodeKind::kSphere: return primitive(about_origin({p[0], p[0], p[0]}), kMirrorAll | kIsotropic);
    case NodeKind::kBox:
    case NodeKind::kBoxExterior:
    case NodeKind::kBoxMaximum: return primitive(about_origin({p[0], p[1], p[2]}), kMirrorAll);
    case NodeKind::kPlane: return primitive(plane_box(node), plane_symmetry(node));
    case NodeKind::kCylinder: return primitive(about_origin(extents(p[0], kInfinity, p[1])), kMirrorAll);
    case NodeKind::kCappedCylinder: return primitive(about_origin(extents(p[0], p[1], p[2])), kMirrorAll);
    case NodeKind::kTorus: return primitive(about_origin(extents(p[0] + p[1], p[1], p[2])), kMirrorAll);
    case NodeKind::kCapsule: return primitive(capsule_box(node), capsule_symmetry(node));
    case NodeKind::kCappedCone:
      return primitive(about_origin(extents(std::max(p[0], p[1]), p[2], 1.0)),
                       p[0] == p[1] ? kMirrorAll : kMirrorX | kMirrorX << 2U);
    case NodeKind::kOctahedron: return primitive(about_origin({p[0], p[0], p[0]}), kMirrorAll);
    case NodeKind::kPyramid: return primitive(about_origin({p[0], p[1], p[0]}), kMirrorX | kMirrorX << 2U);
    case NodeKind::kRectangle: return primitive(about_origin({p[0], p[1], kInfinity}), kMirrorAll);
    case NodeKind::kPolygon: return primitive(polygon_box(node), polygon_symmetry(node));
    case NodeKind::kGrid: return grid_facts(node);
    case NodeKind::kField: return field_facts(node);
    case NodeKind::kSolid: return {};
    default: throw std::logic_error("primitive_facts.cpp: nothing known of " + std::string(name(node.kind())));
  }
}

}  // namespace octomarch
