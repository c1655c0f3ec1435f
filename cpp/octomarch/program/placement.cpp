#include "octomarch/program/placement.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "octomarch/base/hash.hpp"
#include "octomarch/program/analysis.hpp"

namespace octomarch {

namespace {

double component(const Vec3& v, std::size_t axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

/// Frame axis that a local axis lies along; contract: the rotation is a signed permutation.
std::size_t frame_axis(const Placement& placement, std::size_t local_axis) {
  std::size_t row = 0;
  while (placement.rotation[row * 3 + local_axis] == 0.0) ++row;
  return row;
}

Vec3 placed_point(const Placement& placement, const Vec3& local) {
  return placement.rotation * local * placement.scale + placement.offset;
}

ValueId emit_plane(const Node& node, const Placement& placement, DataFlow& flow) {
  const Vec3 normal = placement.rotation * Vec3{node.parameter(0), node.parameter(1), node.parameter(2)};
  const double h = placement.scale * node.parameter(3) - dot(normal, placement.offset);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double n = component(normal, axis);
    if (std::fabs(n) == 1.0) return flow.emit(Opcode::kAxisPlane, {{placement.frame[axis]}}, {{n, h}});
  }
  return flow.emit(Opcode::kPlane, placement.frame, {{normal.x, normal.y, normal.z, h}});
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
  const std::size_t along = frame_axis(place, static_cast<std::size_t>(local_axis));
  const std::size_t first = along == 0 ? 1 : 0;
  const std::size_t second = along == 2 ? 1 : 2;
  return {{place.frame[first], place.frame[along], place.frame[second]},
          {component(place.offset, first), component(place.offset, along), component(place.offset, second)}};
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

/// A kRepeat node's repetition along one axis of the frame.
struct FrameRepeat {
  RepeatAxis cells{0.0, 0.5, 0.0};
  double middle = 0.0;     ///< where the content stands
  bool symmetric = false;  ///< content is its own mirror image across this axis

  bool repeats() const { return cells.period != 0.0; }
  bool endless() const { return std::isinf(cells.limit); }
  /// Constants of ops::RepeatNeighbour, of which each simpler operator takes the beginning.
  std::array<double, 6> constants() const {
    return {cells.period,      1.0 / cells.period, cells.shift - middle / cells.period,
            0.5 - cells.shift, cells.limit,        middle};
  }
};

std::array<FrameRepeat, 3> frame_repeats(const Placement& place, const Node& repeat, unsigned symmetry) {
  std::array<FrameRepeat, 3> axes;
  for (std::size_t local = 0; local < 3; ++local) {
    const std::size_t axis = frame_axis(place, local);
    axes[axis].cells = repeat_axis(repeat, local);
    axes[axis].cells.period *= place.scale;
    axes[axis].middle = component(place.offset, axis);
    axes[axis].symmetric = (symmetry & (kMirrorX << local)) != 0;
  }
  return axes;
}

/// Moves each repeated coordinate into its nearest cell; one instruction serves all three where it can.
std::array<ValueId, 3> nearest_cell(const std::array<ValueId, 3>& frame, const std::array<FrameRepeat, 3>& axes,
                                    DataFlow& flow) {
  if (axes[0].repeats() && axes[1].repeats() && axes[2].repeats() && axes[0].endless() && axes[1].endless() &&
      axes[2].endless()) {
    std::array<double, 9> all{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::array<double, 6> constants = axes[axis].constants();
      std::copy_n(constants.begin(), 3, all.begin() + static_cast<std::ptrdiff_t>(axis * 3));
    }
    const ValueId moved = flow.emit(Opcode::kRepeat, frame, all);
    return {moved, moved + 1, moved + 2};
  }
  std::array<ValueId, 3> moved = frame;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!axes[axis].repeats()) continue;
    const std::array<double, 6> constants = axes[axis].constants();
    const Opcode op = axes[axis].endless() ? Opcode::kRepeatAxis : Opcode::kRepeatCounted;
    moved[axis] = flow.emit(op, {{frame[axis]}}, std::span(constants).first(info(op).constants));
  }
  return moved;
}

}  // namespace

std::size_t PlacementHash::operator()(const Placement& placement) const noexcept {
  std::uint64_t hash = static_cast<std::uint32_t>(placement.material);
  for (const ValueId value : placement.frame) mix(hash, value);
  mix(hash, std::bit_cast<std::uint64_t>(placement.scale));
  for (const double entry : placement.rotation) mix(hash, std::bit_cast<std::uint64_t>(entry + 0.0));
  for (std::size_t axis = 0; axis < 3; ++axis)
    mix(hash, std::bit_cast<std::uint64_t>(component(placement.offset, axis) + 0.0));
  return hash;
}

Placement child_placement(const Placement& parent, const Node& transform) {
  Placement child = parent;
  const auto p = transform.parameters();
  if (transform.kind() == NodeKind::kTranslate) {
    child.offset = placed_point(parent, {p[0], p[1], p[2]});
  } else if (transform.kind() == NodeKind::kScale) {
    child.scale = parent.scale * p[0];
  } else {
    Mat3 rotation{};
    std::copy(p.begin(), p.end(), rotation.begin());
    child.rotation = parent.rotation * rotation;
  }
  return child;
}

Placement aligned(const Placement& placement, DataFlow& flow) {
  if (is_signed_permutation(placement.rotation)) return placement;
  const Mat3 local_from_frame = transposed(placement.rotation);
  const Vec3 shift = local_from_frame * placement.offset;
  const Mat3& m = local_from_frame;
  const ValueId turned =
      flow.emit(Opcode::kRotate, placement.frame,
                {{m[0], m[1], m[2], -shift.x, m[3], m[4], m[5], -shift.y, m[6], m[7], m[8], -shift.z}});
  Placement result;
  result.frame = {turned, turned + 1, turned + 2};
  result.scale = placement.scale;
  result.material = placement.material;
  return result;
}

std::vector<Placement> repeat_placements(const Placement& parent, const Node& repeat, unsigned symmetry,
                                         DataFlow& flow) {
  const Placement place = aligned(parent, flow);
  const std::array<FrameRepeat, 3> axes = frame_repeats(place, repeat, symmetry);
  std::vector<Placement> placements{place};
  placements[0].frame = nearest_cell(place.frame, axes, flow);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!axes[axis].repeats() || axes[axis].symmetric) continue;
    const ValueId neighbour = flow.emit(Opcode::kRepeatNeighbour, {{place.frame[axis]}}, axes[axis].constants());
    const std::size_t so_far = placements.size();
    for (std::size_t i = 0; i < so_far; ++i) {
      placements.push_back(placements[i]);
      placements.back().frame[axis] = neighbour;
    }
  }
  return placements;
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
    case NodeKind::kPlane: return emit_plane(primitive, placement, flow);
    case NodeKind::kCapsule: return emit_capsule(primitive, placement, flow);
    default: return emit_revolution(primitive, placement, flow);
  }
}

}  // namespace octomarch
