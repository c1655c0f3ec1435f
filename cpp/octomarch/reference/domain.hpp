// Operators over points: where they look at their child, and how its gradient turns into theirs, by the transposed Jacobian.
// Twists and bends come before it; the evaluator goes down through the one and up through the other.
#pragma once

#include <cmath>
#include <cstddef>

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "octomarch/graph/node.hpp"
#include "octomarch/reference/jet.hpp"
#include "octomarch/reference/nearest.hpp"
#include "octomarch/reference/turn.hpp"

namespace octomarch::reference {

/// Parameters first, first + 1 and first + 2 of a node.
template <class T>
Vector<T> vector_parameter(const Node& node, std::size_t first) {
  return {T(node.parameter(first)), T(node.parameter(first + 1)), T(node.parameter(first + 2))};
}

/// The rotation of a kRotate node, parent from child.
template <class T>
glm::mat<3, 3, T> rotation(const Node& node) {
  glm::mat<3, 3, T> parent_from_child;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      parent_from_child[column][row] = T(node.parameter(static_cast<std::size_t>(3 * row + column)));
    }
  }
  return parent_from_child;
}

/// Where something is evaluated: at p + shift. Translations gather in the shift, in double, until numbers are small.
template <class T>
struct Spot {
  Vector<T> p;
  Vec3 shift;

  Vector<T> point() const { return from({}); }
  /// The same as seen from `origin`.
  Vector<T> from(const Vec3& origin) const {
    const Vec3 whole = shift - origin;
    return whole == Vec3{} ? p : p + vector<T>(whole);
  }
};

/// Copies of a kRepeat's child that are looked at: the nearest cell and its neighbours on the side of p, per axis.
inline std::size_t copies(const Node& repeat) {
  std::size_t count = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) count *= repeat.parameter(axis) > 0.0 ? 2 : 1;
  return count;
}

/// Centre of the copy number `copy`: of its bits, one per repeated axis, those that are set choose the neighbour. The
/// nearest copy of a shape that fills more than half its cell on one side can be the neighbour's.
template <class T>
Vector<T> copy_centre(const Node& repeat, const Vector<T>& p, std::size_t copy) {
  Vector<T> centre(0);
  for (int axis = 0; axis < 3; ++axis) {
    const RepeatAxis constants = repeat_axis(repeat, static_cast<std::size_t>(axis));
    if (constants.period == 0.0) continue;
    const T period = T(constants.period);
    const T shift = T(constants.shift);
    const T limit = T(constants.limit);
    T cell = glm::clamp(std::floor(p[axis] / period + shift) + T(0.5) - shift, -limit, limit);
    if ((copy & 1U) != 0) {
      const T side = p[axis] - cell * period < T(0) ? T(-1) : T(1);
      cell = glm::clamp(cell + side, -limit, limit);
    }
    centre[axis] = cell * period;
    copy >>= 1U;
  }
  return centre;
}

/// From the axis of a kRevolve: the unit vector towards p in the plane of x and z, zero on the axis.
template <class T>
Vector<T> outward_from_y(const Vector<T>& p) {
  return direction_of(Vector<T>(p.x, T(0), p.z));
}

/// 1 for the coordinates that a kElongate passes on, 0 for those that it holds between the drawn-out halves.
template <class T>
Vector<T> passed_on(const Node& elongate, const Vector<T>& p) {
  const Vector<T> half = vector_parameter<T>(elongate, 0);
  Vector<T> result;
  for (int axis = 0; axis < 3; ++axis) result[axis] = std::abs(p[axis]) < half[axis] ? T(0) : T(1);
  return result;
}

/// Where visit number `visit` of a node that bends space evaluates its child.
template <class T>
Vector<T> child_point(const Node& node, const Vector<T>& p, std::size_t visit) {
  switch (node.kind()) {
    case NodeKind::kRepeat: return p - copy_centre(node, p, visit);
    case NodeKind::kElongate: {
      const Vector<T> half = vector_parameter<T>(node, 0);
      return p - glm::clamp(p, -half, half);
    }
    case NodeKind::kMirror: {
      const auto axis = static_cast<int>(node.parameter(0));
      Vector<T> folded = p;
      folded[axis] = std::abs(p[axis]);
      return folded;
    }
    case NodeKind::kTwist:
    case NodeKind::kBend: return Turn<T>(node, p).point();
    case NodeKind::kExtrude: return {p.x, p.y, T(0)};
    case NodeKind::kRevolve: return {glm::length(Vector2<T>(p.x, p.z)) - T(node.parameter(0)), p.y, T(0)};
    default: return p;
  }
}

