// One case for each kind of node: what is known of its field from what is known of its operands.
#include "octomarch/graph/analysis.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include "octomarch/graph/schema.hpp"

namespace octomarch {

namespace {

using Axis3 = std::array<double, 3>;

Axis3 array_of(const Vec3& v) { return {v.x, v.y, v.z}; }
Vec3 vector_of(const Axis3& a) { return {a[0], a[1], a[2]}; }

template <class Function>
Vec3 per_axis(const Vec3& a, const Vec3& b, Function&& f) {
  return {f(a.x, b.x), f(a.y, b.y), f(a.z, b.z)};
}

Vec3 smaller(const Vec3& a, const Vec3& b) {
  return per_axis(a, b, [](double u, double v) { return std::min(u, v); });
}
Vec3 larger(const Vec3& a, const Vec3& b) {
  return per_axis(a, b, [](double u, double v) { return std::max(u, v); });
}

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

bool is_bounded(const LevelBox& box) { return is_finite(box.lo) && is_finite(box.hi); }

LevelBox hull(const LevelBox& a, const LevelBox& b) {
  return {smaller(a.lo, b.lo), larger(a.hi, b.hi), larger(a.growth, b.growth)};
}

LevelBox overlap(const LevelBox& a, const LevelBox& b) {
  return {larger(a.lo, b.lo), smaller(a.hi, b.hi), larger(a.growth, b.growth)};
}

LevelBox grown(const LevelBox& box, double level) {
  return {box.lo - box.growth * level, box.hi + box.growth * level, box.growth};
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

LevelBox moved(const LevelBox& box, const Vec3& offset) { return {box.lo + offset, box.hi + offset, box.growth}; }

LevelBox scaled(const LevelBox& box, double factor) { return {box.lo * factor, box.hi * factor, box.growth}; }

/// Bounds of the rotated box. An axis that is empty at level 0 counts as a point there.
LevelBox rotated(const LevelBox& box, std::span<const double> rotation) {
  const Axis3 lo = array_of(box.lo);
  const Axis3 hi = array_of(box.hi);
  const Axis3 growth = array_of(box.growth);
  Axis3 new_lo{};
  Axis3 new_hi{};
  Axis3 new_growth{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      const double weight = rotation[row * 3 + column];
      if (weight == 0.0) continue;  // 0·∞ is no bound
      const double low = std::min(lo[column], hi[column]) * weight;
      const double high = std::max(lo[column], hi[column]) * weight;
      new_lo[row] += std::min(low, high);
      new_hi[row] += std::max(low, high);
      new_growth[row] += std::fabs(weight) * growth[column];
    }
  }
  return {vector_of(new_lo), vector_of(new_hi), vector_of(new_growth)};
}

/// factors · (child's box); a level c is one of c/min(factors) in the child.
LevelBox stretched(const LevelBox& box, const Vec3& factors) {
  const double least = std::min({factors.x, factors.y, factors.z});
  const auto times = [](double a, double b) { return a * b; };
  return {per_axis(box.lo, factors, times), per_axis(box.hi, factors, times),
          per_axis(box.growth, factors * (1.0 / least), times)};
}

/// What lies where the coordinate is ≥ 0, and its mirror image.
LevelBox mirrored(const LevelBox& box, double axis) {
  Axis3 lo = array_of(box.lo);
  const Axis3 hi = array_of(box.hi);
  const auto i = static_cast<std::size_t>(axis);
  lo[i] = -hi[i];
  return {vector_of(lo), box.hi, box.growth};
}

/// Within `radius` of an axis and, along it, where the child is.
LevelBox within_cylinder(const LevelBox& box, double radius, std::size_t axis) {
  Axis3 lo{-radius, -radius, -radius};
  Axis3 hi{radius, radius, radius};
  Axis3 growth{1.0, 1.0, 1.0};
  lo[axis] = array_of(box.lo)[axis];
  hi[axis] = array_of(box.hi)[axis];
  growth[axis] = array_of(box.growth)[axis];
  return {vector_of(lo), vector_of(hi), vector_of(growth)};
}

LevelBox between(const LevelBox& box, double half_height) {
  return {{box.lo.x, box.lo.y, -half_height}, {box.hi.x, box.hi.y, half_height}, {box.growth.x, box.growth.y, 1.0}};
}

LevelBox revolved(const LevelBox& box, double offset) {
  const double radius = box.hi.x + offset;
  return {{-radius, box.lo.y, -radius}, {radius, box.hi.y, radius}, {box.growth.x, box.growth.y, box.growth.x}};
}

LevelBox repeated(const LevelBox& box, const Node& node) {
  Axis3 lo = array_of(box.lo);
  Axis3 hi = array_of(box.hi);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const RepeatAxis repeat = repeat_axis(node, axis);
    if (repeat.period == 0.0) continue;
    lo[axis] -= repeat.limit * repeat.period;
    hi[axis] += repeat.limit * repeat.period;
  }
  return {vector_of(lo), vector_of(hi), box.growth};
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

/// Mirror bits carried through a rotation: an axis keeps its bit where the rotation takes it to an axis.
unsigned rotated_symmetry(unsigned symmetry, std::span<const double> rotation) {
  if ((symmetry & kIsotropic) != 0) return symmetry;
  unsigned mirrors = 0;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      const bool onto = std::fabs(rotation[row * 3 + column]) == 1.0;
      if (onto && (symmetry & (kMirrorX << column)) != 0) mirrors |= kMirrorX << row;
    }
  }
  return mirrors;
}

