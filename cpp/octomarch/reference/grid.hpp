// Fields between samples, by Hermite's form along one axis after the other. Vectors come before it; primitives.hpp calls it.
// Written apart from ops/grid.hpp, which sums weighted samples.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "octomarch/graph/grid.hpp"
#include "octomarch/reference/jet.hpp"
#include "octomarch/reference/vector.hpp"

namespace octomarch::reference {

/// A number between samples, and its derivatives by each of the three indices.
template <class T>
struct GridJet {
  T value{};
  Vector<T> slopes{};

  friend GridJet operator+(const GridJet& a, const GridJet& b) { return {a.value + b.value, a.slopes + b.slopes}; }
  friend GridJet operator-(const GridJet& a, const GridJet& b) { return {a.value - b.value, a.slopes - b.slopes}; }
  friend GridJet operator*(const GridJet& a, T factor) { return {a.value * factor, a.slopes * factor}; }
};

/// Between b and c, which a comes before and d after, at t of the way, where the axis has the number `axis`.
template <class T>
GridJet<T> between(const GridJet<T>& a, const GridJet<T>& b, const GridJet<T>& c, const GridJet<T>& d, T t, int axis) {
  const GridJet<T> leaving = (c - a) * T(0.5);
  const GridJet<T> arriving = (d - b) * T(0.5);
  const GridJet<T> rise = c - b;
  GridJet<T> result = b + rise * (t * t * (T(3) - T(2) * t)) + leaving * (t * (T(1) - t) * (T(1) - t)) -
                      arriving * (t * t * (T(1) - t));
  result.slopes[axis] = rise.value * (T(6) * t * (T(1) - t)) + leaving.value * ((T(1) - t) * (T(1) - T(3) * t)) -
                        arriving.value * (t * (T(2) - T(3) * t));
  return result;
}

template <class T>
GridJet<T> between(const GridJet<T>& b, const GridJet<T>& c, T t, int axis) {
  GridJet<T> result = b * (T(1) - t) + c * t;
  result.slopes[axis] = c.value - b.value;
  return result;
}

/// The interpolant at a place that counts in samples from the first, within the box.
template <class T>
GridJet<T> interpolated(const GridSamples& samples, const Vector<T>& place) {
  std::ptrdiff_t cell[3];
  T t[3];
  for (int axis = 0; axis < 3; ++axis) {
    const auto last_cell = static_cast<std::ptrdiff_t>(samples.size[static_cast<std::size_t>(axis)]) - 2;
    cell[axis] = place[axis] > T(0) ? std::min(static_cast<std::ptrdiff_t>(place[axis]), last_cell) : 0;
    t[axis] = place[axis] - static_cast<T>(cell[axis]);
  }
  const auto sample = [&](std::ptrdiff_t i, std::ptrdiff_t j, std::ptrdiff_t k) {
    return GridJet<T>{static_cast<T>(sample_at<double>(samples, cell[0] + i, cell[1] + j, cell[2] + k)), Vector<T>(0)};
  };
  const auto joined = [&](const auto& at, int axis) {
    if (samples.interpolation == Interpolation::kLinear) return between(at(0), at(1), t[axis], axis);
    return between(at(-1), at(0), at(1), at(2), t[axis], axis);
  };
  const auto row = [&](std::ptrdiff_t i, std::ptrdiff_t j) {
    return joined([&](std::ptrdiff_t k) { return sample(i, j, k); }, 2);
  };
  const auto layer = [&](std::ptrdiff_t i) { return joined([&](std::ptrdiff_t j) { return row(i, j); }, 1); };
  return joined(layer, 0);
}

/// A kGrid: the interpolant at the point of the box that is nearest to p, and the box, whose distances are at right angles
/// to all that changes there.
template <class T>
Jet<T> grid(const Node& node, const Vector<T>& p) {
  const Vector<T> lo = vector_parameter<T>(node, 6);
  const Vector<T> hi = vector_parameter<T>(node, 9);
  const Vector<T> cells = vector_parameter<T>(node, 0) - T(1);
  const Vector<T> nearest = glm::clamp(p, lo, hi);
  const GridJet<T> own = interpolated(samples_of(node), (nearest - lo) / (hi - lo) * cells);
  const Vector<T> slopes = own.slopes * cells / (hi - lo);
  const T steepness = static_cast<T>(node.parameter(5));
  const T outside = steepness * glm::length(p - nearest);
  if (outside > T(0)) {
    const T value = glm::max(own.value, T(0));
    const T distance = glm::length(Vector2<T>(outside, value));
    Vector<T> gradient = direction_of(p - nearest) * (steepness * outside);
    for (int axis = 0; axis < 3; ++axis) {
      if (p[axis] == nearest[axis]) gradient[axis] += value * slopes[axis];
    }
    return {distance, distance > T(0) ? gradient / distance : Vector<T>(0)};
  }
  const Vector<T> depths[2] = {p - lo, hi - p};
  Jet<T> jet{own.value, slopes};
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      if (-steepness * depths[side][axis] < jet.value) continue;
      jet = {-steepness * depths[side][axis], Vector<T>(0)};
      jet.gradient[axis] = side == 0 ? -steepness : steepness;
    }
  }
  return jet;
}

}  // namespace octomarch::reference
