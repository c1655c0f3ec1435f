// Nearest points of segments and triangles. Vectors come before it; primitives with corners are measured from them.
#pragma once

#include <limits>

#include "octomarch/reference/vector.hpp"

namespace octomarch::reference {

/// +1 from zero upwards, else −1: the derivative of |x|, with the side at 0 that has one.
template <class T>
T slope_of_abs(T x) {
  return x < T(0) ? T(-1) : T(1);
}

template <glm::length_t dimension, class T>
glm::vec<dimension, T> nearest_of_segment(const glm::vec<dimension, T>& p, const glm::vec<dimension, T>& a,
                                          const glm::vec<dimension, T>& b) {
  const glm::vec<dimension, T> ab = b - a;
  const T squared = glm::dot(ab, ab);
  return squared > T(0) ? a + ab * glm::clamp(glm::dot(p - a, ab) / squared, T(0), T(1)) : a;
}

/// Direction to p from the surface's point nearest to it; `otherwise` where that is no more than rounding.
template <glm::length_t dimension, class T>
glm::vec<dimension, T> direction_from(const glm::vec<dimension, T>& nearest, const glm::vec<dimension, T>& p,
                                      const glm::vec<dimension, T>& otherwise) {
  const glm::vec<dimension, T> offset = p - nearest;
  const T rounding = T(8) * std::numeric_limits<T>::epsilon() * glm::length(nearest);
  return glm::length(offset) > rounding ? direction_of(offset) : otherwise;
}

/// The first of `candidates` than which none is nearer to p.
template <glm::length_t dimension, class T, std::size_t count>
glm::vec<dimension, T> nearest_of(const glm::vec<dimension, T>& p, const glm::vec<dimension, T> (&candidates)[count]) {
  glm::vec<dimension, T> best = candidates[0];
  for (const auto& candidate : candidates) {
    if (glm::length(p - candidate) < glm::length(p - best)) best = candidate;
  }
  return best;
}

/// Triangles without area are their edges.
template <class T>
Vector<T> nearest_of_triangle(const Vector<T>& p, const Vector<T>& a, const Vector<T>& b, const Vector<T>& c) {
  const Vector<T> normal = direction_of(glm::cross(b - a, c - a));
  const auto beside = [&](const Vector<T>& from, const Vector<T>& to) {
    return glm::dot(glm::cross(to - from, p - from), normal) >= T(0);
  };
  if (normal != Vector<T>(0) && beside(a, b) && beside(b, c) && beside(c, a))
    return p - normal * glm::dot(p - a, normal);
  const Vector<T> edges[] = {nearest_of_segment(p, a, b), nearest_of_segment(p, b, c), nearest_of_segment(p, c, a)};
  return nearest_of(p, edges);
}

}  // namespace octomarch::reference
