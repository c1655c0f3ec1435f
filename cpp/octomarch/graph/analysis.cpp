// The walk over the graph, and what operators make of what is known of their operands.
#include "octomarch/graph/analysis.hpp"

#include <algorithm>
#include <cmath>
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

/// By how much the blend of `count` fields lies below the least of them at the most. The quadratic blend of two takes k/4,
/// and what has sunk by k blends no more; the exponential one is −k·log(Σ exp(−fᵢ/k)).
double lowering(const Node& node, std::size_t count) {
  const double k = node.parameter(0);
  if (node.kind() == NodeKind::kMetaballs) return k * std::log(static_cast<double>(count));
  return k * std::min(0.25 * static_cast<double>(count - 1), 1.0);
}

/// Takes another operand of a union, intersection or difference into the facts of those before it, which do not blend yet.
void fold(const Node& node, FieldFacts& facts, const FieldFacts& other) {
  switch (node.kind()) {
    case NodeKind::kUnion:
    case NodeKind::kMetaballs:
      facts.level = hull(facts.level, other.level);
      if (facts.focus && other.focus) facts.focus = hull(*facts.focus, *other.focus);
      else if (other.focus) facts.focus = other.focus;
      break;
    case NodeKind::kIntersection: facts.level = overlap(facts.level, other.level); break;
    default: break;  // a difference lies where its first operand does
  }
  facts.lipschitz = std::max(facts.lipschitz, other.lipschitz);
  facts.symmetry &= other.symmetry;
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

/// A node whose operands so far are folded into `facts`.
struct Visit {
  const Node* node;
  bool is_remembered;
  std::size_t next = 0;  ///< of the node's children
  std::size_t operands = 0;
  std::size_t bounded = 0;  ///< operands that have a focus
  FieldFacts facts{};

  /// The next child that is a shape, or null.
  const NodePtr* next_shape() {
    const std::span<const NodePtr> children = node->children();
    while (next < children.size() && !is_shape(children[next]->kind())) ++next;
    return next < children.size() ? &children[next++] : nullptr;
  }

  void take(const FieldFacts& operand) {
    if (operands == 0) facts = operand;
    else fold(*node, facts, operand);
    ++operands;
    if (operand.focus) ++bounded;
  }

  FieldFacts finished() const {
    if (operands == 0) return primitive_facts(*node);
    FieldFacts whole = facts;
    switch (node->kind()) {
      case NodeKind::kUnion:
      case NodeKind::kMetaballs:
        // the operands' sets at the level by which they are lowered hold the blended one
        whole.level = grown(facts.level, lowering(*node, operands));
        if (facts.focus) whole.focus = grown(*facts.focus, lowering(*node, bounded));
        return whole;
      case NodeKind::kIntersection:
        whole.focus = is_bounded(facts.level) ? std::optional(facts.level) : std::nullopt;
        return whole;
      case NodeKind::kDifference: return whole;
      default: return point_facts(*node, facts);
    }
  }
};

}  // namespace

FactTable analyse(const Node& root) {
  FactTable table;
  std::vector<Visit> stack{{&root, true}};
  while (!stack.empty()) {
    Visit& visit = stack.back();
    if (const NodePtr* const child = visit.next_shape()) {
      const bool is_remembered = !has_one_owner(*child) || visit.node->kind() == NodeKind::kRepeat;
      const auto known = is_remembered ? table.find(child->get()) : table.end();
      if (known != table.end()) visit.take(known->second);
      else stack.push_back({child->get(), is_remembered});
      continue;
    }
    const FieldFacts facts = visit.finished();
    if (visit.is_remembered) table.emplace(visit.node, facts);
    stack.pop_back();
    if (!stack.empty()) stack.back().take(facts);
  }
  return table;
}

bool is_signed_permutation(const Mat3& rotation) {
  return std::all_of(rotation.begin(), rotation.end(),
                     [](double entry) { return entry == 0.0 || std::fabs(entry) == 1.0; });
}

}  // namespace octomarch
