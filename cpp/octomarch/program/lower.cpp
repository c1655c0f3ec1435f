#include "octomarch/program/lower.hpp"

#include <limits>
#include <map>
#include <unordered_map>
#include <utility>

#include "octomarch/base/hash.hpp"
#include "octomarch/graph/builder.hpp"
#include "octomarch/program/placement.hpp"

namespace octomarch {

namespace {

/// A blend takes k/4 at the most. Below this k that is nothing beside any distance, and 1/(4k) no number in float.
constexpr double kNarrowestBlend = std::numeric_limits<float>::min();

/// What a node has become: its distance, and for attributes the id of the primitive that shows there.
struct Result {
  ValueId distance = 0;
  ValueId object = 0;
};

struct Operators {
  Opcode hard;
  Opcode smooth;
  Opcode select;
};

Operators operators_of(NodeKind kind) {
  switch (kind) {
    case NodeKind::kIntersection:
      return {Opcode::kIntersection, Opcode::kSmoothIntersection, Opcode::kSelectIntersection};
    case NodeKind::kDifference: return {Opcode::kDifference, Opcode::kSmoothDifference, Opcode::kSelectDifference};
    default:  // unions, and the copies that a repeat looks at
      return {Opcode::kUnion, Opcode::kSmoothUnion, Opcode::kSelectUnion};
  }
}

/// Walks the graph with a stack of its own, since graphs may be deeper than the machine's.
class Lowering {
 public:
  Lowering(const FactTable& facts, bool attributes) : facts_(facts), attributes_(attributes) {}

  Lowered run(const Node& root) {
    enter(root, intern(Placement{}));
    while (!stack_.empty()) step();
    Lowered lowered;
    lowered.distance = last_.distance;
    lowered.object = last_.object;
    lowered.flow = std::move(flow_);
    lowered.objects = std::move(objects_);
    lowered.materials = std::move(materials_);
    return lowered;
  }

 private:
  using PlacementId = std::uint32_t;

  /// A node being lowered: children done so far are folded into `folded`.
  struct Visit {
    const Node* node;
    PlacementId placement;
    std::vector<PlacementId> branches;  ///< placements of the one child; empty: every child at `placement`
    std::size_t done = 0;
    Result folded;

    std::size_t count() const { return branches.empty() ? node->children().size() : branches.size(); }
  };

  PlacementId intern(const Placement& placement) {
    const auto [entry, is_new] = placement_ids_.try_emplace(placement, static_cast<PlacementId>(placements_.size()));
    if (is_new) placements_.push_back(placement);
    return entry->second;
  }

  /// Begins a node, or takes what it has become before at this placement.
  void enter(const Node& node, PlacementId placement) {
    if (const auto known = results_.find({&node, placement}); known != results_.end()) {
      last_ = known->second;
      return;
    }
    if (node.children().empty()) {
      last_ = lower_primitive(node, placements_[placement]);
      results_.emplace(std::pair(&node, placement), last_);
      return;
    }
    pending_ = true;
    stack_.push_back({&node, placement, branches_of(node, placements_[placement]), 0, {}});
  }

  std::vector<PlacementId> branches_of(const Node& node, const Placement& placement) {
    switch (node.kind()) {
      case NodeKind::kTranslate:
      case NodeKind::kRotate:
      case NodeKind::kScale: return {intern(child_placement(placement, node))};
      case NodeKind::kPaint: {
        if (!attributes_) return {};
        Placement painted = placement;
        painted.material = paint_index(material_of(node));
        return {intern(painted)};
      }
      case NodeKind::kRepeat: {
        std::vector<PlacementId> branches;
        const unsigned symmetry = facts_.at(&node.child(0)).symmetry;
        for (const Placement& cell : repeat_placements(Placement(placement), node, symmetry, flow_)) {
          branches.push_back(intern(cell));
        }
        return branches;
      }
      default: return {};
    }
  }

