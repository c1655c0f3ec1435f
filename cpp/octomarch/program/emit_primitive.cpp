// Primitives as instructions: position, rotation and scale of a placement end in their constants.
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "octomarch/graph/analysis.hpp"
#include "octomarch/graph/grid.hpp"
#include "octomarch/graph/schema.hpp"
#include "octomarch/ops/grid.hpp"
#include "octomarch/program/axes.hpp"
#include "octomarch/program/placement.hpp"
#include "octomarch/program/polygon.hpp"

namespace octomarch {

namespace {

ValueId emit_plane(const Node& node, const Placement& placement, DataFlow& flow) {
  const std::array<double, 4> plane = placed_plane(node, placement);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double n = plane[axis];
    if (std::fabs(n) == 1.0) return flow.emit(Opcode::kAxisPlane, {{placement.frame[axis]}}, {{n, plane[3]}});
  }
  return flow.emit(Opcode::kPlane, placement.frame, plane);
}

ValueId emit_capsule(const Node& node, const Placement& placement, DataFlow& flow) {
  const Vec3 a = placed_point(placement, {node.parameter(0), node.parameter(1), node.parameter(2)});
  const Vec3 b = placed_point(placement, {node.parameter(3), node.parameter(4), node.parameter(5)});
  const Vec3 e = b - a;
  const double length2 = dot(e, e);
  // a segment too short for its square to have an inverse is a point
  const double inverse = std::isnormal(length2) && std::isfinite(1.0 / length2) ? 1.0 / length2 : 0.0;
  return flow.emit(Opcode::kCapsule, placement.frame,
                   {{a.x, a.y, a.z, e.x, e.y, e.z, inverse, placement.scale * node.parameter(6)}});
}

ValueId emit_box(const Node& node, const Placement& placement, DataFlow& flow) {
  const Placement place = aligned(placement, flow);
  Vec3 half = place.rotation * Vec3{node.parameter(0), node.parameter(1), node.parameter(2)} * place.scale;
  half = {std::fabs(half.x), std::fabs(half.y), std::fabs(half.z)};
  const Vec3& c = place.offset;
  if (c == Vec3{}) return flow.emit(Opcode::kOriginBox, place.frame, {{half.x, half.y, half.z}});
  return flow.emit(Opcode::kBox, place.frame, {{c.x, c.y, c.z, half.x, half.y, half.z}});
}

/// Frame coordinates and centre of a solid of revolution, ordered (across, along, across) its axis.
struct Revolution {
  std::array<ValueId, 3> frame;
  std::array<double, 3> centre;
};

Revolution revolve(const Placement& place, double local_axis) {
  const Across across(frame_axis(place, static_cast<std::size_t>(local_axis)));
  const Vec3& c = place.offset;
  return {{place.frame[across.first], place.frame[across.along], place.frame[across.second]},
          {component(c, across.first), component(c, across.along), component(c, across.second)}};
}

ValueId emit_revolution(const Node& node, const Placement& placement, DataFlow& flow) {
  const Placement place = aligned(placement, flow);
  const double s = place.scale;
  if (node.kind() == NodeKind::kCylinder) {
    const Revolution r = revolve(place, node.parameter(1));
    if (r.centre[0] == 0.0 && r.centre[2] == 0.0) {
      return flow.emit(Opcode::kOriginCylinder, {{r.frame[0], r.frame[2]}}, {{s * node.parameter(0)}});
    }
    return flow.emit(Opcode::kCylinder, {{r.frame[0], r.frame[2]}},
                     {{r.centre[0], r.centre[2], s * node.parameter(0)}});
  }
  const Revolution r = revolve(place, node.parameter(2));
  const Opcode op = node.kind() == NodeKind::kTorus ? Opcode::kTorus : Opcode::kCappedCylinder;
  return flow.emit(op, r.frame,
                   {{r.centre[0], r.centre[1], r.centre[2], s * node.parameter(0), s * node.parameter(1)}});
}

/// A primitive in its own coordinates, whose operator takes the node's parameters as they are.
ValueId emit_own(Opcode op, const Node& node, const Placement& placement, DataFlow& flow) {
  const std::array<ValueId, 3> axes = own_axes(placement, flow);
  std::array<double, 3> constants{};
  for (std::size_t i = 0; i < info(op).constants; ++i) constants[i] = scaled_parameter(node, i, placement.scale);
  return flow.emit(op, std::span(axes).first(info(op).inputs), std::span(constants).first(info(op).constants));
}

ValueId emit_pyramid(const Node& node, const Placement& placement, DataFlow& flow) {
  const double edge = node.parameter(0) * placement.scale;
  const double height = node.parameter(1) * placement.scale;
  const double slope = std::hypot(edge, 2.0 * height);
  const double along_x = slope > 0.0 ? edge / slope : 0.0;
  const double along_y = slope > 0.0 ? 2.0 * height / slope : 0.0;
  return flow.emit(Opcode::kPyramid, own_axes(placement, flow), {{edge, height, along_x, along_y}});
}

/// The half of the cone's profile that does not lie on its axis.
ValueId emit_cone(const Node& node, const Placement& placement, DataFlow& flow) {
  const double bottom = node.parameter(0) * placement.scale;
  const double top = node.parameter(1) * placement.scale;
  const double h = node.parameter(2) * placement.scale;
  const std::array<Point2, 4> profile{{{0.0, -h}, {bottom, -h}, {top, h}, {0.0, h}}};
  const std::array<ValueId, 3> axes = own_axes(placement, flow);
  std::vector<double> constants;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!are_apart(profile[i], profile[i + 1])) continue;
    const PolygonEdge edge(profile[i], profile[i + 1]);
    constants.insert(constants.end(), edge.constants.begin(), edge.constants.end());
  }
  if (constants.empty()) return flow.emit(Opcode::kOriginSphere, axes, {{0.0}});
  while (constants.size() < 27) {  // one that is there already, and never crossed, changes nothing
    constants.insert(constants.end(), constants.begin(), constants.begin() + 8);
    constants.push_back(0.0);
  }
  return flow.emit(Opcode::kCappedCone, axes, constants);
}

