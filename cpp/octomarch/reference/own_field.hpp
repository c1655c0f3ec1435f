// Primitives that the user describes by an expression: fields cut to a box, and solids without distances. Expressions and
// primitives come before it; the evaluator calls it at the leaves of the node graph.
#pragma once

#include <algorithm>
#include <limits>

#include "octomarch/reference/expression.hpp"
#include "octomarch/reference/primitives.hpp"
#include "octomarch/reference/sample.hpp"

namespace octomarch::reference {

/// Distance of every point of a solid from its surface, which nobody knows: the smallest normal float.
template <class T>
constexpr T kSolidDistance = T(std::numeric_limits<float>::min());

template <class T>
Sample<T> solid_sample(Expression<T>& truth, const Vector<T>& p) {
  return {truth.at(p).value != T(0) ? -kSolidDistance<T> : kSolidDistance<T>};
}

/// A kField: the expression at the point of the box that is nearest to p, and cut to the box, on those axes that have bounds.
/// The box's distance is taken as many times as the field's slope may exceed 1.
template <class T>
Sample<T> field_sample(const Node& node, Expression<T>& expression, const Vector<T>& p) {
  const Vector<T> lo = vector_parameter<T>(node, 1);
  const Vector<T> hi = vector_parameter<T>(node, 4);
  const Jet<T> own = expression.at(glm::clamp(p, lo, hi));
  Sample<T> sample{own.value, own.gradient};
  Vector<T> excess;
  Vector<T> slopes;
  for (int axis = 0; axis < 3; ++axis) {
    if (p[axis] < lo[axis] || p[axis] > hi[axis]) sample.gradient[axis] = T(0);
    const bool upper = p[axis] - hi[axis] >= lo[axis] - p[axis];
    excess[axis] = upper ? p[axis] - hi[axis] : lo[axis] - p[axis];
    slopes[axis] = upper ? T(1) : T(-1);
  }
  const T steepness = std::max(T(node.parameter(0)), T(1));
  cut(sample, {steepness * box_distance(excess), steepness * slopes * box_gradient(excess)});
  return sample;
}

}  // namespace octomarch::reference
