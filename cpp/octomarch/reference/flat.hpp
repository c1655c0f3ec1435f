// Shapes in a plane: polygons, and the profiles of solids of revolution. Nearest points come before it; primitives.hpp
// lists what is here.
#pragma once

#include "octomarch/graph/node.hpp"
#include "octomarch/reference/nearest.hpp"

namespace octomarch::reference {

/// Signed distance and gradient in a plane.
template <class T>
struct FlatJet {
  T value;
  Vector2<T> gradient;
};

/// To the right of a–b, which is out of a polygon that goes counterclockwise.
template <class T>
Vector2<T> right_of(const Vector2<T>& a, const Vector2<T>& b) {
  return direction_of(Vector2<T>(b.y - a.y, a.x - b.x));
}

/// Exact distance to a kPolygon. Inside is what an odd number of edges separates from afar.
template <class T>
FlatJet<T> polygon(const Node& node, const Vector2<T>& p) {
  const std::size_t count = node.parameters().size() / 2;
  const auto corner = [&](std::size_t i) {
    return Vector2<T>(T(node.parameter(2 * (i % count))), T(node.parameter(2 * (i % count) + 1)));
  };
  Vector2<T> offset = p - corner(0);  // from the nearest point so far
  Vector2<T> side(0);                 // of the edge that has it
  T area = T(0);
  bool inside = false;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector2<T> a = corner(i);
    const Vector2<T> b = corner(i + 1);
    const Vector2<T> candidate = p - nearest_of_segment(p, a, b);
    if (glm::length(candidate) < glm::length(offset) || side == Vector2<T>(0)) {
      offset = candidate;
      side = right_of(a, b);
    }
    const T left = (b.x - a.x) * (p.y - a.y) - (p.x - a.x) * (b.y - a.y);  // > 0: p lies left of a–b
    if ((a.y <= p.y) != (b.y <= p.y) && (left > T(0)) == (b.y > a.y)) inside = !inside;
    const Vector2<T> from_first = a - corner(0);
    area += from_first.x * (b.y - a.y) - from_first.y * (b.x - a.x);
  }
  const T sign = inside ? T(-1) : T(1);
  const Vector2<T> outward = area < T(0) ? -side : side;
  return {sign * glm::length(offset), direction_from(p - offset, p, outward * sign) * sign};
}

/// Exact distance to the profile of a capped cone at p = (distance from the axis, height): corners (bottom, −h), (top, h).
template <class T>
FlatJet<T> cone_profile(const Vector2<T>& p, T bottom, T top, T h) {
  const Vector2<T> low(bottom, -h);
  const Vector2<T> high(top, h);
  const Vector2<T> side = right_of(low, high);
  const T cap = std::abs(p.y) - h;
  const T slant = glm::dot(p - low, side);
  const bool by_cap = cap >= slant || side == Vector2<T>(0);
  const Vector2<T> outward = by_cap ? Vector2<T>(T(0), slope_of_abs(p.y)) : side;
  if (cap < T(0) && slant < T(0)) return {by_cap ? cap : slant, outward};
  const Vector2<T> candidates[] = {nearest_of_segment(p, low, high), Vector2<T>(glm::min(p.x, bottom), -h),
                                   Vector2<T>(glm::min(p.x, top), h)};
  const Vector2<T> nearest = nearest_of(p, candidates);
  return {glm::length(p - nearest), direction_from(nearest, p, outward)};
}

}  // namespace octomarch::reference