/// Position, scale and quarter turns go into the places of the samples, wherever their axes then lie.
ValueId emit_grid(const Node& node, const Placement& placement, DataFlow& flow) {
  const Placement place = aligned(placement, flow);
  const GridSamples samples = samples_of(node);
  const Interval values = value_range(samples);
  std::array<ValueId, 3> axes{};
  std::array<double, ops::kGridConstants> constants{};
  constants[ops::kGridArray] = flow.image_number(node.shared_from_this());
  constants[ops::kGridScale] = place.scale;
  constants[ops::kGridSteepness] = node.parameter(5);
  constants[ops::kGridLipschitz] = std::max(node.parameter(4), node.parameter(5));
  constants[ops::kGridLeast] = values.lo() * place.scale;
  constants[ops::kGridMost] = values.hi() * place.scale;
  for (std::size_t local = 0; local < 3; ++local) {
    const std::size_t row = frame_axis(place, local);
    const double sign = place.rotation[row * 3 + local];
    const auto placed = [&](double x) { return sign * x * place.scale + component(place.offset, row); };
    const double lo = node.parameter(6 + local);
    const double hi = node.parameter(9 + local);
    axes[local] = place.frame[row];
    double* const p = &constants[ops::kGridAxes + local * ops::kGridAxisConstants];
    p[0] = placed(lo);
    p[1] = sign / (samples.spacing[local] * place.scale);
    p[2] = placed(0.5 * lo + 0.5 * hi);
    p[3] = 0.5 * (hi - lo) * place.scale;
  }
  const bool is_cubic = samples.interpolation == Interpolation::kCubic;
  return flow.emit(is_cubic ? Opcode::kCubicGrid : Opcode::kLinearGrid, axes, constants);
}

ValueId emit_polygon(const Node& node, const Placement& placement, DataFlow& flow) {
  const std::array<ValueId, 3> axes = own_axes(placement, flow);
  const std::vector<PolygonEdge> edges = polygon_edges(node.parameters(), placement.scale);
  if (edges.empty()) {
    const double s = placement.scale;
    return flow.emit(Opcode::kCylinder, std::span(axes).first(2),
                     {{node.parameter(0) * s, node.parameter(1) * s, 0.0}});
  }
  ValueId nearest = flow.constant(kInfinity);
  for (const PolygonEdge& edge : edges) {
    nearest = flow.emit(Opcode::kPolygonEdge, {{axes[0], axes[1], nearest}}, edge.constants);
  }
  return flow.emit(Opcode::kPolygon, {{nearest}});
}

}  // namespace

std::array<double, 4> placed_plane(const Node& plane, const Placement& placement) {
  const Vec3 normal = placement.rotation * Vec3{plane.parameter(0), plane.parameter(1), plane.parameter(2)};
  return {normal.x, normal.y, normal.z, placement.scale * plane.parameter(3) - dot(normal, placement.offset)};
}

ValueId emit_primitive(const Node& primitive, const Placement& placement, DataFlow& flow) {
  switch (primitive.kind()) {
    case NodeKind::kSphere: {
      const Vec3& c = placement.offset;
      const double radius = placement.scale * primitive.parameter(0);
      if (c == Vec3{}) return flow.emit(Opcode::kOriginSphere, placement.frame, {{radius}});
      return flow.emit(Opcode::kSphere, placement.frame, {{c.x, c.y, c.z, radius}});
    }
    case NodeKind::kBox: return emit_box(primitive, placement, flow);
    case NodeKind::kBoxExterior: return emit_own(Opcode::kBoxExterior, primitive, placement, flow);
    case NodeKind::kBoxMaximum: return emit_own(Opcode::kBoxMaximum, primitive, placement, flow);
    case NodeKind::kOctahedron: return emit_own(Opcode::kOctahedron, primitive, placement, flow);
    case NodeKind::kRectangle: return emit_own(Opcode::kRectangle, primitive, placement, flow);
    case NodeKind::kPyramid: return emit_pyramid(primitive, placement, flow);
    case NodeKind::kCappedCone: return emit_cone(primitive, placement, flow);
    case NodeKind::kPolygon: return emit_polygon(primitive, placement, flow);
    case NodeKind::kGrid: return emit_grid(primitive, placement, flow);
    case NodeKind::kPlane: return emit_plane(primitive, placement, flow);
    case NodeKind::kCapsule: return emit_capsule(primitive, placement, flow);
    case NodeKind::kCylinder:
    case NodeKind::kCappedCylinder:
    case NodeKind::kTorus: return emit_revolution(primitive, placement, flow);
    default: throw std::logic_error("emit_primitive.cpp: no instruction for " + std::string(name(primitive.kind())));
  }
}

}  // namespace octomarch
