// The node graph: what the user built, as immutable interned nodes. Builders (builder.hpp) come before it in a user's
// hands; the compiler (program/lower.hpp) and the scalar reference walk it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "octomarch/base/types.hpp"

namespace octomarch {

/// What a node is: see nodes.def for each kind's parameters and children.
enum class NodeKind : std::uint8_t {
#define OCTOMARCH_NODE(kind, name, parameters, children) k##kind,
#include "octomarch/graph/nodes.def"
#undef OCTOMARCH_NODE
};

/// Is a node of this kind a number at a point, and no shape or image?
constexpr bool is_expression(NodeKind kind) { return kind >= NodeKind::kCoordinate && kind < NodeKind::kImage; }
constexpr bool is_shape(NodeKind kind) { return kind < NodeKind::kCoordinate; }

class Node;
using NodePtr = std::shared_ptr<const Node>;

/// One immutable node. Two nodes with equal kind, parameters, children and texels are the same object (see intern()), so
/// pointer equality is structural equality. Destruction of a graph of any depth uses constant stack.
class Node : public std::enable_shared_from_this<Node> {
 public:
  /// For intern() alone; `hash`: of all the rest.
  Node(std::uint64_t hash, NodeKind kind, std::vector<double> parameters, std::vector<NodePtr> children,
       std::vector<float> texels);
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;
  ~Node();

  NodeKind kind() const { return kind_; }
  std::span<const double> parameters() const { return parameters_; }
  double parameter(std::size_t i) const { return parameters_[i]; }
  std::span<const NodePtr> children() const { return children_; }
  const Node& child(std::size_t i) const { return *children_[i]; }
  /// RGB after RGB, row after row from the top, of images; samples of grids; nothing of others.
  std::span<const float> texels() const { return texels_; }

  /// Shapes: is the field the same at every z? Such are the flat primitives, and what is made of them without leaving
  /// the plane.
  bool is_flat() const { return is_flat_; }
  /// Is a part of it known by no more than its inside (kSolid)?
  bool has_solid() const { return has_solid_; }
  /// Expressions: is z of the point among what it is made of; is the surface's normal?
  bool uses_z() const { return uses_z_; }
  bool uses_normal() const { return uses_normal_; }

 private:
  friend class Interner;
  std::uint64_t hash_;
  NodeKind kind_;
  bool is_flat_ = false;
  bool has_solid_ = false;
  bool uses_z_ = false;
  bool uses_normal_ = false;
  std::vector<double> parameters_;
  std::vector<NodePtr> children_;
  std::vector<float> texels_;
};

/// The one node with this content: an existing equal node, or a new one. Parameters are compared bit by bit after −0
/// becomes +0. Thread-safe; O(parameters + children + texels) expected.
NodePtr intern(NodeKind kind, std::vector<double> parameters, std::vector<NodePtr> children,
               std::vector<float> texels = {});

/// Is its parent the only one that holds a child? Then no other way leads there, and a walk that comes to the parent once
/// need not remember the child. False also where somebody outside of the graph holds it.
inline bool has_one_owner(const NodePtr& child) { return child.use_count() == 1; }

/// Distinct nodes reachable from `root`. O(nodes), constant stack.
std::size_t count_nodes(const NodePtr& root);

/// Repetition along one axis: the cell of coordinate p is the copy whose centre is nearest, copies standing at
/// (i − (count−1)/2)·period for i in [0, count), or at all whole multiples when count = 0. Three constants describe it:
/// cell centre = (clamp(floor(p/period + shift) + ½ − shift, −limit, limit))·period.
struct RepeatAxis {
  double period;  ///< > 0, or 0 for an axis that is not repeated
  double shift;   ///< ½ for an odd or endless count, 0 for an even one
  double limit;   ///< (count − 1)/2, or +inf
};

/// A coordinate of the middle copy, or of another of an endless axis, which are all alike, where it is many periods away.
double nearest_middle(const RepeatAxis& axis, double middle);

/// The constants of axis 0, 1 or 2 of a kRepeat node.
RepeatAxis repeat_axis(const Node& repeat, std::size_t axis);

}  // namespace octomarch