unsigned translated_symmetry(unsigned symmetry, const Node& node) {
  unsigned mirrors = symmetry & kMirrorAll;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (node.parameter(axis) != 0.0) mirrors &= ~(kMirrorX << axis);
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

/// `lowering`: by how much a blend lowers the smaller operand at the most.
FieldFacts union_facts(double lowering, const std::vector<const FieldFacts*>& operands) {
  FieldFacts facts = *operands[0];
  for (std::size_t i = 1; i < operands.size(); ++i) {
    const FieldFacts& other = *operands[i];
    // both sets at the level by which a blend lowers hold the blended one
    facts.level = grown(hull(facts.level, other.level), lowering);
    if (facts.focus && other.focus) {
      facts.focus = grown(hull(*facts.focus, *other.focus), lowering);
    } else if (other.focus) {
      facts.focus = other.focus;
    }
    facts.lipschitz = std::max(facts.lipschitz, other.lipschitz);
    facts.symmetry &= other.symmetry;
  }
  return facts;
}

FieldFacts intersection_facts(const std::vector<const FieldFacts*>& operands) {
  FieldFacts facts = *operands[0];
  for (std::size_t i = 1; i < operands.size(); ++i) {
    facts.level = overlap(facts.level, operands[i]->level);
    facts.lipschitz = std::max(facts.lipschitz, operands[i]->lipschitz);
    facts.symmetry &= operands[i]->symmetry;
  }
  facts.focus = is_bounded(facts.level) ? std::optional(facts.level) : std::nullopt;
  return facts;
}

FieldFacts difference_facts(const std::vector<const FieldFacts*>& operands) {
  FieldFacts facts = *operands[0];
  for (std::size_t i = 1; i < operands.size(); ++i) {
    facts.lipschitz = std::max(facts.lipschitz, operands[i]->lipschitz);
    facts.symmetry &= operands[i]->symmetry;
  }
  return facts;
}

/// Facts of a node with one child: its boxes carried along, its symmetry given.
template <class Move>
FieldFacts carried(const FieldFacts& child, unsigned symmetry, Move&& move) {
  FieldFacts facts = child;
  facts.level = move(child.level);
  if (child.focus) facts.focus = move(*child.focus);
  if (facts.focus && !is_bounded(*facts.focus)) facts.focus.reset();
  facts.symmetry = symmetry;
  return facts;
}

FieldFacts field_facts(const Node& node) {
  const auto p = node.parameters();
  FieldFacts facts = primitive({{p[1], p[2], p[3]}, {p[4], p[5], p[6]}}, 0);
  const bool is_cut = std::any_of(p.begin() + 1, p.end(), [](double bound) { return std::isfinite(bound); });
  facts.lipschitz = is_cut ? std::max(p[0], 1.0) : p[0];
  return facts;
}

/// Lipschitz bound of a map that shears by `shear` = rate · radius across what it is turned about.
double shear_bound(double shear) { return (shear + std::sqrt(shear * shear + 4.0)) / 2.0; }

FieldFacts turned_facts(const Node& node, const FieldFacts& child) {
  const bool is_twist = node.kind() == NodeKind::kTwist;
  const double shear = std::fabs(node.parameter(0)) * node.parameter(1);
  const std::size_t axis = is_twist ? static_cast<std::size_t>(node.parameter(2)) : 2;
  FieldFacts facts =
      carried(child, 0, [&](const LevelBox& box) { return within_cylinder(box, node.parameter(1), axis); });
  // a bend's rate grows along a line across its axis: there it stretches by 1 + shear, where a twist only shears
  facts.lipschitz = std::max(1.0, child.lipschitz * (is_twist ? shear_bound(shear) : 1.0 + shear));
  return facts;
}

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
    case NodeKind::kField: return field_facts(node);
    case NodeKind::kSolid: return {};
    default: throw std::logic_error("analysis.cpp: nothing known of " + std::string(name(node.kind())));
  }
}

