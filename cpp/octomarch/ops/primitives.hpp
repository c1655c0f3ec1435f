// Primitives: signed distances of placed solids, exact and so 1-Lipschitz. The lowering has folded translation, uniform
// scale and axis permutations into the constants and the choice of coordinates. Sources: I. Quilez, "distance
// functions" (box, capped cylinder, torus, capsule); the sphere and the plane are their definitions.
//
// Each operator reads its constants once, from the list given at its constructor, and is then called for every batch.
#pragma once

#include "octomarch/ops/number.hpp"

namespace octomarch::ops {

/// ‖p − c‖ − r. Constants: c (3), r.
template <class C>
struct Sphere {
  C cx, cy, cz, radius;
  template <class Real>
  explicit Sphere(const Real* p) : cx(p[0]), cy(p[1]), cz(p[2]), radius(p[3]) {}

  auto operator()(const auto& x, const auto& y, const auto& z) const { return length(x - cx, y - cy, z - cz) - radius; }
};

/// The same about the origin. Constants: r.
template <class C>
struct OriginSphere {
  C radius;
  template <class Real>
  explicit OriginSphere(const Real* p) : radius(p[0]) {}

  auto operator()(const auto& x, const auto& y, const auto& z) const { return length(x, y, z) - radius; }
};

/// Box with faces along the axes. Constants: centre (3), half edges (3).
template <class C>
struct Box {
  C cx, cy, cz, hx, hy, hz, zero;
  template <class Real>
  explicit Box(const Real* p) : cx(p[0]), cy(p[1]), cz(p[2]), hx(p[3]), hy(p[4]), hz(p[5]), zero(Real(0)) {}

  auto operator()(const auto& x, const auto& y, const auto& z) const {
    return box_distance(abs(x - cx) - hx, abs(y - cy) - hy, abs(z - cz) - hz, zero);
  }
};

/// The same about the origin. Constants: half edges (3).
template <class C>
struct OriginBox {
  C hx, hy, hz, zero;
  template <class Real>
  explicit OriginBox(const Real* p) : hx(p[0]), hy(p[1]), hz(p[2]), zero(Real(0)) {}

  auto operator()(const auto& x, const auto& y, const auto& z) const {
    return box_distance(abs(x) - hx, abs(y) - hy, abs(z) - hz, zero);
  }
};

/// n·p + h. Constants: n (3), h.
template <class C>
struct Plane {
  C nx, ny, nz, h;
  template <class Real>
  explicit Plane(const Real* p) : nx(p[0]), ny(p[1]), nz(p[2]), h(p[3]) {}

  auto operator()(const auto& x, const auto& y, const auto& z) const { return x * nx + y * ny + z * nz + h; }
};

/// Plane across one coordinate. Constants: n = ±1, h.
template <class C>
struct AxisPlane {
  C n, h;
  template <class Real>
  explicit AxisPlane(const Real* p) : n(p[0]), h(p[1]) {}

  auto operator()(const auto& x) const { return x * n + h; }
};

/// Endless cylinder; its two inputs are the coordinates across the axis. Constants: centre (2), r.
template <class C>
struct Cylinder {
  C cx, cz, radius;
  template <class Real>
  explicit Cylinder(const Real* p) : cx(p[0]), cz(p[1]), radius(p[2]) {}

  auto operator()(const auto& x, const auto& z) const { return length(x - cx, z - cz) - radius; }
};

/// The same about a coordinate axis. Constants: r.
template <class C>
struct OriginCylinder {
  C radius;
  template <class Real>
  explicit OriginCylinder(const Real* p) : radius(p[0]) {}

  auto operator()(const auto& x, const auto& z) const { return length(x, z) - radius; }
};

/// Cylinder with flat caps; the second input runs along the axis. Constants: centre (3), r, half height.
template <class C>
struct CappedCylinder {
  C cx, cy, cz, radius, half_height, zero;
  template <class Real>
  explicit CappedCylinder(const Real* p)
      : cx(p[0]), cy(p[1]), cz(p[2]), radius(p[3]), half_height(p[4]), zero(Real(0)) {}

  auto operator()(const auto& x, const auto& y, const auto& z) const {
    return box_distance(length(x - cx, z - cz) - radius, abs(y - cy) - half_height, zero);
  }
};

/// Torus; the second input runs along its axis. Constants: centre (3), radius of the centre line, radius of the tube.
template <class C>
struct Torus {
  C cx, cy, cz, radius, tube_radius;
  template <class Real>
  explicit Torus(const Real* p) : cx(p[0]), cy(p[1]), cz(p[2]), radius(p[3]), tube_radius(p[4]) {}

  auto operator()(const auto& x, const auto& y, const auto& z) const {
    return length(length(x - cx, z - cz) - radius, y - cy) - tube_radius;
  }
};

/// Segment from a along e, thickened. Constants: a (3), e (3), 1/‖e‖² (0 where e = 0: a sphere), r.
template <class C>
struct Capsule {
  C ax, ay, az, ex, ey, ez, inverse, radius, zero, one;
  template <class Real>
  explicit Capsule(const Real* p)
      : ax(p[0]),
        ay(p[1]),
        az(p[2]),
        ex(p[3]),
        ey(p[4]),
        ez(p[5]),
        inverse(p[6]),
        radius(p[7]),
        zero(Real(0)),
        one(Real(1)) {}

  auto operator()(const auto& x, const auto& y, const auto& z) const {
    const auto px = x - ax;
    const auto py = y - ay;
    const auto pz = z - az;
    const auto along = min(max((px * ex + py * ey + pz * ez) * inverse, zero), one);
    return length(px - along * ex, py - along * ey, pz - along * ez) - radius;
  }
};

}  // namespace octomarch::ops
