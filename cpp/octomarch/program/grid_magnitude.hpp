// How large the numbers are whose roundings count in the lookup of a grid. Ranges come before it; margins and rounding
// bounds are made of it.
#pragma once

#include <algorithm>
#include <cmath>

#include "octomarch/ops/grid.hpp"
#include "octomarch/program/instruction.hpp"
#include "octomarch/program/range.hpp"

namespace octomarch {

constexpr bool is_grid(Opcode op) { return op == Opcode::kLinearGrid || op == Opcode::kCubicGrid; }

/// Lookups lose no more than 64 units of roundoff of this: a point between samples is off by roundings of its coordinates
/// and of the box, which weigh as much as the field is steep; the sums of samples by roundings of these.
template <class Real>
double grid_magnitude(const Real* p, const Range<Real>* point) {
  double farthest = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Real* const of_axis = p + ops::kGridAxes + axis * ops::kGridAxisConstants;
    const double box = std::fabs(static_cast<double>(of_axis[2])) + static_cast<double>(of_axis[3]);
    farthest += static_cast<double>(point[axis].magnitude()) + box;
  }
  const double values =
      std::max(std::fabs(static_cast<double>(p[ops::kGridLeast])), std::fabs(static_cast<double>(p[ops::kGridMost])));
  return static_cast<double>(p[ops::kGridLipschitz]) * farthest + values;
}

}  // namespace octomarch
