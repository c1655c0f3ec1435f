#include "octomarch/graph/grid.hpp"

#include <algorithm>
#include <cmath>

#include "octomarch/graph/cubic_slope.hpp"

namespace octomarch {
namespace {

/// What roundings in the sums below may take away.
constexpr double kUp = 1.0 + 0x1p-40;

double largest(double a, double b, double c) { return std::max(a, std::max(b, c)); }

/// Calls visit(i, j, k, index) for every sample in their order.
template <class Visit>
void each_sample(const std::array<std::size_t, 3>& size, const Visit& visit) {
  std::size_t index = 0;
  for (std::size_t i = 0; i < size[0]; ++i) {
    for (std::size_t j = 0; j < size[1]; ++j) {
      for (std::size_t k = 0; k < size[2]; ++k) visit(i, j, k, index++);
    }
  }
}

/// The steepest edges along each axis of those that meet in each sample.
template <class Visit>
void each_meeting(const GridSamples& samples, const Visit& visit) {
  const std::array<std::size_t, 3> strides = samples.strides();
  each_sample(samples.size, [&](std::size_t i, std::size_t j, std::size_t k, std::size_t index) {
    const std::size_t place[3] = {i, j, k};
    const auto at = [&](std::size_t other) { return static_cast<double>(samples.values[other]); };
    double steepest[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double here = at(index);
      const double before = place[axis] > 0 ? std::fabs(here - at(index - strides[axis])) : 0.0;
      const double after = place[axis] + 1 < samples.size[axis] ? std::fabs(at(index + strides[axis]) - here) : 0.0;
      steepest[axis] = std::max(before, after) / samples.spacing[axis];
    }
    visit(steepest);
  });
}

/// Along each axis ∂/∂axis of the trilinear interpolant is linear in the other two coordinates and independent of its own,
/// so the squared length of the gradient is a convex function of each coordinate: it is largest in a corner of a cell,
/// where it is made of three edges that meet there, one along each axis.
double linear_slope(const GridSamples& samples) {
  double squared = 0.0;
  each_meeting(samples, [&](const double (&edges)[3]) {
    squared = std::max(squared, edges[0] * edges[0] + edges[1] * edges[1] + edges[2] * edges[2]);
  });
  return std::sqrt(squared);
}

}  // namespace

GridSamples samples_of(const Node& grid) {
  GridSamples samples{grid.texels(), {}, {}, grid.parameter(3) == 0.0 ? Interpolation::kLinear : Interpolation::kCubic};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    samples.size[axis] = static_cast<std::size_t>(grid.parameter(axis));
    samples.spacing[axis] = (grid.parameter(9 + axis) - grid.parameter(6 + axis)) / (grid.parameter(axis) - 1.0);
  }
  return samples;
}

Aabb box_of(const Node& grid) {
  return {{grid.parameter(6), grid.parameter(7), grid.parameter(8)},
          {grid.parameter(9), grid.parameter(10), grid.parameter(11)}};
}

double steepest_slope(const GridSamples& samples) {
  return kUp * (samples.interpolation == Interpolation::kLinear ? linear_slope(samples) : cubic_slope(samples));
}

double steepest_edge(const GridSamples& samples) {
  double steepest = 0.0;
  each_meeting(samples,
               [&](const double (&edges)[3]) { steepest = std::max(steepest, largest(edges[0], edges[1], edges[2])); });
  return steepest;
}

Interval value_range(const GridSamples& samples) {
  const auto [least, most] = std::ranges::minmax(samples.values);
  const Interval range(static_cast<double>(least), static_cast<double>(most));
  if (samples.interpolation == Interpolation::kLinear) return range;
  // weights add up to 1, and those below 0 to no less than −1/8 along each axis: a quarter wider each time
  constexpr double kWider = 1.25 * 1.25 * 1.25;
  const double over = kUp * 0.5 * (kWider - 1.0) * (range.hi() - range.lo());
  return {range.lo() - over, range.hi() + over};
}

Aabb solid_box(const GridSamples& samples, const Aabb& box) {
  std::array<std::size_t, 3> first = samples.size;
  std::array<std::size_t, 3> last{};
  each_sample(samples.size, [&](std::size_t i, std::size_t j, std::size_t k, std::size_t index) {
    if (samples.values[index] > 0.0F) return;
    const std::size_t place[3] = {i, j, k};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      first[axis] = std::min(first[axis], place[axis]);
      last[axis] = std::max(last[axis], place[axis]);
    }
  });
  if (first == samples.size) return box;
  const std::array<double, 3> lo{box.lo.x, box.lo.y, box.lo.z};
  const std::array<double, 3> hi{box.hi.x, box.hi.y, box.hi.z};
  std::array<double, 3> low{};
  std::array<double, 3> high{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double spacing = samples.spacing[axis];
    const auto above = static_cast<double>(first[axis]) - 1.0;
    const auto below = static_cast<double>(samples.size[axis] - 1 - last[axis]) - 1.0;
    low[axis] = lo[axis] + std::max(above, 0.0) * spacing;
    high[axis] = hi[axis] - std::max(below, 0.0) * spacing;
  }
  return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}

bool is_mirrored(const GridSamples& samples, std::size_t axis) {
  const std::array<std::size_t, 3> strides = samples.strides();
  const std::size_t run = strides[axis];
  const std::size_t count = samples.size[axis];
  for (std::size_t block = 0; block < samples.values.size(); block += run * count) {
    for (std::size_t i = 0; i < count / 2; ++i) {
      const auto side = [&](std::size_t n) { return samples.values.subspan(block + n * run, run); };
      if (!std::ranges::equal(side(i), side(count - 1 - i))) return false;
    }
  }
  return true;
}

}  // namespace octomarch
