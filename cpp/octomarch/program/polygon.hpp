// Edges of polygons as ops::PolygonEdge wants them. emit_primitive.cpp uses it.
#pragma once

#include <array>
#include <span>
#include <vector>

namespace octomarch {

struct Point2 {
  double x;
  double y;
};

/// Are two points far enough apart for their distance to have an inverse?
bool are_apart(Point2 a, Point2 b);

/// From a to b, counter-clockwise round the inside. Contract: they are apart.
struct PolygonEdge {
  std::array<double, 9> constants;
  PolygonEdge(Point2 a, Point2 b);
};

/// Edges of the polygon whose corners follow each other as x, y, in either direction, all coordinates times `scale`.
/// Corners that repeat the one before are passed over; none are left of a single point.
std::vector<PolygonEdge> polygon_edges(std::span<const double> coordinates, double scale);

}  // namespace octomarch
