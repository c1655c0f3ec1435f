// Traces of the primitives' distances. Traces, flat shapes and polyhedra come before it; the walk over a field calls it at
// the leaves of the node graph.
#pragma once

#include <span>

#include "octomarch/graph/node.hpp"
#include "octomarch/reference/trace.hpp"

namespace octomarch::reference {

/// Signed distance of a primitive that is no field and no solid of the user's.
Trace primitive_trace(const Node& node, const PointTrace& p);

/// Exact distance to a box of as many dimensions as `excess` has: |p| − half size.
Trace box_trace(std::span<const Trace> excess);

}  // namespace octomarch::reference
