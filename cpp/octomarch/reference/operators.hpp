// What operators make of their children's samples. Samples, solids and operators over points come before it; the
// evaluator's walk calls it on the way up.
#pragma once

#include <cmath>
#include <limits>

#include "octomarch/reference/domain.hpp"
#include "octomarch/reference/own_field.hpp"
#include "octomarch/reference/sample.hpp"

namespace octomarch::reference {

/// A solid's values say nothing of how far it is, so scales leave them.
template <class T>
T scaled(T value, T factor) {
  return std::abs(value) == kSolidDistance<T> ? value : value * factor;
}

/// The child of a kExtrude cut to its height, with the box's formula over (distance in the plane, excess along z).
template <class T>
void extrude(Sample<T>& sample, T half_height, T z) {
  const Vector<T> sides(-std::numeric_limits<T>::infinity(), sample.value, std::abs(z) - half_height);
  const Vector<T> weights = box_gradient(sides);
  sample.value = box_distance(sides);
  sample.gradient = along(weights.y, sample.gradient) + Vector<T>(T(0), T(0), weights.z * slope_of_abs(z));
}

/// The next operand taken into those so far; contract: `node` has several, or several copies of one.
template <class T>
Sample<T> folded(const Node& node, const Sample<T>& so_far, const Sample<T>& next) {
  const auto k = [&node] { return T(node.parameter(0)); };
  switch (node.kind()) {
    case NodeKind::kUnion: return minimum(so_far, next, k());
    case NodeKind::kIntersection: return negated(minimum(negated(so_far), negated(next), k()));
    case NodeKind::kDifference: return negated(minimum(negated(so_far), next, k()));
    case NodeKind::kMetaballs: return exponential_minimum(so_far, next, k());
    default: return minimum(so_far, next, T(0));  // copies of a kRepeat
  }
}

/// The sample of an operator over one shape from that of its child at its own point, all but paint and displacement.
template <class T>
Sample<T> from_child(const Node& node, const Vector<T>& p, Sample<T> sample) {
  switch (node.kind()) {
    case NodeKind::kComplement: return negated(sample);
    case NodeKind::kRound: sample.value -= T(node.parameter(0)); break;
    case NodeKind::kShell:
      if (sample.value < T(0)) sample = negated(sample);
      sample.value -= T(node.parameter(0));
      break;
    default:
      sample.value = scaled(sample.value, scale_of<T>(node));
      sample.gradient = parent_gradient(node, p, sample.gradient);
  }
  if (node.kind() == NodeKind::kExtrude) extrude(sample, T(node.parameter(0)), p.z);
  if (node.kind() == NodeKind::kTwist || node.kind() == NodeKind::kBend) cut(sample, Turn<T>(node, p).wall());
  return sample;
}

}  // namespace octomarch::reference
