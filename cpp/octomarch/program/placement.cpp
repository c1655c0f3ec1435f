#include "octomarch/program/placement.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "octomarch/base/hash.hpp"
#include "octomarch/graph/analysis.hpp"
#include "octomarch/program/axes.hpp"
#include "octomarch/program/placed_normal.hpp"

namespace octomarch {

namespace {

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

/// Moves `place` to one of the copies along endless axes, where it is many periods away.
std::array<FrameRepeat, 3> frame_repeats(Placement& place, const Node& repeat, unsigned symmetry) {
  std::array<FrameRepeat, 3> axes;
  for (std::size_t local = 0; local < 3; ++local) {
    const std::size_t axis = frame_axis(place, local);
    axes[axis].cells = repeat_axis(repeat, local);
    axes[axis].cells.period *= place.scale;
    double& middle = component(place.offset, axis);
    middle = axes[axis].middle = nearest_middle(axes[axis].cells, middle);
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

std::uint64_t hash_of(const Placement& placement) {
  std::uint64_t hash = static_cast<std::uint32_t>(placement.material);
  for (const ValueId value : placement.frame) mix(hash, value);
  for (const ValueId value : placement.normal) mix(hash, value);
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
  Placement result = placement;
  result.frame = {turned, turned + 1, turned + 2};
  result.rotation = kIdentity3;
  result.offset = {};
  if (placement.normal[0] != kNoNormal) {
    const ValueId normal = flow.emit(Opcode::kRotate, placement.normal,
                                     {{m[0], m[1], m[2], 0.0, m[3], m[4], m[5], 0.0, m[6], m[7], m[8], 0.0}});
    result.normal = {normal, normal + 1, normal + 2};
  }
  return result;
}

std::array<ValueId, 3> own_axes(const Placement& placement, DataFlow& flow) {
  const Placement place = aligned(placement, flow);
  std::array<ValueId, 3> axes{};
  for (std::size_t local = 0; local < 3; ++local) {
    const std::size_t row = frame_axis(place, local);
    const double offset = component(place.offset, row);
    if (place.rotation[row * 3 + local] < 0.0) {
      axes[local] = flow.emit(Opcode::kSubtractFrom, {{place.frame[row]}}, {{offset}});
    } else if (offset != 0.0) {
      axes[local] = flow.emit(Opcode::kAddConstant, {{place.frame[row]}}, {{-offset}});
    } else {
      axes[local] = place.frame[row];
    }
  }
  return axes;
}

Coordinates own_coordinates(const Placement& placement, DataFlow& flow) {
  flow.note_move(placement.offset);
  std::array<ValueId, 3> axes = own_axes(placement, flow);
  if (placement.scale != 1.0) {
    for (ValueId& axis : axes) axis = flow.emit(Opcode::kMultiplyConstant, {{axis}}, {{1.0 / placement.scale}});
  }
  Coordinates coordinates{axes[0], axes[1], axes[2], kNoNormal, kNoNormal, kNoNormal};
  if (placement.normal[0] == kNoNormal) return coordinates;
  const Placement place = aligned(placement, flow);
  for (std::size_t local = 0; local < 3; ++local) {
    const std::size_t row = frame_axis(place, local);
    const ValueId along = place.normal[row];
    const bool reversed = place.rotation[row * 3 + local] < 0.0;
    coordinates[3 + local] = reversed ? flow.emit(Opcode::kComplement, {{along}}) : along;
  }
  return coordinates;
}

Placement bent_placement(const Placement& parent, const Node& node, DataFlow& flow) {
  flow.note_move(parent.offset);
  Placement child;
  child.frame = own_axes(parent, flow);
  child.scale = parent.scale;
  child.material = parent.material;
  const std::array<ValueId, 3> own = child.frame;
  const double s = parent.scale;
  const auto p = node.parameters();
  std::array<ValueId, 3>& frame = child.frame;
  switch (node.kind()) {
    case NodeKind::kStretch: {
      const double least = std::min({p[0], p[1], p[2]});
      child.scale = s * least;
      for (std::size_t i = 0; i < 3; ++i) {
        if (p[i] != least) frame[i] = flow.emit(Opcode::kMultiplyConstant, {{frame[i]}}, {{least / p[i]}});
      }
      break;
    }
    case NodeKind::kMirror: {
      ValueId& mirrored = frame[static_cast<std::size_t>(p[0])];
      mirrored = flow.emit(Opcode::kAbsolute, {{mirrored}});
      break;
    }
    case NodeKind::kElongate:
      for (std::size_t i = 0; i < 3; ++i) {
        if (p[i] != 0.0) frame[i] = flow.emit(Opcode::kElongate, {{frame[i]}}, {{p[i] * s}});
      }
      break;
    case NodeKind::kTwist: {
      const Across across(p[2]);
      const ValueId turned = flow.emit(
          Opcode::kTwist, {{frame[across.first], frame[across.along], frame[across.second]}}, {{p[0] / s, p[1] * s}});
      frame[across.first] = turned;
      frame[across.second] = turned + 1;
      break;
    }
    case NodeKind::kBend: {
      const ValueId turned = flow.emit(Opcode::kBend, {{frame[0], frame[1]}}, {{p[0] / s, p[1] * s}});
      frame[0] = turned;
      frame[1] = turned + 1;
      break;
    }
    case NodeKind::kRevolve:
      frame[0] = flow.emit(Opcode::kOriginCylinder, {{frame[0], frame[2]}}, {{p[0] * s}});
      frame[2] = flow.constant(0.0);
      break;
    default:  // kExtrude: its child is flat
      frame[2] = flow.constant(0.0);
      break;
  }
  if (parent.normal[0] != kNoNormal) {
    const Coordinates coordinates = own_coordinates(parent, flow);
    child.normal = bent_normal(node, s, {coordinates[3], coordinates[4], coordinates[5]}, own, frame, flow);
  }
  return child;
}

ValueId emit_cut(const Node& node, const Placement& placement, DataFlow& flow) {
  const std::array<ValueId, 3> frame = own_axes(placement, flow);
  const Across across(node.kind() == NodeKind::kTwist ? node.parameter(2) : 2.0);
  return flow.emit(Opcode::kOriginCylinder, {{frame[across.first], frame[across.second]}},
                   {{node.parameter(1) * placement.scale}});
}

std::vector<Placement> repeat_placements(const Placement& parent, const Node& repeat, unsigned symmetry,
                                         DataFlow& flow) {
  Placement place = aligned(parent, flow);
  const std::array<FrameRepeat, 3> axes = frame_repeats(place, repeat, symmetry);
  flow.note_move(place.offset);
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

}  // namespace octomarch
