// Normals of painted surfaces below operators that bend space. Placement asks for them as it goes down; only materials
// look at them.
#pragma once

#include <array>

#include "octomarch/program/placement.hpp"

namespace octomarch {

/// The surface's unit normal as the child of a kStretch, kMirror, kTwist, kBend or kRevolve has it: along the gradient
/// there that the operator makes the normal `own` of. Other operators leave it. `parent`, `child`: coordinates of the
/// node and of its child, in world units; `scale`: of the node's placement.
std::array<ValueId, 3> bent_normal(const Node& node, double scale, const std::array<ValueId, 3>& own,
                                   const std::array<ValueId, 3>& parent, const std::array<ValueId, 3>& child,
                                   DataFlow& flow);

}  // namespace octomarch
