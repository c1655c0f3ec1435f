// Noise and images: within a cell both are polynomials, and are bounded by blends of what the corners say; over many cells
// by what holds for all. Grids are in trace_grid.cpp.
#include "octomarch/reference/trace_lattice.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "octomarch/graph/expression_bounds.hpp"
#include "octomarch/reference/noise.hpp"
#include "octomarch/reference/texel.hpp"
#include "octomarch/reference/trace_cells.hpp"

namespace octomarch::reference {
namespace {

/// 6t⁵ − 15t⁴ + 10t³, which grows from 0 to 1.
Interval fade(const Interval& t) {
  const auto at = [](const Interval& x) { return x * x * x * (x * (x * 6.0 - 15.0) + 10.0); };
  return {std::max(at(t.lo()).lo(), 0.0), std::min(at(t.hi()).hi(), 1.0)};
}

/// Its derivative 30t²(1 − t)².
Interval steepness(const Interval& t) { return Interval(30.0) * square(Interval(0.25) - square(t - Interval(0.5))); }

Range<3> noise_in_cell(const Cell<3>& cell, const std::array<Interval, 3>& x, double seed) {
  std::array<Interval, 3> t;
  for (std::size_t axis = 0; axis < 3; ++axis) t[axis] = within(cell[axis], x[axis]);
  std::array<Range<3>, 8> corners;
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const std::array<double, 3> offset{static_cast<double>(corner & 1U), static_cast<double>((corner >> 1U) & 1U),
                                       static_cast<double>(corner >> 2U)};
    const Vector<double> slope =
        lattice_slope(Vector<double>(cell[0] + offset[0], cell[1] + offset[1], cell[2] + offset[2]), seed);
    corners[corner] = {0.0, {slope.x, slope.y, slope.z}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      corners[corner].value = corners[corner].value + corners[corner].slopes[axis] * (t[axis] - Interval(offset[axis]));
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t count = 4U >> axis;
    for (std::size_t i = 0; i < count; ++i) {
      corners[i] = between(corners[2 * i], corners[2 * i + 1], fade(t[axis]), steepness(t[axis]), axis);
    }
  }
  return corners[0];
}

Range<3> noise_over(const std::array<Interval, 3>& x, double seed) {
  const Interval slope{-kNoiseSlope, kNoiseSlope};
  auto range = over_cells<3>(x, [&](const Cell<3>& cell) {
                 return noise_in_cell(cell, x, seed);
               }).value_or(Range<3>{Interval::whole(), {slope, slope, slope}});
  range.value = overlap(range.value, {-kNoiseValue, kNoiseValue});
  return range;
}

/// A channel of an image by column and row, counted from the centre of the first texel.
class Channel {
 public:
  /// `anywhere`: what its texels lie in.
  Channel(const Node& node, const Interval& anywhere)
      : anywhere_(anywhere),
        image_(node.child(0)),
        channel_(static_cast<std::size_t>(node.parameter(0))),
        repeats_{node.parameter(1) != 0.0, node.parameter(1) == 1.0},
        size_{image_.parameter(0), image_.parameter(1)} {}

  double width() const { return size_[0]; }
  double height() const { return size_[1]; }

  Range<2> over(const Interval& column, const Interval& row) const {
    const std::array<Interval, 2> x{column, row};
    const auto few = over_cells<2>(x, [&](const Cell<2>& cell) { return in_cell(cell, x); });
    const Interval slope = anywhere_ - anywhere_;
    return few ? *few : Range<2>{anywhere_, {slope, slope}};
  }

 private:
  double at(double column, double row) const {
    const auto width = static_cast<std::size_t>(size_[0]);
    const std::size_t j = wrapped(row, static_cast<std::size_t>(size_[1]), repeats_[1]);
    const std::size_t i = wrapped(column, width, repeats_[0]);
    return static_cast<double>(image_.texels()[3 * (j * width + i) + channel_]);
  }

  Range<2> in_cell(const Cell<2>& cell, const std::array<Interval, 2>& x) const {
    const auto row = [&](double j) {
      const Range<2> left{at(cell[0], cell[1] + j), {}};
      const Range<2> right{at(cell[0] + 1.0, cell[1] + j), {}};
      return between(left, right, within(cell[0], x[0]), 1.0, 0);
    };
    return between(row(0.0), row(1.0), within(cell[1], x[1]), 1.0, 1);
  }

  Interval anywhere_;
  const Node& image_;
  std::size_t channel_;
  std::array<bool, 2> repeats_;
  std::array<double, 2> size_;
};

}  // namespace

Trace noise(const Node& node, const PointTrace& p) {
  const double seed = std::fmod(node.parameter(0), 289.0);
  const auto range = [seed](const Interval& x, const Interval& y, const Interval& z) {
    return noise_over({x, y, z}, seed);
  };
  return traced(range, rounding::multiply<true>(kNoiseSlope, speed(p)), p[0], p[1], p[2]);
}

Interval channel_range(const Node& node) {
  const std::span<const float> texels = node.child(0).texels();
  const auto channel = static_cast<std::size_t>(node.parameter(0));
  Interval range = static_cast<double>(texels[channel]);
  for (std::size_t i = channel; i < texels.size(); i += 3) {
    range = octomarch::hull(range, static_cast<double>(texels[i]));
  }
  return range;
}

Trace texel(const Node& node, const Interval& anywhere, const Trace& u, const Trace& v) {
  const Channel channel(node, anywhere);
  const Trace column = u * channel.width() - 0.5;
  const Trace row = (constant(1.0) - v) * channel.height() - 0.5;
  const auto range = [&channel](const Interval& i, const Interval& j) { return channel.over(i, j); };
  return traced(range, kInfinity, column, row);
}

}  // namespace octomarch::reference
