// From a camera to what kernels need of it: the affine map from pixels to rays, or the rays themselves where there is no
// such map, and the footprint of a pixel.
#pragma once

#include "octomarch/graph/scene.hpp"
#include "octomarch/graph/site.hpp"
#include "octomarch/kernels/api.hpp"
#include "octomarch/render/buffer.hpp"

namespace octomarch {

/// A camera for one picture size, in double. Perspective: origin fixed, direction = corner + (i+½)·right + (j+½)·down,
/// to be normalised. Orthographic: the same sum is the origin, direction fixed. Panoramic: origin fixed, corner = w,
/// right = u, down = −v.
struct CameraFrame {
  CameraKind kind;
  Vec3 fixed;  ///< the origin (perspective, panoramic) or the unit direction (orthographic) of all rays
  Vec3 corner;
  Vec3 right;
  Vec3 down;
  double pixel_slope;   ///< half a pixel's height per unit of t; 0 for orthographic cameras
  double pixel_radius;  ///< half a pixel's height; orthographic only, else 0
  double longitude;     ///< of the picture's left edge, radians; this and the next three are panoramic only
  double latitude;      ///< of its upper edge
  double column;        ///< the angle of a pixel's width
  double row;           ///< the angle of a pixel's height

  /// Do all rays begin in one point? Else they have one direction.
  bool one_origin() const { return kind != CameraKind::kOrthographic; }
};

/// Contract: eye ≠ target, up not parallel to the view, angles and height as Camera says (Python checks).
CameraFrame frame(const Camera& camera, std::uint32_t width, std::uint32_t height);

/// Unit directions of a tile's rays through `point` of their pixels, for a panoramic camera. Its longitude belongs to a
/// column and its latitude to a row, so that there is one sine and cosine for each, in double, and none in lanes.
template <class Real>
void panoramic_rays(const CameraFrame& frame, const kernels::TileView& tile, const PixelPoint& point,
                    VectorBuffer<Real>& directions);

/// How far all rays of a camera are moved along at once; see lead_of() in graph/site.hpp.
double lead_of(const CameraFrame& frame, const Site& site, double min_distance);

/// A tile's rays that begin `lead` from where the camera has them, found in double; NaN outside of the picture. Directions
/// are not written where all rays have one.
template <class Real>
void leading_rays(const CameraFrame& frame, const kernels::TileView& tile, const PixelPoint& point, double lead,
                  VectorBuffer<Real>& origins, VectorBuffer<Real>& directions);

template <class Real>
kernels::CameraView<Real> view(const CameraFrame& frame, const PixelPoint& point) {
  const auto real = [](double value) { return static_cast<Real>(value); };
  return {frame.kind == CameraKind::kPerspective,
          {real(frame.corner.x), real(frame.corner.y), real(frame.corner.z)},
          {real(frame.right.x), real(frame.right.y), real(frame.right.z)},
          {real(frame.down.x), real(frame.down.y), real(frame.down.z)},
          {real(point.x), real(point.y)}};
}

}  // namespace octomarch
