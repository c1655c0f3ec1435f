// Camera rays. The scene's camera comes before it; whatever looks at a picture pixel by pixel asks it.
#pragma once

#include <cmath>
#include <numbers>

#include "octomarch/graph/scene.hpp"

namespace octomarch::reference {

/// A ray through a point of a pixel; its direction has unit length. Half the pixel's height at parameter t is the larger of
/// pixel_radius and pixel_slope·t.
struct PixelRay {
  Vec3 origin;
  Vec3 direction;
  double pixel_radius;
  double pixel_slope;
};

/// Makes the ray through a point of each pixel; see Camera for the formulas.
class Lens {
 public:
  /// Contract: `camera` outlives this.
  Lens(const Camera& camera, double width, double height)
      : camera_(camera),
        width_(width),
        height_(height),
        forward_(normalized(camera.target - camera.eye)),
        right_(normalized(cross(forward_, camera.up))),
        up_(cross(right_, forward_)),
        half_height_(camera.kind == CameraKind::kPerspective ? std::tan(camera.fov * std::numbers::pi / 360.0)
                                                             : 0.5 * camera.height) {}

  /// Along the view, of unit length.
  const Vec3& forward() const { return forward_; }

  /// `x` and `y` count pixels from the upper left corner of the picture.
  PixelRay ray(double x, double y) const {
    if (camera_.kind == CameraKind::kPanoramic) return panoramic(x, y);
    const double s = (2.0 * x / width_ - 1.0) * width_ / height_;
    const double r = 1.0 - 2.0 * y / height_;
    const Vec3 offset = (right_ * s + up_ * r) * half_height_;
    const double pixel = half_height_ / height_;
    if (camera_.kind == CameraKind::kOrthographic) return {camera_.eye + offset, forward_, pixel, 0.0};
    return {camera_.eye, normalized(forward_ + offset), 0.0, pixel};
  }

 private:
  PixelRay panoramic(double x, double y) const {
    constexpr double kDegree = std::numbers::pi / 180.0;
    const double longitude = (x / width_ - 0.5) * camera_.fov_across * kDegree;
    const double latitude = (0.5 - y / height_) * camera_.fov * kDegree;
    const Vec3 level = forward_ * std::cos(longitude) + right_ * std::sin(longitude);
    const Vec3 direction = level * std::cos(latitude) + up_ * std::sin(latitude);
    return {camera_.eye, direction, 0.0, 0.5 * camera_.fov * kDegree / height_};
  }

  const Camera& camera_;
  double width_;
  double height_;
  Vec3 forward_;
  Vec3 right_;
  Vec3 up_;
  double half_height_;  // of the picture, at unit distance for perspective
};

}  // namespace octomarch::reference
