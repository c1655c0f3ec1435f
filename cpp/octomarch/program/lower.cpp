#include "octomarch/program/lower.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>
#include <utility>

#include "octomarch/base/error.hpp"
#include "octomarch/base/hash.hpp"
#include "octomarch/base/hash_table.hpp"
#include "octomarch/graph/builder.hpp"
#include "octomarch/program/lower_expression.hpp"
#include "octomarch/program/placement.hpp"

namespace octomarch {

namespace {

/// A blend takes k/4 at the most. Below this k that is nothing beside any distance, and 1/(4k) no number in float.
constexpr double kNarrowestBlend = std::numeric_limits<float>::min();

using Slots = std::array<ValueId, Material::kSlots>;

/// What a node has become: its distance; for attributes the id of the primitive that shows there; for surfaces what that
/// is made of.
struct Result {
  ValueId distance = 0;
  ValueId object = 0;
  Slots slots{};
};

struct Operators {
  Opcode hard;
  Opcode smooth;
  Opcode select;
  Opcode mix;
};

Operators operators_of(NodeKind kind) {
  switch (kind) {
    case NodeKind::kIntersection:
      return {Opcode::kIntersection, Opcode::kSmoothIntersection, Opcode::kSelectIntersection,
              Opcode::kMixIntersection};
    case NodeKind::kDifference:
      return {Opcode::kDifference, Opcode::kSmoothDifference, Opcode::kSelectDifference, Opcode::kMixDifference};
    case NodeKind::kMetaballs: return {Opcode::kUnion, Opcode::kMetaballs, Opcode::kSelectUnion, Opcode::kMixMetaballs};
    default:  // unions, and the copies that a repeat looks at
      return {Opcode::kUnion, Opcode::kSmoothUnion, Opcode::kSelectUnion, Opcode::kMixUnion};
  }
}

/// A shape that is made of no other.
bool is_leaf(const Node& node) { return node.children().empty() || !is_shape(node.child(0).kind()); }

/// A shape that is emitted as soon as it is looked up: emission finds what it has emitted before all the same.
bool is_one_instruction(const Node& node) { return node.children().empty() && node.kind() != NodeKind::kPolygon; }

/// Walks the graph with a stack of its own, since graphs may be deeper than the machine's.
class Lowering {
 public:
  Lowering(const FactTable& facts, LoweringOf what)
      : facts_(facts), what_(what), flow_(what == LoweringOf::kSurface ? kSurfaceInputs : kPointInputs) {}

  Lowered run(const Node& root, const Vec3& anchor) {
    Placement world;
    world.offset = Vec3{} - anchor;  // no −0
    if (what_ == LoweringOf::kSurface) world.normal = {3, 4, 5};
    placements_.push_back(world);
    enter(root, 0, true);
    while (!stack_.empty()) step();
    Lowered lowered;
    lowered.distance = last_.distance;
    lowered.object = last_.object;
    lowered.slots = last_.slots;
    lowered.flow = std::move(flow_);
    lowered.objects = std::move(objects_);
    lowered.materials = std::move(materials_);
    return lowered;
  }

 private:
  /// Index into placements_.
  using PlacementId = std::size_t;

  /// A node being lowered: children done so far are folded into `folded`.
  struct Visit {
    const Node* node;
    PlacementId placement;
    bool is_met_once;
    PlacementId branches;      ///< the first of its one shape's placements, which end placements_ while that is lowered
    std::size_t branch_count;  ///< 0: every child stands at `placement`
    std::size_t done = 0;
    Result folded{};

    std::size_t count() const { return branch_count == 0 ? node->children().size() : branch_count; }
  };

  /// Begins a node, or takes what it has become before at this placement. `is_met_once`: it cannot have been met.
  void enter(const Node& node, PlacementId placement, bool is_met_once) {
    if (is_one_instruction(node)) {
      last_ = lower_primitive(node, placements_[placement]);
      return;
    }
    if (!is_met_once) {
      if (const Remembered* const known = recall(node, placements_[placement])) {
        last_ = known->result;
        return;
      }
    }
    if (is_leaf(node)) {
      last_ = lower_primitive(node, placements_[placement]);
      if (!is_met_once) remember(node, placements_[placement]);
      return;
    }
    pending_ = true;
    const PlacementId branches = placements_.size();
    add_branches(node, placement);
    stack_.push_back({&node, placement, is_met_once, branches, placements_.size() - branches});
  }

