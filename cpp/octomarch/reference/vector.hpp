// The vectors of the reference: GLM's, in float or double, and the way from and to the plain types around it.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "octomarch/base/types.hpp"

namespace octomarch::reference {

template <class T>
using Vector = glm::vec<3, T, glm::defaultp>;
template <class T>
using Vector2 = glm::vec<2, T, glm::defaultp>;

template <class T>
Vector<T> vector(const Vec3& v) {
  return {T(v.x), T(v.y), T(v.z)};
}

/// Unit vector along v, scaled first lest its square underflow; zero where v is zero, since a length has no gradient there.
template <glm::length_t dimension, class T>
glm::vec<dimension, T> direction_of(const glm::vec<dimension, T>& v) {
  T largest = T(0);
  for (glm::length_t i = 0; i < dimension; ++i) largest = glm::max(largest, std::abs(v[i]));
  return largest > T(0) ? glm::normalize(v / largest) : glm::vec<dimension, T>(0);
}

template <class T>
bool is_finite(const Vector<T>& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// What is known relative to `origin` in the world's numbers. Zeros keep their sign where they are the world's.
template <class T>
T from_far(double origin, T value) {
  return origin == 0.0 ? value : T(origin + static_cast<double>(value));
}

template <class T>
Vector<T> from_far(const Vec3& origin, const Vector<T>& v) {
  return {from_far(origin.x, v.x), from_far(origin.y, v.y), from_far(origin.z, v.z)};
}

/// Element i of an array, or none in an empty one: a result that nobody asked for.
template <class Value>
void store(std::span<Value> values, std::size_t i, Value value) {
  if (!values.empty()) values[i] = value;
}

/// Row i of an n × 3 array, or none in an empty one.
template <class T>
void store(std::span<T> values, std::size_t i, const Vector<T>& v) {
  if (values.empty()) return;
  values[3 * i] = v.x;
  values[3 * i + 1] = v.y;
  values[3 * i + 2] = v.z;
}

}  // namespace octomarch::reference
