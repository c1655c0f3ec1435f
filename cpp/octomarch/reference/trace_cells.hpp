// Functions that are polynomials in each cell of a lattice, and continuous: over a few cells each counts for the part that
// lies in it. Traces come before it; noise, images and grids are bounded so.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "octomarch/reference/trace.hpp"

namespace octomarch::reference {

inline constexpr double kMostCells = 8.0;
/// Farther out the lattice is not looked at: its hash is exact as long as whole numbers are.
inline constexpr double kFarthestCell = 0x1p30;

/// Values, and partial derivatives by as many numbers as there are axes.
template <std::size_t axes>
struct Range {
  Interval value;
  std::array<Interval, axes> slopes;
};

template <std::size_t axes>
Range<axes> hull(const Range<axes>& a, const Range<axes>& b) {
  Range<axes> result{hull(a.value, b.value), {}};
  for (std::size_t axis = 0; axis < axes; ++axis) result.slopes[axis] = hull(a.slopes[axis], b.slopes[axis]);
  return result;
}

/// A blend between two sides along `axis`, `share` of it of the high side, whose derivative is `steepness`.
template <std::size_t axes>
Range<axes> between(const Range<axes>& low, const Range<axes>& high, const Interval& share, const Interval& steepness,
                    std::size_t axis) {
  Range<axes> result{blend(low.value, high.value, share), {}};
  for (std::size_t i = 0; i < axes; ++i) result.slopes[i] = blend(low.slopes[i], high.slopes[i], share);
  result.slopes[axis] = result.slopes[axis] + steepness * (high.value - low.value);
  return result;
}

template <std::size_t axes>
using Cell = std::array<double, axes>;

/// Where in a cell those numbers lie that are in it, from 0 to 1.
inline Interval within(double cell, const Interval& x) {
  const Interval place = x - Interval(cell);
  return {std::clamp(place.lo(), 0.0, 1.0), std::clamp(place.hi(), 0.0, 1.0)};
}

/// The hull of in_cell(cell) over all cells that the numbers lie in; nothing where those are too many or too far.
template <std::size_t axes, class InCell>
std::optional<Range<axes>> over_cells(const std::array<Interval, axes>& x, const InCell& in_cell) {
  Cell<axes> first;
  double count = 1.0;
  for (std::size_t axis = 0; axis < axes; ++axis) {
    first[axis] = std::floor(x[axis].lo());
    count *= std::floor(x[axis].hi()) - first[axis] + 1.0;
    if (!(x[axis].magnitude() < kFarthestCell && count <= kMostCells)) return std::nullopt;
  }
  std::optional<Range<axes>> result;
  Cell<axes> cell = first;
  for (std::size_t axis = 0; axis < axes;) {
    const Range<axes> range = in_cell(cell);
    result = result ? hull(*result, range) : range;
    for (axis = 0; axis < axes && ++cell[axis] > x[axis].hi(); ++axis) cell[axis] = first[axis];
  }
  return result;
}

/// A trace of a function of some numbers from its ranges over intervals of them, and no faster than `most`.
template <class RangeOver, class... Operands>
Trace traced(const RangeOver& range, double most, const Operands&... x) {
  const auto over = range(x.over...);
  Interval rise;
  std::size_t axis = 0;
  ((rise = rise + over.slopes[axis++] * x.rise), ...);
  const bool is_undefined = (x.is_undefined || ...);
  return no_faster({over.value, range(x.first...).value, range(x.last...).value, rise, false, is_undefined}, most);
}

}  // namespace octomarch::reference
