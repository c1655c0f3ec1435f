// Traces of what is made of cells: gradient noise and images. Traces come before it; those of expressions ask for it.
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

}  // namespace octomarch::reference