  /// Lowers the next child of the node on top of the stack, or ends that node.
  void step() {
    Visit& visit = stack_.back();
    if (visit.done == visit.count()) {
      last_ = visit.node->kind() == NodeKind::kComplement ? complement(visit.folded) : visit.folded;
      results_.emplace(std::pair(visit.node, visit.placement), last_);
      stack_.pop_back();
      if (!stack_.empty()) fold(stack_.back());
      return;
    }
    const bool several = visit.branches.empty();
    const Node& child = several ? visit.node->child(visit.done) : visit.node->child(0);
    pending_ = false;
    enter(child, several ? visit.placement : visit.branches[visit.done]);
    if (!pending_) fold(stack_.back());
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
    if (k >= kNarrowestBlend) {
      result.distance = flow_.emit(operators.smooth, {{a.distance, b.distance}}, {{k, 0.25 / k}});
    } else {
      result.distance = flow_.emit(operators.hard, {{a.distance, b.distance}});
    }
    if (attributes_) result.object = flow_.emit(operators.select, {{a.distance, b.distance, a.object, b.object}});
    return result;
  }

  Result complement(const Result& inner) { return {flow_.emit(Opcode::kComplement, {{inner.distance}}), inner.object}; }

  Result lower_primitive(const Node& node, const Placement& placement) {
    Result result;
    result.distance = emit_primitive(node, placement, flow_);
    if (!attributes_) return result;
    const std::int32_t material =
        material_index(placement.material >= 0 ? placement.material : paint_index(Material{}));
    const auto id = static_cast<double>(objects_.size());
    const auto [entry, is_new] = object_ids_.try_emplace({result.distance, material}, id);
    if (is_new) objects_.push_back({node.kind(), material});
    result.object = flow_.emit(Opcode::kConstant, {}, {{entry->second}});
    return result;
  }

  /// Paints are numbered as the walk meets them; materials (below) as primitives show them.
  std::int32_t paint_index(const Material& material) {
    const std::array<double, 6> key{material.color.x,   material.color.y,  material.color.z,
                                    material.roughness, material.specular, material.metallic};
    const auto [entry, is_new] = paint_ids_.try_emplace(key, static_cast<std::int32_t>(paints_.size()));
    if (is_new) paints_.push_back({material, -1});
    return entry->second;
  }

  std::int32_t material_index(std::int32_t paint) {
    Paint& entry = paints_[static_cast<std::size_t>(paint)];
    if (entry.material < 0) {
      entry.material = static_cast<std::int32_t>(materials_.size());
      materials_.push_back(entry.content);
    }
    return entry.material;
  }

  struct Paint {
    Material content;
    std::int32_t material;  ///< its number among the materials; −1 until a primitive shows it
  };

  struct VisitHash {
    std::size_t operator()(const std::pair<const Node*, PlacementId>& key) const noexcept {
      std::uint64_t hash = std::hash<const Node*>()(key.first);
      mix(hash, key.second);
      return hash;
    }
  };

  const FactTable& facts_;
  bool attributes_;
  DataFlow flow_;
  std::vector<Placement> placements_;
  std::unordered_map<Placement, PlacementId, PlacementHash> placement_ids_;
  std::unordered_map<std::pair<const Node*, PlacementId>, Result, VisitHash> results_;
  std::vector<Visit> stack_;
  Result last_;           ///< of the node that ended last
  bool pending_ = false;  ///< enter() began a node that has yet to end
  std::vector<Object> objects_;
  std::vector<Material> materials_;
  std::map<std::pair<ValueId, std::int32_t>, double> object_ids_;
  std::vector<Paint> paints_;
  std::map<std::array<double, 6>, std::int32_t> paint_ids_;
};

}  // namespace

Lowered lower(const Node& root, const FactTable& facts, LoweringOf what) {
  return Lowering(facts, what == LoweringOf::kAttributes).run(root);
}

}  // namespace octomarch