  /// Placements at which the one shape among a node's children is wanted; none where there are several.
  void add_branches(const Node& node, PlacementId id) {
    const Placement placement = placements_[id];
    switch (node.kind()) {
      case NodeKind::kUnion:
      case NodeKind::kIntersection:
      case NodeKind::kDifference:
      case NodeKind::kMetaballs: break;
      case NodeKind::kTranslate:
      case NodeKind::kRotate:
      case NodeKind::kScale: placements_.push_back(child_placement(placement, node)); break;
      case NodeKind::kStretch:
      case NodeKind::kMirror:
      case NodeKind::kElongate:
      case NodeKind::kTwist:
      case NodeKind::kBend:
      case NodeKind::kRevolve:
      case NodeKind::kExtrude: placements_.push_back(bent_placement(placement, node, flow_)); break;
      case NodeKind::kPaint:
        placements_.push_back(placement);
        if (what_ != LoweringOf::kDistance) placements_.back().material = paint_index(node, placement);
        break;
      case NodeKind::kRepeat: {
        const unsigned symmetry = facts_.at(&node.child(0)).symmetry;
        const std::vector<Placement> cells = repeat_placements(placement, node, symmetry, flow_);
        placements_.insert(placements_.end(), cells.begin(), cells.end());
        break;
      }
      default: placements_.push_back(placement); break;
    }
  }

  /// Lowers the next child of the node on top of the stack, or ends that node.
  void step() {
    const Visit& visit = stack_.back();
    if (visit.done == visit.count()) return end();
    const bool several = visit.branch_count == 0;
    const NodePtr& child = visit.node->children()[several ? visit.done : 0];
    const bool is_met_once = visit.is_met_once && visit.branch_count <= 1 && has_one_owner(child);
    pending_ = false;
    enter(*child, several ? visit.placement : visit.branches + visit.done, is_met_once);
    if (!pending_) fold(stack_.back());
  }

  /// Ends the node on top of the stack, all of whose children are done.
  void end() {
    const Visit& visit = stack_.back();
    last_ = visit.folded;
    last_.distance = finish(*visit.node, placements_[visit.placement], last_.distance);
    if (!visit.is_met_once) remember(*visit.node, placements_[visit.placement]);
    placements_.resize(visit.branches);
    stack_.pop_back();
    if (!stack_.empty()) fold(stack_.back());
  }

  /// Takes the child's result into its parent, from the left.
  void fold(Visit& parent) {
    parent.folded =
        parent.done == 0 ? last_ : combine(*parent.node, placements_[parent.placement], parent.folded, last_);
    ++parent.done;
  }

  Result combine(const Node& node, const Placement& placement, const Result& a, const Result& b) {
    const Operators operators = operators_of(node.kind());
    const double k = node.kind() == NodeKind::kRepeat ? 0.0 : node.parameter(0) * placement.scale;
    Result result;
    const bool blends = k >= kNarrowestBlend;
    const bool is_metaballs = node.kind() == NodeKind::kMetaballs;
    if (blends) {
      result.distance =
          flow_.emit(operators.smooth, {{a.distance, b.distance}}, {{k, is_metaballs ? 1.0 / k : 0.25 / k}});
    } else {
      result.distance = flow_.emit(operators.hard, {{a.distance, b.distance}});
    }
    if (what_ == LoweringOf::kAttributes) {
      result.object = flow_.emit(operators.select, {{a.distance, b.distance, a.object, b.object}});
    }
    for (std::size_t i = 0; what_ == LoweringOf::kSurface && i < Material::kSlots; ++i) {
      const std::array<ValueId, 4> inputs{a.distance, b.distance, a.slots[i], b.slots[i]};
      if (!blends) result.slots[i] = flow_.emit(operators.select, inputs);
      else if (is_metaballs) result.slots[i] = flow_.emit(operators.mix, inputs, {{1.0 / k}});
      else result.slots[i] = flow_.emit(operators.mix, inputs, {{k, 0.5 / k}});
    }
    return result;
  }

