// What samples on a grid say of the field between them: how steep it is, between what it stays, which symmetries it has.
// Builders, facts and the lowering ask for it.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "octomarch/base/interval.hpp"
#include "octomarch/base/types.hpp"
#include "octomarch/graph/node.hpp"

namespace octomarch {

enum class Interpolation : std::uint8_t { kLinear, kCubic };

/// Samples size[0] × size[1] × size[2], the last index changing fastest, `spacing` apart along each axis. Contract: at
/// least two along each axis, and as many values as that makes.
struct GridSamples {
  std::span<const float> values;
  std::array<std::size_t, 3> size;
  std::array<double, 3> spacing;
  Interpolation interpolation;

  /// Steps from a value to the next along each axis.
  std::array<std::size_t, 3> strides() const { return {size[1] * size[2], size[2], 1}; }
};

/// A sample, or what goes on straight just beyond an edge: each index from −1 to the size along its axis. `Number`: in what
/// those beyond are worked out.
template <class Number>
Number sample_at(const GridSamples& samples, std::ptrdiff_t i, std::ptrdiff_t j, std::ptrdiff_t k) {
  const std::ptrdiff_t index[3] = {i, j, k};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto last = static_cast<std::ptrdiff_t>(samples.size[axis]) - 1;
    if (index[axis] >= 0 && index[axis] <= last) continue;
    std::ptrdiff_t edge[3] = {i, j, k};
    std::ptrdiff_t inner[3] = {i, j, k};
    edge[axis] = index[axis] < 0 ? 0 : last;
    inner[axis] = index[axis] < 0 ? 1 : last - 1;
    return Number(2.0) * sample_at<Number>(samples, edge[0], edge[1], edge[2]) -
           sample_at<Number>(samples, inner[0], inner[1], inner[2]);
  }
  const auto place = [&index](std::size_t axis) { return static_cast<std::size_t>(index[axis]); };
  const std::size_t row = place(0) * samples.size[1] + place(1);
  return Number(static_cast<double>(samples.values[row * samples.size[2] + place(2)]));
}

/// Those of a kGrid node, and the box that they fill.
GridSamples samples_of(const Node& grid);
Aabb box_of(const Node& grid);

/// The largest |∇| of the interpolant. Exact for the linear one but for roundings upward; of the cubic one an upper bound.
/// O(values).
double steepest_slope(const GridSamples& samples);

/// By how much two neighbouring samples differ at the most, per unit of length. O(values).
double steepest_edge(const GridSamples& samples);

/// Holds all values of the interpolant. O(values).
Interval value_range(const GridSamples& samples);

/// The part of the samples' box with all samples ≤ 0, and one more on each side; all of it where there is none. O(values).
Aabb solid_box(const GridSamples& samples, const Aabb& box);

/// Are the samples the same in reverse order along an axis? O(values), little where they are not.
bool is_mirrored(const GridSamples& samples, std::size_t axis);

}  // namespace octomarch