/// Where visit number `visit` of `node` evaluates its child.
template <class T>
Spot<T> child_spot(const Node& node, const Spot<T>& at, std::size_t visit) {
  const auto parameter = [&node](std::size_t i) { return node.parameter(i); };
  const Vec3& s = at.shift;
  switch (node.kind()) {
    case NodeKind::kTranslate: return {at.p, s - Vec3{parameter(0), parameter(1), parameter(2)}};
    case NodeKind::kRotate: {
      const auto column = [&](std::size_t i) { return Vec3{parameter(i), parameter(3 + i), parameter(6 + i)}; };
      return {glm::transpose(rotation<T>(node)) * at.p, {dot(column(0), s), dot(column(1), s), dot(column(2), s)}};
    }
    case NodeKind::kScale:
      return {at.p / T(parameter(0)), {s.x / parameter(0), s.y / parameter(0), s.z / parameter(0)}};
    case NodeKind::kStretch:
      return {at.p / vector_parameter<T>(node, 0), {s.x / parameter(0), s.y / parameter(1), s.z / parameter(2)}};
    case NodeKind::kRepeat: {
      const auto near = [&](std::size_t axis, double middle) {
        return nearest_middle(repeat_axis(node, axis), middle);
      };
      const Spot<T> moved{at.p, {near(0, s.x), near(1, s.y), near(2, s.z)}};
      return {child_point(node, moved.point(), visit), {}};
    }
    case NodeKind::kElongate:
    case NodeKind::kMirror:
    case NodeKind::kTwist:
    case NodeKind::kBend:
    case NodeKind::kExtrude:
    case NodeKind::kRevolve: return {child_point(node, at.point(), visit), {}};
    default: return at;
  }
}

/// What the child's distances are multiplied by so that they stay bounds.
template <class T>
T scale_of(const Node& node) {
  switch (node.kind()) {
    case NodeKind::kScale: return T(node.parameter(0));
    case NodeKind::kStretch: {
      const Vector<T> factors = vector_parameter<T>(node, 0);
      return glm::min(factors.x, glm::min(factors.y, factors.z));
    }
    default: return T(1);
  }
}

/// The gradient of scale_of(node)·child at its own point, from the child's.
template <class T>
Vector<T> parent_gradient(const Node& node, const Vector<T>& p, const Vector<T>& child) {
  switch (node.kind()) {
    case NodeKind::kRotate: return rotation<T>(node) * child;
    case NodeKind::kStretch: return child * (scale_of<T>(node) / vector_parameter<T>(node, 0));
    case NodeKind::kElongate: return child * passed_on(node, p);
    case NodeKind::kMirror: {
      const auto axis = static_cast<int>(node.parameter(0));
      Vector<T> unfolded = child;
      unfolded[axis] *= slope_of_abs(p[axis]);
      return unfolded;
    }
    case NodeKind::kTwist:
    case NodeKind::kBend: return Turn<T>(node, p).gradient(child);
    case NodeKind::kExtrude: return {child.x, child.y, T(0)};
    case NodeKind::kRevolve: return outward_from_y(p) * child.x + Vector<T>(T(0), child.y, T(0));
    default: return child;
  }
}

/// A surface's unit normal at p as the child's coordinates have it: along the gradient there that parent_gradient() makes
/// this normal of.
template <class T>
Vector<T> child_normal(const Node& node, const Vector<T>& p, const Vector<T>& normal) {
  switch (node.kind()) {
    case NodeKind::kRotate: return glm::transpose(rotation<T>(node)) * normal;
    case NodeKind::kStretch: return direction_of(normal * vector_parameter<T>(node, 0));
    case NodeKind::kMirror: return parent_gradient(node, p, normal);
    case NodeKind::kTwist:
    case NodeKind::kBend: return Turn<T>(node, p).child_direction(normal);
    case NodeKind::kRevolve: {
      const Vector<T> outward = outward_from_y(p);
      return {glm::dot(normal, outward), normal.y, normal.z * outward.x - normal.x * outward.z};
    }
    default: return normal;
  }
}

}  // namespace octomarch::reference