  /// The distance of a node with one shape, whose distance at its own placement is `inner`.
  ValueId finish(const Node& node, const Placement& placement, ValueId inner) {
    const double s = placement.scale;
    switch (node.kind()) {
      case NodeKind::kComplement: return flow_.emit(Opcode::kComplement, {{inner}});
      case NodeKind::kRound: return flow_.emit(Opcode::kAddConstant, {{inner}}, {{-node.parameter(0) * s}});
      case NodeKind::kShell: return flow_.emit(Opcode::kShell, {{inner}}, {{node.parameter(0) * s}});
      case NodeKind::kDisplace: return flow_.emit(Opcode::kAdd, {{inner, scaled(number(node.child(1), placement), s)}});
      case NodeKind::kExtrude:
        return flow_.emit(Opcode::kExtrude, {{inner, own_axes(placement, flow_)[2]}}, {{node.parameter(0) * s}});
      case NodeKind::kTwist:
      case NodeKind::kBend: return flow_.emit(Opcode::kIntersection, {{emit_cut(node, placement, flow_), inner}});
      default: return inner;
    }
  }

  /// An expression at a placement, in the node's own units.
  ValueId number(const Node& expression, const Placement& placement) {
    return expressions_.lower(expression, own_coordinates(placement, flow_), flow_);
  }

  ValueId scaled(ValueId value, double scale) {
    return flow_.emit(Opcode::kMultiply, {{value, flow_.constant(scale)}});
  }

  /// The user's own field. Where it has bounds, points are held in them and the shape is cut there, by the larger, which
  /// keeps a NaN of the field. The box's distance counts as steeply as the field may, so that dividing by the Lipschitz
  /// bound leaves steps from outside as they are.
  ValueId lower_field(const Node& node, const Placement& placement) {
    const auto p = node.parameters();
    Coordinates coordinates = own_coordinates(placement, flow_);
    Coordinates inside = coordinates;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double lo = p[1 + axis];
      const double hi = p[4 + axis];
      if (std::isfinite(lo) || std::isfinite(hi)) {
        inside[axis] = flow_.emit(Opcode::kClamp, {{coordinates[axis]}}, {{lo, hi}});
      }
    }
    const ValueId value = expressions_.lower(node.child(0), inside, flow_);
    if (inside == coordinates) return scaled(value, placement.scale);
    const ValueId box = scaled(emit_bounds(p, coordinates), std::max(p[0], 1.0));
    return scaled(flow_.emit(Opcode::kIntersection, {{box, value}}), placement.scale);
  }

  /// Exact distance of the box of a kField node, of which only the bounded axes count.
  ValueId emit_bounds(std::span<const double> p, const Coordinates& coordinates) {
    std::array<double, 6> constants{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double lo = p[1 + axis];
      const double hi = p[4 + axis];
      const bool is_whole = std::isfinite(lo);  // as both ends are, or neither
      constants[axis] = is_whole ? 0.5 * (lo + hi) : 0.0;
      constants[3 + axis] = is_whole ? 0.5 * (hi - lo) : kInfinity;
    }
    return flow_.emit(Opcode::kBox, std::span(coordinates).first(3), constants);
  }

  ValueId lower_distance(const Node& node, const Placement& placement) {
    switch (node.kind()) {
      case NodeKind::kField: return lower_field(node, placement);
      case NodeKind::kSolid: return flow_.emit(Opcode::kSolid, {{number(node.child(0), placement)}});
      default: return emit_primitive(node, placement, flow_);
    }
  }

