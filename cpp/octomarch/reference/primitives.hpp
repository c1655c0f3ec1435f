// Closed forms of the primitives' distances and of their gradients, in scalar GLM. Flat shapes and polyhedra come before
// it; the evaluator calls them at the leaves of the node graph. Written apart from the kernels' operators, so that the two
// can disagree.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>

#include "octomarch/graph/node.hpp"
#include "octomarch/reference/domain.hpp"
#include "octomarch/reference/flat.hpp"
#include "octomarch/reference/grid.hpp"
#include "octomarch/reference/polyhedra.hpp"

namespace octomarch::reference {

/// A point relative to a coordinate axis: how far from it, how far along it, and the unit vectors of both.
template <class T>
struct AxialPoint {
  T radial;
  T axial;
  Vector<T> outward;
  Vector<T> along;

  AxialPoint(const Vector<T>& p, double axis_number) {
    const auto axis = static_cast<int>(axis_number);
    Vector<T> across = p;
    across[axis] = T(0);
    radial = glm::length(across);
    axial = p[axis];
    outward = direction_of(across);
    along = Vector<T>(0);
    along[axis] = T(1);
  }
};

template <class T>
T largest(const Vector<T>& q) {
  return glm::max(q.x, glm::max(q.y, q.z));
}

/// Gradient of `largest`: the last of equal components counts, since the axis of a cylinder comes after its radius, which
/// has no direction on the axis.
template <class T>
Vector<T> largest_gradient(const Vector<T>& q) {
  if (q.z >= q.x && q.z >= q.y) return {T(0), T(0), T(1)};
  if (q.y >= q.x) return {T(0), T(1), T(0)};
  return {T(1), T(0), T(0)};
}

/// Exact distance to a box from q = |p| − half size.
template <class T>
T box_distance(const Vector<T>& q) {
  return glm::length(glm::max(q, T(0))) + glm::min(largest(q), T(0));
}

/// Gradient of box_distance with respect to q. Inside and on the faces it is that of the largest component.
template <class T>
Vector<T> box_gradient(const Vector<T>& q) {
  const Vector<T> outside = glm::max(q, T(0));
  return outside == Vector<T>(0) ? largest_gradient(q) : direction_of(outside);
}

/// A rectangle is a box that is endless along z.
template <class T>
Vector<T> rectangle_sides(const Node& node, const Vector<T>& p) {
  return {std::abs(p.x) - T(node.parameter(0)), std::abs(p.y) - T(node.parameter(1)),
          -std::numeric_limits<T>::infinity()};
}

/// A capped cylinder is a rectangle in (radial, axial): a box that is endless along its first axis.
template <class T>
Vector<T> cylinder_sides(const Node& node, const AxialPoint<T>& at) {
  return {-std::numeric_limits<T>::infinity(), at.radial - T(node.parameter(0)),
          std::abs(at.axial) - T(node.parameter(1))};
}

/// The point of a primitive's own coordinates from which its formulas count: a capsule's first end, a plane's nearest point.
inline Vec3 origin_of(const Node& node) {
  const Vec3 first = node.kind() == NodeKind::kCapsule || node.kind() == NodeKind::kPlane
                         ? Vec3{node.parameter(0), node.parameter(1), node.parameter(2)}
                         : Vec3{};
  return node.kind() == NodeKind::kPlane ? first * -node.parameter(3) : first;
}

/// From the nearest point of the segment a–b to a + p.
template <class T>
Vector<T> from_segment(const Node& node, const Vector<T>& p) {
  const auto length = [&node](std::size_t axis) { return T(node.parameter(3 + axis) - node.parameter(axis)); };
  const Vector<T> ab(length(0), length(1), length(2));
  const T squared = glm::dot(ab, ab);
  const T fraction = squared > 0 ? glm::clamp(glm::dot(p, ab) / squared, T(0), T(1)) : T(0);
  return p - ab * fraction;
}

/// A kCappedCone, about y.
template <class T>
Jet<T> capped_cone(const Node& node, const Vector<T>& p) {
  const AxialPoint<T> at(p, 1);
  const FlatJet<T> profile =
      cone_profile(Vector2<T>(at.radial, at.axial), T(node.parameter(0)), T(node.parameter(1)), T(node.parameter(2)));
  return {profile.value, at.outward * profile.gradient.x + at.along * profile.gradient.y};
}

/// Signed distance to a primitive from p, which counts from origin_of(node), scene units. Contract: `node` is a primitive.
template <class T>
T primitive_distance(const Node& node, const Vector<T>& p) {
  switch (node.kind()) {
    case NodeKind::kSphere: return glm::length(p) - T(node.parameter(0));
    case NodeKind::kBox: return box_distance(glm::abs(p) - vector_parameter<T>(node, 0));
    case NodeKind::kBoxExterior: return glm::length(glm::max(glm::abs(p) - vector_parameter<T>(node, 0), T(0)));
    case NodeKind::kBoxMaximum: return largest(glm::abs(p) - vector_parameter<T>(node, 0));
    case NodeKind::kRectangle: return box_distance(rectangle_sides(node, p));
    case NodeKind::kPolygon: return polygon(node, Vector2<T>(p.x, p.y)).value;
    case NodeKind::kGrid: return grid(node, p).value;
    case NodeKind::kCappedCone: return capped_cone(node, p).value;
    case NodeKind::kOctahedron: return octahedron(p, T(node.parameter(0))).value;
    case NodeKind::kPyramid: return pyramid(p, T(node.parameter(0)), T(node.parameter(1))).value;
    case NodeKind::kPlane: return glm::dot(vector_parameter<T>(node, 0), p);
    case NodeKind::kCylinder: return AxialPoint<T>(p, node.parameter(1)).radial - T(node.parameter(0));
    case NodeKind::kCappedCylinder: return box_distance(cylinder_sides(node, AxialPoint<T>(p, node.parameter(2))));
    case NodeKind::kTorus: {
      const AxialPoint<T> at(p, node.parameter(2));
      return glm::length(Vector2<T>(at.radial - T(node.parameter(0)), at.axial)) - T(node.parameter(1));
    }
    case NodeKind::kCapsule: return glm::length(from_segment(node, p)) - T(node.parameter(6));
    default: return std::numeric_limits<T>::quiet_NaN();
  }
}

/// Gradient of primitive_distance: a unit vector, or zero where no direction is nearest (a centre, an axis).
template <class T>
Vector<T> primitive_gradient(const Node& node, const Vector<T>& p) {
  switch (node.kind()) {
    case NodeKind::kSphere: return direction_of(p);
    case NodeKind::kBox: return slopes_of_abs(p) * box_gradient(glm::abs(p) - vector_parameter<T>(node, 0));
    case NodeKind::kBoxExterior: {
      const Vector<T> q = glm::abs(p) - vector_parameter<T>(node, 0);
      return largest(q) < T(0) ? Vector<T>(0) : slopes_of_abs(p) * box_gradient(q);
    }
    case NodeKind::kBoxMaximum: return slopes_of_abs(p) * largest_gradient(glm::abs(p) - vector_parameter<T>(node, 0));
    case NodeKind::kRectangle: return slopes_of_abs(p) * box_gradient(rectangle_sides(node, p));
    case NodeKind::kPolygon: return Vector<T>(polygon(node, Vector2<T>(p.x, p.y)).gradient, T(0));
    case NodeKind::kGrid: return grid(node, p).gradient;
    case NodeKind::kCappedCone: return capped_cone(node, p).gradient;
    case NodeKind::kOctahedron: return octahedron(p, T(node.parameter(0))).gradient;
    case NodeKind::kPyramid: return pyramid(p, T(node.parameter(0)), T(node.parameter(1))).gradient;
    case NodeKind::kPlane: return vector_parameter<T>(node, 0);
    case NodeKind::kCylinder: return AxialPoint<T>(p, node.parameter(1)).outward;
    case NodeKind::kCappedCylinder: {
      const AxialPoint<T> at(p, node.parameter(2));
      const Vector<T> sides = box_gradient(cylinder_sides(node, at));
      return at.outward * sides.y + at.along * (sides.z * slope_of_abs(at.axial));
    }
    case NodeKind::kTorus: {
      const AxialPoint<T> at(p, node.parameter(2));
      const Vector2<T> ring = direction_of(Vector2<T>(at.radial - T(node.parameter(0)), at.axial));
      return at.outward * ring.x + at.along * ring.y;
    }
    case NodeKind::kCapsule: return direction_of(from_segment(node, p));
    default: return Vector<T>(0);
  }
}

}  // namespace octomarch::reference
