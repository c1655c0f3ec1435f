// Traces of the distances of solids bounded by planes. Traces and segments come before it; primitives list what is here.
#pragma once

#include "octomarch/reference/trace.hpp"

namespace octomarch::reference {

/// |x| + |y| + |z| ≤ radius.
Trace octahedron_trace(const PointTrace& p, double radius);
/// Square base of half edge e at y = −h, apex at y = h.
Trace pyramid_trace(const PointTrace& p, double e, double h);

}  // namespace octomarch::reference
