// Solids bounded by planes: distance and gradient from the nearest point of a face, or from the planes inside. Nearest
// points come before it; primitives.hpp lists what is here.
#pragma once

#include "octomarch/reference/jet.hpp"
#include "octomarch/reference/nearest.hpp"

namespace octomarch::reference {

/// A plane at a point: signed distance and unit normal, which is zero for a face without area.
template <class T>
Jet<T> plane_through(const Vector<T>& p, const Vector<T>& corner, const Vector<T>& normal) {
  const Vector<T> unit = direction_of(normal);
  return {glm::dot(p - corner, unit), unit};
}

/// A convex solid from all its planes and the point of its surface that is nearest to p. On the surface the gradient is that
/// of a face.
template <class T, std::size_t count>
Jet<T> convex(const Vector<T>& p, const Jet<T> (&planes)[count], const Vector<T>& nearest) {
  Jet<T> highest = planes[0];
  bool is_thick = true;
  for (const Jet<T>& plane : planes) {
    if (plane.gradient == Vector<T>(0)) is_thick = false;
    if (plane.value > highest.value || highest.gradient == Vector<T>(0)) highest = plane;
  }
  if (is_thick && highest.value < T(0)) return highest;
  return {glm::length(p - nearest), direction_from(nearest, p, highest.gradient)};
}

template <class T>
Vector<T> slopes_of_abs(const Vector<T>& p) {
  return {slope_of_abs(p.x), slope_of_abs(p.y), slope_of_abs(p.z)};
}

/// |x| + |y| + |z| ≤ radius, by its face in the first octant.
template <class T>
Jet<T> octahedron(const Vector<T>& p, T radius) {
  const Vector<T> folded = glm::abs(p);
  const Vector<T> x(radius, T(0), T(0));
  const Vector<T> y(T(0), radius, T(0));
  const Vector<T> z(T(0), T(0), radius);
  const Jet<T> face[] = {plane_through(folded, x, Vector<T>(1))};
  const Jet<T> result = convex(folded, face, nearest_of_triangle(folded, x, y, z));
  return {result.value, result.gradient * slopes_of_abs(p)};
}

/// Square base of half edge e at y = −h, apex at y = h, by the quarter where x and z are ≥ 0.
template <class T>
Jet<T> pyramid(const Vector<T>& p, T e, T h) {
  const Vector<T> folded(std::abs(p.x), p.y, std::abs(p.z));
  const Vector<T> apex(T(0), h, T(0));
  const Vector<T> corner(e, -h, e);
  const Jet<T> planes[] = {plane_through(folded, corner, Vector<T>(T(2) * h, e, T(0))),
                           plane_through(folded, corner, Vector<T>(T(0), e, T(2) * h)),
                           plane_through(folded, corner, Vector<T>(T(0), T(-1), T(0)))};
  const Vector<T> candidates[] = {nearest_of_triangle(folded, apex, Vector<T>(e, -h, T(0)), corner),
                                  nearest_of_triangle(folded, apex, corner, Vector<T>(T(0), -h, e)),
                                  Vector<T>(glm::min(folded.x, e), -h, glm::min(folded.z, e))};
  const Jet<T> result = convex(folded, planes, nearest_of(folded, candidates));
  const Vector<T> slopes = slopes_of_abs(p);
  return {result.value, result.gradient * Vector<T>(slopes.x, T(1), slopes.z)};
}

}  // namespace octomarch::reference
