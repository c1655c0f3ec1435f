// Placement: where a node stands while the graph is lowered. Coordinates flow down through it, and each primitive is
// emitted with the placement folded into its constants.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "octomarch/graph/node.hpp"
#include "octomarch/program/dataflow.hpp"
#include "octomarch/program/lower_expression.hpp"

namespace octomarch {

/// Local coordinates of a node, relative to coordinates that exist as values: p_frame = scale·rotation·p_local + offset.
/// A node's field times scale is its distance in the world; where operators bend space, a lower bound once it is divided
/// by their Lipschitz bounds.
struct Placement {
  std::array<ValueId, 3> frame{0, 1, 2};
  std::array<ValueId, 3> normal{kNoNormal, kNoNormal, kNoNormal};  ///< the surface's, turned with the frame
  double scale = 1.0;
  Mat3 rotation = kIdentity3;
  Vec3 offset;
  std::int32_t material = -1;  ///< the innermost paint around the node so far; −1 = none

  friend bool operator==(const Placement&, const Placement&) = default;
};

std::uint64_t hash_of(const Placement& placement);

/// The placement of the child of a kTranslate, kRotate or kScale node.
Placement child_placement(const Placement& parent, const Node& transform);

/// The same place with axes along the frame's: where the rotation is no signed permutation, coordinates are turned by
/// one instruction, shared by all that stands in the same turned frame.
Placement aligned(const Placement& placement, DataFlow& flow);

/// Coordinates along the node's own axes, from its own origin, in world units: local coordinates times scale.
std::array<ValueId, 3> own_axes(const Placement& placement, DataFlow& flow);

/// The node's own coordinates, as expressions see them.
Coordinates own_coordinates(const Placement& placement, DataFlow& flow);

/// The placement of the child of an operator that moves points in ways of its own: kStretch, kMirror, kElongate, kTwist,
/// kBend, kRevolve, kExtrude.
Placement bent_placement(const Placement& parent, const Node& node, DataFlow& flow);

/// Placements of a kRepeat node's child: one, or 2ᵐ where the child lacks the mirror symmetry `symmetry` (analysis.hpp)
/// on m of the repeated axes, so that the neighbouring cells are looked at too.
std::vector<Placement> repeat_placements(const Placement& parent, const Node& repeat, unsigned symmetry,
                                         DataFlow& flow);

/// Distance of the cylinder to which kTwist and kBend nodes cut their child.
ValueId emit_cut(const Node& node, const Placement& placement, DataFlow& flow);

/// The normal of a kPlane node in the frame, and its h there.
std::array<double, 4> placed_plane(const Node& plane, const Placement& placement);

/// Emits a primitive node, mostly as one instruction; returns its distance value. Not for kField and kSolid.
ValueId emit_primitive(const Node& primitive, const Placement& placement, DataFlow& flow);

}  // namespace octomarch
