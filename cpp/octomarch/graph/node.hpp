// The node graph: what the user built, as immutable interned nodes. Builders (builder.hpp) come before it in a user's
// hands; the compiler (program/lower.hpp) and the scalar reference walk it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "octomarch/base/types.hpp"

namespace octomarch {

/// What a node is. Parameters are doubles in the order given here; children as listed.
enum class NodeKind : std::uint8_t {
  kSphere,          ///< radius ≥ 0. Centre at the origin.
  kBox,             ///< half_x half_y half_z ≥ 0. Exact box about the origin.
  kPlane,           ///< n_x n_y n_z (unit) h: value n·p + h.
  kCylinder,        ///< radius ≥ 0, axis (0, 1, 2). Infinite.
  kCappedCylinder,  ///< radius ≥ 0, half_height ≥ 0, axis.
  kTorus,           ///< radius ≥ 0 (centre line), tube_radius ≥ 0, axis.
  kCapsule,         ///< a (3), b (3), radius ≥ 0.
  kUnion,           ///< k ≥ 0 (blend distance); children, at least one. Folded from the left: ((c0, c1), c2), …
  kIntersection,    ///< k ≥ 0; children, at least one; folded from the left.
  kDifference,      ///< k ≥ 0; children[0] minus each of the others in turn.
  kComplement,      ///< one child: −value.
  kTranslate,       ///< offset (3); one child: value at p − offset.
  kRotate,          ///< parent_from_child rotation, row-major (9); one child: value at Rᵀp.
  kScale,           ///< factor > 0; one child: factor · value at p / factor.
  kRepeat,  ///< period (3; 0 = not repeated on that axis), count (3; 0 = endless); one child. See repeat_cell().
  kPaint,   ///< colour (3), roughness, specular, metallic; one child. The innermost paint wins.
};

class Node;
using NodePtr = std::shared_ptr<const Node>;

/// One immutable node. Two nodes with equal kind, parameters and children are the same object (see intern()), so
/// pointer equality is structural equality. Destruction of a graph of any depth uses constant stack.
class Node {
 public:
  Node(NodeKind kind, std::vector<double> parameters, std::vector<NodePtr> children);
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  NodeKind kind() const { return kind_; }
  std::span<const double> parameters() const { return parameters_; }
  double parameter(std::size_t i) const { return parameters_[i]; }
  std::span<const NodePtr> children() const { return children_; }
  const Node& child(std::size_t i) const { return *children_[i]; }

 private:
  friend class Interner;
  NodeKind kind_;
  std::vector<double> parameters_;
  std::vector<NodePtr> children_;
};

/// The one node with this content: an existing equal node, or a new one. Parameters are compared bit by bit after −0
/// becomes +0. Thread-safe; O(parameters + children) expected.
NodePtr intern(NodeKind kind, std::vector<double> parameters, std::vector<NodePtr> children);

/// Lower-case name of a kind ("sphere", "smooth union" is "union" with k > 0).
std::string_view name(NodeKind kind);

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

/// The constants of axis 0, 1 or 2 of a kRepeat node.
RepeatAxis repeat_axis(const Node& repeat, std::size_t axis);

}  // namespace octomarch
