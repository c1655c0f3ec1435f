// Primitives in their own coordinates: the lowering has moved and turned the point to them, and scaled their constants.
// All distances are exact but for the cheaper box forms. A distance that is 0 on a face keeps the face's slope there, which
// the textbook forms (a square root of 0) do not.
#pragma once

#include "octomarch/ops/csg.hpp"
#include "octomarch/ops/number.hpp"

namespace octomarch::ops {

/// Distance to a box from outside, 0 within. Constants: half edges (3).
template <class C>
struct BoxExterior {
  C hx, hy, hz, zero;
  template <class Real>
  explicit BoxExterior(const Real* p) : hx(p[0]), hy(p[1]), hz(p[2]), zero(Real(0)) {}

  auto operator()(const auto& x, const auto& y, const auto& z) const {
    const auto distance = box_distance(abs(x) - hx, abs(y) - hy, abs(z) - hz, zero);
    return select(value_of(distance) < zero, max(distance, zero), distance);
  }
};

/// The largest excess over a box's half edges: its max-norm bound. Constants: half edges (3).
template <class C>
struct BoxMaximum {
  C hx, hy, hz;
  template <class Real>
  explicit BoxMaximum(const Real* p) : hx(p[0]), hy(p[1]), hz(p[2]) {}

  auto operator()(const auto& x, const auto& y, const auto& z) const {
    return max(max(abs(x) - hx, abs(y) - hy), abs(z) - hz);
  }
};

/// Distances above are those of |x| + |y| + |z| = radius (I. Quilez, "distance functions"). Constants: radius.
template <class C>
struct Octahedron {
  C radius, zero, half, third;
  template <class Real>
  explicit Octahedron(const Real* p)
      : radius(p[0]), zero(Real(0)), half(Real(0.5)), third(Number<Real>(0.57735026918962576)) {}

  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    const T px = abs(x);
    const T py = abs(y);
    const T pz = abs(z);
    const T excess = px + py + pz - radius;
    const T face = excess * third;  // 1/√3
    // beyond a face's edge the nearest point lies on that edge: `across` is 0 along it
    const auto beyond_x = value_of(px) + value_of(px) + value_of(px) < value_of(excess);
    const auto beyond_y = value_of(py) + value_of(py) + value_of(py) < value_of(excess);
    const auto beyond_z = value_of(pz) + value_of(pz) + value_of(pz) < value_of(excess);
    const T across = select(beyond_x, px, select(beyond_y, py, pz));
    const T first = select(beyond_x, py, select(beyond_y, pz, px));
    const T second = select(beyond_x, pz, select(beyond_y, px, py));
    const T along = min(max((second - first + radius) * half, zero), radius);
    const T edge = length(across, first - radius + along, second - along);
    return select(beyond_x | beyond_y | beyond_z, edge, face);
  }
};

/// Pyramid over a square. Folded into the eighth where x ≥ z ≥ 0, what is near is one side, the edge that it shares with
/// its neighbour, and the base; all edges are convex. Constants: half edge e, half height h, e/l, 2h/l with l the slope
/// height √(e² + 4h²) (both 0 where l is).
template <class C>
struct Pyramid {
  C edge, height, along_x, along_y, slope, inverse, zero, one;
  template <class Real>
  explicit Pyramid(const Real* p)
      : edge(p[0]),
        height(p[1]),
        along_x(p[2]),
        along_y(p[3]),
        slope(edge * along_x + (height + height) * along_y),
        inverse(one_over(edge * edge + edge * edge + (height + height) * (height + height))),
        zero(Real(0)),
        one(Real(1)) {}

  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    const T ax = abs(x);
    const T az = abs(z);
    const auto across = value_of(ax) < value_of(az);
    const T px = select(across, az, ax);
    const T pz = select(across, ax, az);
    const T up = y + height;                              // above the base
    const T beside = px - edge;                           // beyond the side's foot
    const T over_side = beside * along_y + up * along_x;  // signed, along the side's normal
    const T climbed = up * along_y - beside * along_x;    // up the side from its foot
    const T inside = larger_of(over_side, -up);

    const T below_base = select(value_of(beside) <= zero, abs(-up), length(beside, up, max(pz - edge, zero)));
    // the edge from the corner (e, 0, e) to the apex (0, 2h, 0)
    const T walked = min(max(((edge - px) * edge + (edge - pz) * edge + up * (height + height)) * inverse, zero), one);
    const T beside_edge =
        length(px - (one - walked) * edge, up - walked * (height + height), pz - (one - walked) * edge);
    const auto on_side = (slope > zero) & (value_of(climbed) >= zero) & (value_of(climbed) <= slope) &
                         (value_of(pz) * slope <= edge * (slope - value_of(climbed)));
    const T outside = smaller_of(select(on_side, abs(over_side), beside_edge), below_base);
    return select(value_of(inside) < zero, inside, outside);
  }

 private:
  static C one_over(const C& a) { return select(a > C(0), C(1) / a, C(0)); }
};

}  // namespace octomarch::ops