/// Of operators over one distance.
FieldFacts distance_facts(const Node& node, const FieldFacts& child) {
  const auto p = node.parameters();
  switch (node.kind()) {
    case NodeKind::kComplement: {
      FieldFacts facts;
      facts.lipschitz = child.lipschitz;
      facts.symmetry = child.symmetry;
      return facts;
    }
    case NodeKind::kRound:
    case NodeKind::kShell: return carried(child, child.symmetry, [&](const LevelBox& box) { return grown(box, p[0]); });
    case NodeKind::kDisplace: {
      FieldFacts facts = carried(child, 0, [&](const LevelBox& box) { return grown(box, p[1]); });
      facts.lipschitz += p[0];
      return facts;
    }
    case NodeKind::kExtrude: {
      FieldFacts facts = carried(child, (child.symmetry & kMirrorAll) | kMirrorX << 2U,
                                 [&](const LevelBox& box) { return between(box, p[0]); });
      facts.focus = is_bounded(facts.level) ? std::optional(facts.level) : std::nullopt;
      facts.lipschitz = std::max(facts.lipschitz, 1.0);
      return facts;
    }
    default: return child;  // a paint
  }
}

/// Of operators over points.
FieldFacts point_facts(const Node& node, const FieldFacts& child) {
  const auto p = node.parameters();
  switch (node.kind()) {
    case NodeKind::kRevolve: {
      FieldFacts facts = carried(child, (child.symmetry & kMirrorAll) | kMirrorX | kMirrorX << 2U,
                                 [&](const LevelBox& box) { return revolved(box, p[0]); });
      facts.focus = is_bounded(facts.level) ? std::optional(facts.level) : std::nullopt;
      return facts;
    }
    case NodeKind::kStretch:
      return carried(child, child.symmetry & kMirrorAll,
                     [&](const LevelBox& box) { return stretched(box, {p[0], p[1], p[2]}); });
    case NodeKind::kMirror:
      return carried(child, child.symmetry | kMirrorX << static_cast<unsigned>(p[0]),
                     [&](const LevelBox& box) { return mirrored(box, p[0]); });
    case NodeKind::kElongate:
      return carried(child, child.symmetry & kMirrorAll, [&](const LevelBox& box) {
        return LevelBox{box.lo - Vec3{p[0], p[1], p[2]}, box.hi + Vec3{p[0], p[1], p[2]}, box.growth};
      });
    case NodeKind::kTwist:
    case NodeKind::kBend: return turned_facts(node, child);
    case NodeKind::kTranslate:
      return carried(child, translated_symmetry(child.symmetry, node),
                     [&](const LevelBox& box) { return moved(box, {p[0], p[1], p[2]}); });
    case NodeKind::kRotate:
      return carried(child, rotated_symmetry(child.symmetry, p), [&](const LevelBox& box) { return rotated(box, p); });
    case NodeKind::kScale:
      return carried(child, child.symmetry, [&](const LevelBox& box) { return scaled(box, p[0]); });
    case NodeKind::kRepeat:
      return carried(child, child.symmetry & kMirrorAll, [&](const LevelBox& box) { return repeated(box, node); });
    default: return distance_facts(node, child);
  }
}

FieldFacts facts_of(const Node& node, const std::vector<const FieldFacts*>& children) {
  if (children.empty()) return primitive_facts(node);
  switch (node.kind()) {
    case NodeKind::kUnion: return union_facts(node.parameter(0) / 4.0, children);
    case NodeKind::kMetaballs: return union_facts(node.parameter(0) * std::numbers::ln2, children);
    case NodeKind::kIntersection: return intersection_facts(children);
    case NodeKind::kDifference: return difference_facts(children);
    default: return point_facts(node, *children[0]);
  }
}

}  // namespace

FactTable analyse(const Node& root) {
  FactTable facts;
  std::vector<std::pair<const Node*, bool>> stack{{&root, false}};
  std::vector<const FieldFacts*> children;
  while (!stack.empty()) {
    const auto [node, children_done] = stack.back();
    stack.pop_back();
    if (facts.contains(node)) continue;
    if (!children_done) {
      stack.emplace_back(node, true);
      for (const NodePtr& child : node->children()) {
        if (is_shape(child->kind())) stack.emplace_back(child.get(), false);
      }
      continue;
    }
    children.clear();
    for (const NodePtr& child : node->children()) {
      if (is_shape(child->kind())) children.push_back(&facts.at(child.get()));
    }
    facts.emplace(node, facts_of(*node, children));
  }
  return facts;
}

bool is_signed_permutation(const Mat3& rotation) {
  return std::all_of(rotation.begin(), rotation.end(),
                     [](double entry) { return entry == 0.0 || std::fabs(entry) == 1.0; });
}

}  // namespace octomarch