  Result lower_primitive(const Node& node, const Placement& placement) {
    Result result;
    result.distance = lower_distance(node, placement);
    if (what_ == LoweringOf::kDistance) return result;
    Paint& paint = paints_[static_cast<std::size_t>(placement.material >= 0 ? placement.material : unpainted())];
    if (what_ == LoweringOf::kSurface) {
      result.slots = paint.slots;
      return result;
    }
    if (paint.material < 0) paint.material = material_index(paint.content);
    const auto id = static_cast<double>(objects_.size());
    const std::uint64_t key = std::uint64_t{result.distance} << 32U | static_cast<std::uint32_t>(paint.material);
    const auto [entry, is_new] = object_ids_.try_emplace(key, id);
    if (is_new) objects_.push_back({node.kind(), paint.material});
    result.object = flow_.emit(Opcode::kConstant, {}, {{entry->second}});
    return result;
  }

  struct Paint {
    Material content;
    Slots slots;                 ///< surface only
    std::int32_t material = -1;  ///< attributes only, once a primitive shows it
  };

  /// Paints are numbered as the walk meets them, materials as primitives show them.
  std::int32_t paint_index(const Node& node, const Placement& placement) {
    Paint paint{material_of(node), {}};
    for (std::size_t i = 0; what_ == LoweringOf::kSurface && i < Material::kSlots; ++i) {
      paint.slots[i] = number(*paint.content.slots[i], placement);
    }
    return add_paint(paint);
  }

  std::int32_t add_paint(const Paint& paint) {
    const auto next = static_cast<std::int32_t>(paints_.size());
    const auto [entry, is_new] = paint_ids_.try_emplace({paint.content.slots, paint.slots}, next);
    if (is_new) paints_.push_back(paint);
    return entry->second;
  }

  std::int32_t unpainted() {
    if (unpainted_ >= 0) return unpainted_;
    Paint paint{default_material(), {}};
    for (std::size_t i = 0; i < Material::kSlots; ++i)
      paint.slots[i] = flow_.constant(paint.content.slots[i]->parameter(0));
    return unpainted_ = add_paint(paint);
  }

  std::int32_t material_index(const Material& material) {
    const auto next = static_cast<std::int32_t>(materials_.size());
    const auto [entry, is_new] = material_ids_.try_emplace(material.slots, next);
    if (is_new) materials_.push_back(material);
    return entry->second;
  }

  /// What a node has become at a placement.
  struct Remembered {
    const Node* node;
    Placement placement;
    Result result;
  };

  static std::uint64_t placed_hash(const Node& node, const Placement& placement) {
    std::uint64_t hash = hash_of(placement);
    mix(hash, reinterpret_cast<std::uintptr_t>(&node));
    return hash;
  }

  const Remembered* recall(const Node& node, const Placement& placement) const {
    const std::uint32_t found = places_remembered_.find(placed_hash(node, placement), [&](std::uint32_t place) {
      return remembered_[place - 1].node == &node && remembered_[place - 1].placement == placement;
    });
    return found == 0 ? nullptr : &remembered_[found - 1];
  }

  void remember(const Node& node, const Placement& placement) {
    remembered_.push_back({&node, placement, last_});
    places_remembered_.insert(placed_hash(node, placement), static_cast<std::uint32_t>(remembered_.size()));
  }

  const FactTable& facts_;
  LoweringOf what_;
  DataFlow flow_;
  ExpressionLowering expressions_;
  std::vector<Placement> placements_;  ///< of the nodes on the stack
  std::vector<Remembered> remembered_;
  HashTable<std::uint32_t> places_remembered_;  ///< indices into remembered_, plus 1
  std::vector<Visit> stack_;
  Result last_;           ///< of the node that ended last
  bool pending_ = false;  ///< enter() began a node that has yet to end
  std::vector<Object> objects_;
  std::vector<Material> materials_;
  std::unordered_map<std::uint64_t, double> object_ids_;  ///< of a distance (high word) and a material
  std::map<std::array<NodePtr, Material::kSlots>, std::int32_t> material_ids_;
  std::vector<Paint> paints_;
  std::map<std::pair<std::array<NodePtr, Material::kSlots>, Slots>, std::int32_t> paint_ids_;
  std::int32_t unpainted_ = -1;
};

}  // namespace

Lowered lower(const Node& root, const FactTable& facts, LoweringOf what, const Vec3& anchor) {
  return Lowering(facts, what).run(root, anchor);
}

}  // namespace octomarch
