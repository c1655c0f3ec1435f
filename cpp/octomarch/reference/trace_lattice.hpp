// Traces of what is made of cells: gradient noise and images. Traces come before it; those of expressions ask for it.
#pragma once

#include "octomarch/graph/node.hpp"
#include "octomarch/reference/trace.hpp"

namespace octomarch::reference {

/// Contract: `node` is a kNoise.
Trace noise(const Node& node, const PointTrace& p);
/// Contract: `node` is a kTexel.
Trace texel(const Node& node, const Trace& u, const Trace& v);

}  // namespace octomarch::reference
