// Matrices that place a shape, taken apart into what nodes say. Builders of many copies (builder_many.cpp) use it.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "octomarch/base/types.hpp"

namespace octomarch {

/// Where a copy stands: p_parent = factor·rotation·p + offset.
struct Motion {
  static constexpr std::size_t kNumbers = 12;
  /// How far entries of RᵀR may be from the unit matrix, R being the matrix that should be a rotation.
  static constexpr double kTolerance = 1e-5;

  double factor;  ///< finite and > 0
  Mat3 rotation;  ///< orthonormal up to rounding, right-handed
  Vec3 offset;
};

/// The motion nearest to a matrix parent_from_child, three rows of four numbers, that is one up to the tolerance. A turn
/// about a coordinate axis, a quarter turn or a factor of 1 that is off by `rounding` or less is set right. Throws ArgumentError that names `argument` and
/// shows the matrix where it is too far from a motion.
Motion motion_of(std::span<const double, Motion::kNumbers> matrix, double rounding, std::string_view argument);

}  // namespace octomarch
