// Traces of what is made of cells: gradient noise, images and grids. Traces come before it; those of expressions and of
// primitives ask for it.
#pragma once

#include "octomarch/graph/node.hpp"
#include "octomarch/reference/trace.hpp"

namespace octomarch::reference {

/// Contract: `node` is a kNoise.
Trace noise(const Node& node, const PointTrace& p);
/// All values of a kTexel's channel. O(texels).
Interval channel_range(const Node& node);
/// Contract: `node` is a kTexel; `anywhere` is its channel_range().
Trace texel(const Node& node, const Interval& anywhere, const Trace& u, const Trace& v);
/// Between the samples of a kGrid, at points of its box.
Trace interpolant(const Node& grid, const PointTrace& p);

}  // namespace octomarch::reference
