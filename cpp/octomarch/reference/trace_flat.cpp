#include "octomarch/reference/trace_flat.hpp"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

namespace octomarch::reference {
namespace {

using Flat = std::array<double, 2>;
using FlatTrace = std::array<Trace, 2>;

/// > 0 where (x, y) lies left of a–b: twice the area of the triangle.
Interval left_of(const Flat& a, const Flat& b, double x, double y) {
  return (Interval(b[0]) - a[0]) * (Interval(y) - a[1]) - (Interval(x) - a[0]) * (Interval(b[1]) - a[1]);
}

class Polygon {
 public:
  explicit Polygon(std::span<const double> corners) {
    for (std::size_t i = 0; i < corners.size(); i += 2) corners_.push_back({corners[i], corners[i + 1]});
  }

  std::size_t size() const { return corners_.size(); }
  const Flat& begin_of(std::size_t edge) const { return corners_[edge]; }
  const Flat& end_of(std::size_t edge) const { return corners_[edge + 1 == corners_.size() ? 0 : edge + 1]; }

  Trace distance_to(std::size_t edge, const FlatTrace& p) const {
    return length(from_segment<2>(p, begin_of(edge), end_of(edge)));
  }

  /// −1 inside, 1 outside; nothing where roundings leave both possible.
  std::optional<double> sign_at(double x, double y) const {
    double sign = 1.0;
    for (std::size_t edge = 0; edge < size(); ++edge) {
      const Flat& a = begin_of(edge);
      const Flat& b = end_of(edge);
      if ((a[1] <= y) == (b[1] <= y)) continue;
      const Interval left = left_of(a, b, x, y);
      if (left.contains(0.0)) return std::nullopt;
      if ((left.lo() > 0.0) == (b[1] > a[1])) sign = -sign;
    }
    return sign;
  }

 private:
  std::vector<Flat> corners_;
};

double middle(const Interval& a) { return 0.5 * a.lo() + 0.5 * a.hi(); }

enum class End : std::uint8_t { kFirst, kLast };

const Interval& at(End end, const Trace& a) { return end == End::kFirst ? a.first : a.last; }

/// A polygon, and how far its edges are along a piece.
struct Outline {
  Polygon polygon;
  FlatTrace p;
  std::vector<Trace> distances;

  Outline(std::span<const double> corners, const Trace& x, const Trace& y) : polygon(corners), p{x, y} {
    for (std::size_t edge = 0; edge < polygon.size(); ++edge) distances.push_back(polygon.distance_to(edge, p));
  }

  /// The sign at an end of the piece: that in the middle of the box it is known to lie in, if no edge enters the box.
  std::optional<double> sign_at(End end) const {
    const bool is_apart = std::ranges::all_of(distances, [end](const Trace& d) { return at(end, d).lo() > 0.0; });
    if (!is_apart) return std::nullopt;
    return polygon.sign_at(middle(at(end, p[0])), middle(at(end, p[1])));
  }
};

/// The polygon's distance where `edge` is nearest along all of the piece, and its ends are not: that to its line, whose
/// sides are inside and outside. Which is which, an end of the piece tells that is off the line.
std::optional<Trace> by_line(const Outline& outline, std::size_t edge) {
  const Flat& a = outline.polygon.begin_of(edge);
  const Flat& b = outline.polygon.end_of(edge);
  const Interval dx = Interval(b[0]) - a[0];
  const Interval dy = Interval(b[1]) - a[1];
  const Trace left = ((outline.p[1] - a[1]) * dx - (outline.p[0] - a[0]) * dy) / sqrt(square(dx) + square(dy));
  for (const End end : {End::kFirst, End::kLast}) {
    const Interval side = at(end, left);
    const auto sign = outline.sign_at(end);
    if (sign && !side.contains(0.0)) return (*sign > 0.0) == (side.lo() > 0.0) ? left : -left;
  }
  return std::nullopt;
}

/// The one edge that is nearest along all of the piece, where it is so by a point between its ends.
std::optional<std::size_t> only_edge(const Outline& outline) {
  const auto farthest = [](const Trace& distance) { return distance.over.hi(); };
  const auto nearest = std::ranges::min_element(outline.distances, {}, farthest);
  const bool is_only = std::ranges::all_of(outline.distances, [&](const Trace& other) {
    return &other == &*nearest || other.over.lo() > nearest->over.hi();
  });
  if (!is_only) return std::nullopt;
  const auto edge = static_cast<std::size_t>(nearest - outline.distances.begin());
  const Polygon& polygon = outline.polygon;
  const Interval fraction = along_line<2>(outline.p, polygon.begin_of(edge), polygon.end_of(edge)).over;
  return fraction.lo() > 0.0 && fraction.hi() < 1.0 ? std::optional(edge) : std::nullopt;
}

}  // namespace

Trace polygon_trace(std::span<const double> corners, const Trace& x, const Trace& y) {
  const Outline outline(corners, x, y);
  Trace distance = outline.distances[0];
  for (const Trace& other : outline.distances) distance = min(distance, other);
  if (distance.is_undefined) return undefined();
  const auto first_sign = outline.sign_at(End::kFirst);
  if (distance.over.lo() > 0.0 && first_sign) return *first_sign < 0.0 ? -distance : distance;
  if (const auto edge = only_edge(outline)) {
    if (const auto line = by_line(outline, *edge)) return *line;
  }
  const auto signed_by = [](const Interval& size, std::optional<double> sign) {
    return sign ? size * *sign : hull(-size, size);
  };
  const Trace either{signed_by(distance.over, std::nullopt), signed_by(distance.first, first_sign),
                     signed_by(distance.last, outline.sign_at(End::kLast)), Interval::whole()};
  return no_faster(either, speed(outline.p));
}

}  // namespace octomarch::reference
