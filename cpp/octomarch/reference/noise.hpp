// Gradient noise: K. Perlin, "Improving noise", SIGGRAPH 2002, over a lattice that is hashed by arithmetic on whole
// numbers (S. Gustavson and I. McEwan, "Efficient computational noise in GLSL", 2012). Expressions ask for it.
#pragma once

#include <cmath>

#include "octomarch/reference/jet.hpp"

namespace octomarch::reference {

/// x less the largest multiple of `n` that leaves it ≥ 0, for whole numbers x.
template <class T>
T residue(T x, T n) {
  return x - n * std::floor((x + T(0.5)) * (T(1) / n));
}

/// A permutation polynomial of the numbers 0 … 288.
template <class T>
T permute(T a) {
  const T b = residue(a, T(289));
  return residue((T(34) * b + T(1)) * b, T(289));
}

/// The slope of the noise at a corner of the lattice: towards the middle of one of a cube's twelve edges.
template <class T>
Vector<T> lattice_slope(const Vector<T>& corner, T seed) {
  const auto reduced = [](T x) { return residue(x, T(289)); };
  const T inner = permute(permute(reduced(corner.z) + reduced(seed)) + reduced(corner.y));
  const T edge = residue(permute(inner + reduced(corner.x)), T(12));
  if (!(edge >= T(0) && edge < T(12))) return Vector<T>(0);  // beyond the whole numbers that T can tell apart
  const int index = static_cast<int>(edge);
  const T first = (index & 2) == 0 ? T(1) : T(-1);
  const T second = (index & 1) == 0 ? T(1) : T(-1);
  switch (index / 4) {
    case 0: return {first, second, T(0)};
    case 1: return {first, T(0), second};
    default: return {T(0), first, second};
  }
}

/// Noise in about −1 … 1 that is 0 with a slope at each lattice point; two continuous derivatives.
template <class T>
Jet<T> gradient_noise(const Vector<T>& p, T seed) {
  const Vector<T> cell = glm::floor(p);
  const Vector<T> t = p - cell;
  const Vector<T> fade = t * t * t * (t * (t * T(6) - T(15)) + T(10));
  const Vector<T> steepness = t * t * (t * (t * T(30) - T(60)) + T(30));
  Jet<T> noise;
  for (int corner = 0; corner < 8; ++corner) {
    const Vector<T> offset(T(corner & 1), T((corner >> 1) & 1), T((corner >> 2) & 1));
    const Vector<T> slope = lattice_slope(cell + offset, seed);
    const T height = glm::dot(slope, t - offset);
    const Vector<T> share = glm::mix(T(1) - fade, fade, offset);
    const Vector<T> change = steepness * (offset * T(2) - T(1));  // of share
    const T weight = share.x * share.y * share.z;
    noise.value += weight * height;
    noise.gradient += slope * weight;
    noise.gradient +=
        Vector<T>(change.x * share.y * share.z, share.x * change.y * share.z, share.x * share.y * change.z) * height;
  }
  return noise;
}

}  // namespace octomarch::reference
