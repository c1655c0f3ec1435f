#include "octomarch/reference/trace_primitives.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "octomarch/graph/schema.hpp"
#include "octomarch/reference/trace_flat.hpp"
#include "octomarch/reference/trace_lattice.hpp"
#include "octomarch/reference/trace_polyhedra.hpp"

namespace octomarch::reference {
namespace {

/// A point relative to a coordinate axis.
struct AxialTrace {
  Trace radial;
  Trace axial;

  AxialTrace(const PointTrace& p, double axis_number) {
    const auto axis = static_cast<std::size_t>(axis_number);
    radial = length(std::array{p[(axis + 1) % 3], p[(axis + 2) % 3]});
    axial = p[axis];
  }
};

PointTrace box_excess(const Node& node, const PointTrace& p) {
  return {abs(p[0]) - node.parameter(0), abs(p[1]) - node.parameter(1), abs(p[2]) - node.parameter(2)};
}

Trace largest(std::span<const Trace> q) {
  Trace result = q[0];
  for (const Trace& other : q.subspan(1)) result = max(result, other);
  return result;
}

Trace outside_length(std::span<const Trace> excess) {
  std::vector<Trace> outside;
  for (const Trace& q : excess) outside.push_back(max(q, 0.0));
  return length(outside);
}

/// The one excess that is the distance, both within the box and outside: where no other is above it, or above 0.
const Trace* only_side(std::span<const Trace> excess) {
  for (const Trace& side : excess) {
    const bool is_only = std::ranges::all_of(excess, [&side](const Trace& other) {
      return &other == &side || other.over.hi() <= std::min(side.over.lo(), 0.0);
    });
    if (is_only) return &side;
  }
  return nullptr;
}

Trace capped_cone(const Node& node, const PointTrace& p) {
  const AxialTrace at(p, 1.0);
  const double bottom = node.parameter(0);
  const double top = node.parameter(1);
  const double h = node.parameter(2);
  // mirrored at the axis, lest the axis be a side
  return polygon_trace(std::array{-bottom, -h, bottom, -h, top, h, -top, h}, at.radial, at.axial);
}

Trace capsule(const Node& node, const PointTrace& p) {
  const std::span<const double> numbers = node.parameters();
  return length(from_segment<3>(p, numbers.first<3>(), numbers.subspan<3, 3>())) - node.parameter(6);
}

/// The interpolant at the nearest point of the box, and the box.
Trace grid(const Node& node, const PointTrace& p) {
  PointTrace held;
  std::array<Trace, 3> excess;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double lo = node.parameter(6 + axis);
    const double hi = node.parameter(9 + axis);
    held[axis] = min(max(p[axis], lo), hi);
    excess[axis] = max(constant(lo) - p[axis], p[axis] - hi);
  }
  return box_trace(std::array{interpolant(node, held), box_trace(excess) * node.parameter(5)});
}

}  // namespace

Trace box_trace(std::span<const Trace> excess) {
  const bool is_undefined = std::ranges::any_of(excess, &Trace::is_undefined);
  if (is_undefined) return undefined();
  if (const Trace* const side = only_side(excess)) return *side;
  const auto above_0 = [](const Trace& q) { return q.over.lo() > 0.0; };
  const auto below_0 = [](const Trace& q) { return q.over.hi() <= 0.0; };
  const Trace outside = outside_length(excess);
  if (std::ranges::any_of(excess, above_0)) return outside;
  const Trace inside = largest(excess);
  if (std::ranges::all_of(excess, below_0)) return inside;
  // never both: the one is 0 where the other is not
  Trace result = outside + min(inside, 0.0);
  result.rise = 0.0;
  for (const Trace& q : excess) result.rise = result.rise + hull(0.0, q.rise);
  return no_faster(result, speed(excess));
}

Trace primitive_trace(const Node& node, const PointTrace& p) {
  const auto number = [&node](std::size_t i) { return Interval(node.parameter(i)); };
  switch (node.kind()) {
    case NodeKind::kSphere: return length(p) - number(0);
    case NodeKind::kBox: return box_trace(box_excess(node, p));
    case NodeKind::kBoxExterior: return outside_length(box_excess(node, p));
    case NodeKind::kBoxMaximum: return largest(box_excess(node, p));
    case NodeKind::kRectangle: return box_trace(std::array{abs(p[0]) - number(0), abs(p[1]) - number(1)});
    case NodeKind::kPolygon: return polygon_trace(node.parameters(), p[0], p[1]);
    case NodeKind::kGrid: return grid(node, p);
    case NodeKind::kCappedCone: return capped_cone(node, p);
    case NodeKind::kOctahedron: return octahedron_trace(p, node.parameter(0));
    case NodeKind::kPyramid: return pyramid_trace(p, node.parameter(0), node.parameter(1));
    case NodeKind::kPlane: return p[0] * number(0) + p[1] * number(1) + p[2] * number(2) + number(3);
    case NodeKind::kCylinder: return AxialTrace(p, node.parameter(1)).radial - number(0);
    case NodeKind::kCappedCylinder: {
      const AxialTrace at(p, node.parameter(2));
      return box_trace(std::array{at.radial - number(0), abs(at.axial) - number(1)});
    }
    case NodeKind::kTorus: {
      const AxialTrace at(p, node.parameter(2));
      return length(std::array{at.radial - number(0), at.axial}) - number(1);
    }
    case NodeKind::kCapsule: return capsule(node, p);
    default: throw std::logic_error("trace_primitives.cpp: nothing known of " + std::string(name(node.kind())));
  }
}

}  // namespace octomarch::reference
