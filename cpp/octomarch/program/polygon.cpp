#include "octomarch/program/polygon.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace octomarch {
namespace {

double cross(Point2 a, Point2 b, Point2 c) { return (b.x - a.x) * (c.y - b.y) - (b.y - a.y) * (c.x - b.x); }

/// Distinct corners in counter-clockwise order.
std::vector<Point2> corners_of(std::span<const double> coordinates, double scale) {
  std::vector<Point2> corners;
  for (std::size_t i = 0; i + 1 < coordinates.size(); i += 2) {
    const Point2 corner{coordinates[i] * scale, coordinates[i + 1] * scale};
    if (corners.empty() || are_apart(corner, corners.back())) corners.push_back(corner);
  }
  while (corners.size() > 1 && !are_apart(corners.front(), corners.back())) corners.pop_back();
  double twice_area = 0.0;
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) twice_area += cross(corners[0], corners[i], corners[i + 1]);
  if (twice_area < 0.0) std::reverse(corners.begin(), corners.end());
  return corners;
}

}  // namespace

bool are_apart(Point2 a, Point2 b) {
  const double distance = std::hypot(b.x - a.x, b.y - a.y);
  return distance >= std::numeric_limits<double>::min();
}

PolygonEdge::PolygonEdge(Point2 a, Point2 b) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  const double inverse = 1.0 / std::hypot(dx, dy);
  // u·(p − a) runs from 0 to 1 along the edge
  constants = {a.x,
               a.y,
               b.x,
               b.y,
               dx * inverse * inverse,
               dy * inverse * inverse,
               dy * inverse,
               -dx * inverse,
               dy > 0.0 ? 1.0 : -1.0};
}

std::vector<PolygonEdge> polygon_edges(std::span<const double> coordinates, double scale) {
  const std::vector<Point2> corners = corners_of(coordinates, scale);
  const std::size_t n = corners.size();
  std::vector<PolygonEdge> edges;
  for (std::size_t i = 0; n > 1 && i < n; ++i) edges.emplace_back(corners[i], corners[(i + 1) % n]);
  return edges;
}

}  // namespace octomarch
