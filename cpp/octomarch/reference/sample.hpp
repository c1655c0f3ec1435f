// What a shape says about a point, and how operators over distances combine it: values with gradients, and what surfaces
// are made of. Jets come before it; the evaluator's walk folds samples.
#pragma once

#include <array>
#include <cmath>

#include "octomarch/graph/scene.hpp"
#include "octomarch/reference/jet.hpp"

namespace octomarch::reference {

inline constexpr int kUnpainted = -1;

/// Numbers for a material's slots.
template <class T>
using Slots = std::array<T, Material::kSlots>;

/// The gradient is zero unless asked for, and so are the slots. The material is that of the primitive that gave the value,
/// as an index, or kUnpainted while no paint has been met.
template <class T>
struct Sample {
  T value = T(0);
  Vector<T> gradient = Vector<T>(0);
  int material = kUnpainted;
  Slots<T> painted = {};  ///< weighted by the share of what is painted
  T unpainted = T(1);     ///< the share that waits for a paint
};

template <class T>
Sample<T> negated(Sample<T> sample) {
  sample.value = -sample.value;
  sample.gradient = -sample.gradient;
  return sample;
}

/// Both samples' paint, `share` of it b's.
template <class T>
void mix_paint(Sample<T>& result, const Sample<T>& a, const Sample<T>& b, T share) {
  const auto mixed = [share](T of_a, T of_b) {
    return share == T(0) ? of_a : share == T(1) ? of_b : glm::mix(of_a, of_b, share);
  };
  for (std::size_t i = 0; i < Material::kSlots; ++i) result.painted[i] = mixed(a.painted[i], b.painted[i]);
  result.unpainted = mixed(a.unpainted, b.unpainted);
}

/// min(a, b), and what belongs to it. Of equal operands the second counts, unless only the first has a gradient.
template <class T>
Sample<T> hard_minimum(const Sample<T>& a, const Sample<T>& b) {
  Sample<T> result = a.value < b.value ? a : b;
  if (a.value == b.value && b.gradient == Vector<T>(0)) result.gradient = a.gradient;
  return result;
}

/// min(a, b) − max(k − |a − b|, 0)²/(4k), with its gradient; paint is mixed as gradients are. The material is that of the
/// smaller.
template <class T>
Sample<T> minimum(const Sample<T>& a, const Sample<T>& b, T k) {
  Sample<T> result = hard_minimum(a, b);
  const T overlap = k - std::abs(a.value - b.value);
  if (!(overlap > T(0))) return result;
  const T of_larger = overlap / (T(2) * k);
  const T share = a.value < b.value ? of_larger : T(1) - of_larger;  // of b
  result.value -= overlap / (T(4) * k) * overlap;
  result.gradient = glm::mix(a.gradient, b.gradient, share);
  mix_paint(result, a, b, share);
  return result;
}

/// m − k·log1p(exp(−|a − b|/k)), m = min(a, b), with its gradient and the paint mixed alike.
template <class T>
Sample<T> exponential_minimum(const Sample<T>& a, const Sample<T>& b, T k) {
  Sample<T> result = hard_minimum(a, b);
  const T ahead = a.value == b.value ? T(0) : b.value - a.value;  // equal infinities have no difference
  const T share = T(1) / (T(1) + std::exp(ahead / k));            // of b
  result.value -= k * std::log1p(std::exp(-std::abs(ahead) / k));
  result.gradient = glm::mix(a.gradient, b.gradient, share);
  mix_paint(result, a, b, share);
  return result;
}

/// Cuts `sample` to the inside of a wall, max(wall, sample), which changes nothing of what the surface is made of. Of equal
/// ones the wall counts where only it has a gradient; a NaN is kept.
template <class T>
void cut(Sample<T>& sample, const Jet<T>& wall) {
  const bool tie = wall.value == sample.value && sample.gradient == Vector<T>(0);
  if (wall.value > sample.value || tie) {
    sample.value = wall.value;
    sample.gradient = wall.gradient;
  }
}

}  // namespace octomarch::reference
