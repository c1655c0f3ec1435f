// Of a convex solid the highest plane is the distance inside, and a bound of it outside; there the distance is that to the
// nearest face. Where a point lies over a face, that face's plane is the distance on both sides of it.
#include "octomarch/reference/trace_polyhedra.hpp"

#include <algorithm>
#include <span>

#include "octomarch/reference/trace_flat.hpp"

namespace octomarch::reference {
namespace {

using Corner = std::array<double, 3>;
using Direction = std::array<Interval, 3>;

Direction from_to(const Corner& a, const Corner& b) {
  return {Interval(b[0]) - a[0], Interval(b[1]) - a[1], Interval(b[2]) - a[2]};
}

Direction cross(const Direction& a, const Direction& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// (p − a)·d.
Trace dot_from(const PointTrace& p, const Corner& a, const Direction& d) {
  return (p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1] + (p[2] - a[2]) * d[2];
}

Trace plane_through(const PointTrace& p, const Corner& corner, const Direction& normal) {
  const Interval norm = sqrt(square(normal[0]) + square(normal[1]) + square(normal[2]));
  return dot_from(p, corner, {normal[0] / norm, normal[1] / norm, normal[2] / norm});
}

/// A face of a convex solid.
struct Face {
  Trace plane;   ///< signed distance to its plane
  Trace beside;  ///< ≥ 0 over the face, < 0 beside it
  Trace rim;     ///< distance to its edges
};

/// A triangle in a plane of the given outward normal. Without area it is no more than its edges.
Face triangle(const PointTrace& p, const Direction& normal, const Corner& a, const Corner& b, const Corner& c) {
  const Direction across = cross(from_to(a, b), from_to(a, c));
  const auto beside = [&](const Corner& from, const Corner& to) {
    return dot_from(p, from, cross(across, from_to(from, to)));
  };
  const bool is_thin = std::ranges::all_of(across, [](const Interval& x) { return x == Interval(0.0); });
  const auto edge = [&](const Corner& from, const Corner& to) { return length(from_segment<3>(p, from, to)); };
  return {plane_through(p, a, normal), is_thin ? constant(-1.0) : min(min(beside(a, b), beside(b, c)), beside(c, a)),
          min(min(edge(a, b), edge(b, c)), edge(c, a))};
}

/// Distance to a face: by its plane over it, else by its edges, which are never nearer.
Trace distance_to(const Face& face) {
  const Trace height = abs(face.plane);
  if (face.beside.over.lo() >= 0.0) return height;
  if (face.beside.over.hi() < 0.0) return face.rim;
  const auto distance = [](const Interval& beside, const Interval& over_face, const Interval& rim) -> Interval {
    if (beside.lo() >= 0.0) return over_face;
    return beside.hi() < 0.0 ? rim : Interval{over_face.lo(), std::max(over_face.lo(), rim.hi())};
  };
  return mapped(distance, hull(height.rise, face.rim.rise), face.beside, height, face.rim);
}

/// The face whose plane is the distance along all of the piece: it is over no other.
const Face* only_face(std::span<const Face> faces) {
  for (const Face& face : faces) {
    const bool is_highest = std::ranges::all_of(
        faces, [&face](const Face& other) { return &other == &face || other.plane.over.hi() <= face.plane.over.lo(); });
    if (is_highest && face.beside.over.lo() >= 0.0) return &face;
  }
  return nullptr;
}

Trace convex(const PointTrace& p, std::span<const Face> faces) {
  if (const Face* const face = only_face(faces)) return face->plane;
  Trace highest = faces[0].plane;
  Trace nearest = distance_to(faces[0]);
  for (const Face& face : faces.subspan(1)) {
    highest = max(highest, face.plane);
    nearest = min(nearest, distance_to(face));
  }
  if (highest.over.hi() <= 0.0) return highest;
  const auto distance = [](const Interval& inside, const Interval& outside) -> Interval {
    if (inside.hi() <= 0.0) return inside;
    return {inside.lo() > 0.0 ? std::max(inside.lo(), outside.lo()) : inside.lo(), std::max(inside.hi(), outside.hi())};
  };
  const Interval rise = highest.over.lo() > 0.0 ? nearest.rise : hull(highest.rise, nearest.rise);
  return no_faster(mapped(distance, rise, highest, nearest), speed(p));
}

}  // namespace

Trace octahedron_trace(const PointTrace& p, double radius) {
  if (radius == 0.0) return length(p);
  const PointTrace folded{abs(p[0]), abs(p[1]), abs(p[2])};
  const Face face = triangle(folded, {1.0, 1.0, 1.0}, {radius, 0, 0}, {0, radius, 0}, {0, 0, radius});
  return convex(folded, {&face, 1});
}

Trace pyramid_trace(const PointTrace& p, double e, double h) {
  // a segment or a square, to whose sides no plane of a face says where it ends
  if (e == 0.0 || h == 0.0) {
    return length(std::array{max(abs(p[0]) - e, 0.0), max(abs(p[1]) - h, 0.0), max(abs(p[2]) - e, 0.0)});
  }
  const PointTrace folded{abs(p[0]), p[1], abs(p[2])};
  const Corner apex{0.0, h, 0.0};
  const Corner corner{e, -h, e};
  const Interval across = Interval(2.0) * h;
  // the quarter of the base, whose edges are those of the other faces
  const Trace base_height = -(p[1] + h);
  const Face base{base_height, min(constant(e) - folded[0], constant(e) - folded[2]),
                  length(std::array{max(folded[0] - e, 0.0), base_height, max(folded[2] - e, 0.0)})};
  const Face faces[] = {triangle(folded, {across, e, 0.0}, apex, {e, -h, 0.0}, corner),
                        triangle(folded, {0.0, e, across}, apex, corner, {0.0, -h, e}), base};
  return convex(folded, faces);
}

}  // namespace octomarch::reference
