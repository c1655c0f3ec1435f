// Traces of distances to segments and polygons. Traces come before it; primitives and polyhedra are made of them.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "octomarch/reference/trace.hpp"

namespace octomarch::reference {

/// Along a–b from 0 to 1, beyond the ends as on the line through them, and without bound where both are too near.
template <std::size_t dimension>
Trace along_line(std::span<const Trace, dimension> p, std::span<const double, dimension> a,
                 std::span<const double, dimension> b) {
  Trace dot = constant(0.0);
  Interval squared;
  for (std::size_t i = 0; i < dimension; ++i) {
    const Interval side = Interval(b[i]) - a[i];
    dot = dot + (p[i] - a[i]) * side;
    squared = squared + square(side);
  }
  return dot / squared;
}

/// From the nearest point of the segment a–b to p.
template <std::size_t dimension>
std::array<Trace, dimension> from_segment(std::span<const Trace, dimension> p, std::span<const double, dimension> a,
                                          std::span<const double, dimension> b) {
  const Trace fraction = min(max(along_line<dimension>(p, a, b), 0.0), 1.0);
  std::array<Trace, dimension> offset;
  for (std::size_t i = 0; i < dimension; ++i) offset[i] = p[i] - a[i] - fraction * (Interval(b[i]) - a[i]);
  return offset;
}

/// Exact distance to the polygon of corners x₀ y₀ x₁ y₁ …; inside is what its edges cross an odd number of times.
Trace polygon_trace(std::span<const double> corners, const Trace& x, const Trace& y);

}  // namespace octomarch::reference
