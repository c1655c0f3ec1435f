// Flat primitives, over two coordinates: a rectangle, and polygons edge by edge. Cones are turned polygons.
#pragma once

#include <limits>

#include "octomarch/base/dual.hpp"
#include "octomarch/ops/csg.hpp"
#include "octomarch/ops/number.hpp"

namespace octomarch::ops {

/// Constants: half edges (2).
template <class C>
struct Rectangle {
  C hx, hy, zero;
  template <class Real>
  explicit Rectangle(const Real* p) : hx(p[0]), hy(p[1]), zero(Real(0)) {}

  auto operator()(const auto& x, const auto& y) const { return box_distance(abs(x) - hx, abs(y) - hy, zero); }
};

/// One edge more on the way round a polygon. Input and result are the distance to the nearest edge so far, < 0 where a ray
/// from the point to +x crosses an odd number of them: after all edges, inside. Parity has its sign right however thin
/// the polygon is, and where parts of the outline lie on one another (I. Quilez, "2D distance functions").
///
/// On an edge the distance is 0, whose sign would be lost: it counts as the least normal number, which Polygon takes off.
/// Derivatives are those of the distance beside an edge, which has a slope on it; beyond its ends they are those of the
/// distance to the corner. Constants: a (2), b (2), (b − a)/‖b − a‖² (2), outward unit normal (2), +1 or −1: does it rise?
template <class C>
struct PolygonEdge {
  C ax, ay, bx, by, ux, uy, nx, ny, rise, low, high, least, zero, half, one;
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
        rise(p[8]),
        low(min(ay, by)),
        high(max(ay, by)),
        least(std::numeric_limits<Number<Real>>::min()),
        zero(Real(0)),
        half(Real(0.5)),
        one(Real(1)) {}

  template <class T>
  T operator()(const T& x, const T& y, const T& nearest) const {
    // b, where it is nearer, so that the distance is exactly 0 at both ends
    const C along = (value_of(x) - ax) * ux + (value_of(y) - ay) * uy;
    const auto near_b = along > half;
    const T px = select(near_b, x - bx, x - ax);
    const T py = select(near_b, y - by, y - ay);
    const T beside = px * nx + py * ny;
    const T exact = select((along < zero) | (along > one), length(px, py), abs(beside));
    const T distance = select(value_of(exact) < least, exact + least, exact);

    const auto crossed = (low <= value_of(y)) & (value_of(y) < high) & (value_of(beside) * rise < zero);
    const T signed_distance = select(crossed, -distance, distance);
    const auto kept = abs(value_of(nearest)) <= value_of(distance);
    const C other = select(kept, value_of(signed_distance), value_of(nearest));
    const T nearer = select(kept, nearest, signed_distance);
    return select(other < zero, -nearer, nearer);
  }
};

/// What remains after the last edge: nothing of the least numbers, and on an edge the slope outward.
template <class T, class C>
T polygon_distance(const T& nearest, const C& least, const C& zero) {
  const T outward = select(value_of(nearest) < zero, -nearest, nearest);
  return select(value_of(outward) < least + least, outward - least, nearest);
}

template <class C>
struct Polygon {
  C least, zero;
  template <class Real>
  explicit Polygon(const Real* /*none*/) : least(std::numeric_limits<Number<Real>>::min()), zero(Real(0)) {}

  template <class T>
  T operator()(const T& nearest) const {
    return polygon_distance(nearest, least, zero);
  }
};

/// Cone about the second coordinate: the edges of its profile in (radius, height), from the axis round to the axis.
/// Constants: those of three PolygonEdges.
template <class C>
struct CappedCone {
  PolygonEdge<C> bottom, side, top;
  C none;
  template <class Real>
  explicit CappedCone(const Real* p)
      : bottom(p), side(p + 9), top(p + 18), none(std::numeric_limits<Number<Real>>::infinity()) {}

  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    const T radius = length(x, z);
    const T nearest = top(radius, y, side(radius, y, bottom(radius, y, Lift<T>::from(none))));
    return polygon_distance(nearest, bottom.least, bottom.zero);
  }
};

}  // namespace octomarch::ops
