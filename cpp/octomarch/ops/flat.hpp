// Flat primitives, over two coordinates: a rectangle, and polygons edge by edge. Cones are turned polygons.
#pragma once

#include "octomarch/ops/csg.hpp"
#include "octomarch/ops/number.hpp"

namespace octomarch::ops {

/// Constants: half edges (2).
template <class C>
struct Rectangle {
  C hx, hy, zero;
  template <class Real>
  explicit Rectangle(const Real* p) : hx(p[0]), hy(p[1]), zero(Real(0)) {}

  template <class T>
  T operator()(const T& x, const T& y) const {
    return box_distance(abs(x) - hx, abs(y) - hy, zero);
  }
};

/// Signed distance as one edge of a polygon sees it: beside the edge the distance along its outward normal, beyond an end
/// the distance to that corner, positive where the corner is convex: who is nearest to a convex corner is outside, to a
/// reflex one inside. Where this edge is the nearest the result is that of the polygon. Constants: a (2), b (2),
/// (b − a)/‖b − a‖² (2), outward unit normal (2), sign of corner a, of corner b.
template <class C>
struct PolygonEdge {
  C ax, ay, bx, by, ux, uy, nx, ny, sign_a, sign_b, zero, one;
  template <class Real>
  explicit PolygonEdge(const Real* p)
      : ax(p[0]),
        ay(p[1]),
        bx(p[2]),
        by(p[3]),
        ux(p[4]),
        uy(p[5]),
        nx(p[6]),
        ny(p[7]),
        sign_a(p[8]),
        sign_b(p[9]),
        zero(Real(0)),
        one(Real(1)) {}

  template <class T>
  T operator()(const T& x, const T& y) const {
    const T px = x - ax;
    const T py = y - ay;
    const C along = value_of(px) * ux + value_of(py) * uy;
    const auto before = along < zero;
    const auto beyond = along > one;
    const T corner = length(select(beyond, x - bx, px), select(beyond, y - by, py)) * select(beyond, sign_b, sign_a);
    return select(before | beyond, corner, px * nx + py * ny);
  }
};

/// Of two edges' distances the nearer; of equally near ones the outer, so that what has no area has no inside.
template <class T>
T nearer_edge(const T& a, const T& b) {
  const auto nearer = abs(value_of(b)) < abs(value_of(a));
  const auto outer = (abs(value_of(b)) == abs(value_of(a))) & (value_of(b) > value_of(a));
  return select(nearer | outer, b, a);
}

template <class C>
struct NearerEdge : NoConstants {
  using NoConstants::NoConstants;
  template <class T>
  T operator()(const T& a, const T& b) const {
    return nearer_edge(a, b);
  }
};

/// Cone about the second coordinate: a polygon's three edges in (radius, height). Constants: those of three PolygonEdges.
template <class C>
struct CappedCone {
  PolygonEdge<C> bottom, side, top;
  template <class Real>
  explicit CappedCone(const Real* p) : bottom(p), side(p + 10), top(p + 20) {}

  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    const T radius = length(x, z);
    return nearer_edge(nearer_edge(side(radius, y), bottom(radius, y)), top(radius, y));
  }
};

}  // namespace octomarch::ops
