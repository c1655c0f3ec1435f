// Grids: within a cell the linear interpolant is bounded by blends of its corners, the cubic one by de Casteljau's blends of
// its numbers in Bézier's form; over many cells by its ends and its slope.
#include <array>
#include <cstddef>

#include "octomarch/graph/grid.hpp"
#include "octomarch/reference/trace_cells.hpp"
#include "octomarch/reference/trace_lattice.hpp"

namespace octomarch::reference {
namespace {

/// Blends `a` and `b` along an axis whose slopes come later.
Range<3> blended(const Range<3>& a, const Range<3>& b, const Interval& share) {
  Range<3> result{blend(a.value, b.value, share), {}};
  for (std::size_t axis = 0; axis < 3; ++axis) result.slopes[axis] = blend(a.slopes[axis], b.slopes[axis], share);
  return result;
}

/// Four neighbours along an axis, of which the cell lies between the second and the third: its values over `share` of it.
Range<3> cubic_between(const std::array<Range<3>, 4>& p, const Interval& share, std::size_t axis) {
  const auto moved = [](const Range<3>& from, const Range<3>& low, const Range<3>& high) {
    const Interval sixth(6.0);
    Range<3> result{from.value + (high.value - low.value) / sixth, {}};
    for (std::size_t i = 0; i < 3; ++i) result.slopes[i] = from.slopes[i] + (high.slopes[i] - low.slopes[i]) / sixth;
    return result;
  };
  const std::array<Range<3>, 4> form{p[1], moved(p[1], p[0], p[2]), moved(p[2], p[3], p[1]), p[2]};
  const Range<3> middle = blended(form[1], form[2], share);
  const Range<3> low = blended(blended(form[0], form[1], share), middle, share);
  const Range<3> high = blended(middle, blended(form[2], form[3], share), share);
  return between(low, high, share, 3.0, axis);
}

class Lookup {
 public:
  explicit Lookup(const Node& node) : samples_(samples_of(node)) {}

  Range<3> over(const std::array<Interval, 3>& x) const {
    const auto few = over_cells<3>(x, [&](const Cell<3>& cell) { return in_cell(cell, x); });
    constexpr auto kAnything = Interval::whole;
    return few ? *few : Range<3>{kAnything(), {kAnything(), kAnything(), kAnything()}};
  }

 private:
  /// The last sample's place is in the cell before it.
  Range<3> in_cell(const Cell<3>& lattice_cell, const std::array<Interval, 3>& x) const {
    std::array<Interval, 3> t;
    std::array<std::ptrdiff_t, 3> cell{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double most = static_cast<double>(samples_.size[axis]) - 2.0;
      const double held = std::clamp(lattice_cell[axis], 0.0, most);
      cell[axis] = static_cast<std::ptrdiff_t>(held);
      t[axis] = within(held, x[axis]);
    }
    const auto sample = [&](std::ptrdiff_t i, std::ptrdiff_t j, std::ptrdiff_t k) -> Range<3> {
      return {sample_at<Interval>(samples_, cell[0] + i, cell[1] + j, cell[2] + k), {}};
    };
    const auto joined = [&](const auto& at, std::size_t axis) {
      if (samples_.interpolation == Interpolation::kLinear) return between(at(0), at(1), t[axis], 1.0, axis);
      return cubic_between({at(-1), at(0), at(1), at(2)}, t[axis], axis);
    };
    const auto row = [&](std::ptrdiff_t i, std::ptrdiff_t j) {
      return joined([&](std::ptrdiff_t k) { return sample(i, j, k); }, 2);
    };
    const auto layer = [&](std::ptrdiff_t i) { return joined([&](std::ptrdiff_t j) { return row(i, j); }, 1); };
    return joined(layer, 0);
  }

  GridSamples samples_;
};

}  // namespace

Trace interpolant(const Node& grid, const PointTrace& p) {
  const Lookup lookup(grid);
  PointTrace place;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double lo = grid.parameter(6 + axis);
    const double hi = grid.parameter(9 + axis);
    place[axis] = (p[axis] - lo) * (Interval(grid.parameter(axis) - 1.0) / (Interval(hi) - Interval(lo)));
  }
  const auto range = [&lookup](const Interval& x, const Interval& y, const Interval& z) {
    return lookup.over({x, y, z});
  };
  const double most = rounding::multiply<true>(grid.parameter(4), speed(p));
  return traced(range, most, place[0], place[1], place[2]);
}

}  // namespace octomarch::reference
