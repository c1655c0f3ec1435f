// The walk over the graph, and what operators make of what is known of their operands.
#include "octomarch/graph/analysis.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "octomarch/graph/level_box.hpp"
#include "octomarch/graph/primitive_facts.hpp"

namespace octomarch {

namespace {

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
