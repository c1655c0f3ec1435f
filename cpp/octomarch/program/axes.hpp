// Which coordinates lie along and across an axis. Placement and the emission of primitives use it.
#pragma once

#include <cstddef>

#include "octomarch/program/placement.hpp"

namespace octomarch {

inline double& component(Vec3& v, std::size_t axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }
inline double component(const Vec3& v, std::size_t axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

/// Frame axis that a local axis lies along; contract: the rotation is a signed permutation.
inline std::size_t frame_axis(const Placement& placement, std::size_t local_axis) {
  std::size_t row = 0;
  while (placement.rotation[row * 3 + local_axis] == 0.0) ++row;
  return row;
}

inline Vec3 placed_point(const Placement& placement, const Vec3& local) {
  return placement.rotation * local * placement.scale + placement.offset;
}

/// An axis and the two across it, in their order.
struct Across {
  std::size_t along, first, second;
  explicit Across(std::size_t axis) : along(axis), first(axis == 0 ? 1 : 0), second(axis == 2 ? 1 : 2) {}
  explicit Across(double axis) : Across(static_cast<std::size_t>(axis)) {}
};

}  // namespace octomarch
