// From a camera to what kernels need of it: the affine map from pixels to rays, and the footprint of a pixel.
#pragma once

#include "octomarch/graph/scene.hpp"
#include "octomarch/kernels/api.hpp"

namespace octomarch {

/// A camera for one picture size, in double. Perspective: origin fixed, direction = corner + (i+½)·right + (j+½)·down,
/// to be normalised. Orthographic: the same sum is the origin, direction fixed.
struct CameraFrame {
  bool perspective;
  Vec3 fixed;  ///< the origin (perspective) or the unit direction (orthographic) of all rays
  Vec3 corner;
  Vec3 right;
  Vec3 down;
  double pixel_slope;   ///< half a pixel's height per unit of t; perspective only, else 0
  double pixel_radius;  ///< half a pixel's height; orthographic only, else 0
};

/// Contract: eye ≠ target, up not parallel to the view, 0 < fov < 180, height > 0 (Python checks).
CameraFrame frame(const Camera& camera, std::uint32_t width, std::uint32_t height);

template <class Real>
kernels::CameraView<Real> view(const CameraFrame& frame) {
  const auto real = [](double value) { return static_cast<Real>(value); };
  return {frame.perspective,
          {real(frame.corner.x), real(frame.corner.y), real(frame.corner.z)},
          {real(frame.right.x), real(frame.right.y), real(frame.right.z)},
          {real(frame.down.x), real(frame.down.y), real(frame.down.z)}};
}

}  // namespace octomarch
