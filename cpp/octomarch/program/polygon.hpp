// Edges of polygons as ops::PolygonEdge wants them. emit_primitive.cpp uses it.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace octomarch {

struct Point2 {
  double x;
  double y;
  friend bool operator==(const Point2&, const Point2&) = default;
};

/// From a to b ≠ a, counter-clockwise round the inside.
struct PolygonEdge {
  std::array<double, 9> constants;
  PolygonEdge(Point2 a, Point2 b);
};

/// Edges of the polygon whose corners follow each other as x, y, in either direction, all coordinates times `scale`.
/// Corners that repeat the one before are passed over; none are left of a single point.
std::vector<PolygonEdge> polygon_edges(std::span<const double> coordinates, double scale);

}  // namespace octomarch
