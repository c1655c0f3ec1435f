// Camera rays and the loop over pixels; see render.hpp.
#include "octomarch/reference/render.hpp"

#include <cmath>
#include <numbers>

#include "octomarch/reference/shade.hpp"

namespace octomarch::reference {
namespace {

/// Makes the ray through a point of each pixel; see Camera for the formulas.
class Lens {
 public:
  Lens(const Camera& camera, double width, double height)
      : camera_(camera),
        width_(width),
        height_(height),
        forward_(normalized(camera.target - camera.eye)),
        right_(normalized(cross(forward_, camera.up))),
        up_(cross(right_, forward_)),
        half_height_(camera.kind == CameraKind::kPerspective ? std::tan(camera.fov * std::numbers::pi / 360.0)
                                                             : 0.5 * camera.height) {}

  /// `x` and `y` count pixels from the upper left corner of the picture.
  template <class T>
  Ray<T> ray(double x, double y) const {
    if (camera_.kind == CameraKind::kPanoramic) return panoramic<T>(x, y);
    const double s = (2.0 * x / width_ - 1.0) * width_ / height_;
    const double r = 1.0 - 2.0 * y / height_;
    const Vec3 offset = (right_ * s + up_ * r) * half_height_;
    const T pixel = T(half_height_ / height_);
    if (camera_.kind == CameraKind::kOrthographic) {
      return {vector<T>(camera_.eye + offset), vector<T>(forward_), pixel, T(0)};
    }
    return {vector<T>(camera_.eye), vector<T>(normalized(forward_ + offset)), T(0), pixel};
  }

 private:
  template <class T>
  Ray<T> panoramic(double x, double y) const {
    constexpr double kDegree = std::numbers::pi / 180.0;
    const double longitude = (x / width_ - 0.5) * camera_.fov_across * kDegree;
    const double latitude = (0.5 - y / height_) * camera_.fov * kDegree;
    const Vec3 level = forward_ * std::cos(longitude) + right_ * std::sin(longitude);
    const Vec3 direction = level * std::cos(latitude) + up_ * std::sin(latitude);
    return {vector<T>(camera_.eye), vector<T>(direction), T(0), T(0.5 * camera_.fov * kDegree / height_)};
  }

  const Camera& camera_;
  double width_;
  double height_;
  Vec3 forward_;
  Vec3 right_;
  Vec3 up_;
  double half_height_;  // of the picture, at unit distance for perspective
};

/// True when a plane is wanted that says more of a ray than how far it came.
template <class T>
bool wants_surface(const Planes<T>& planes) {
  return !(planes.color.empty() && planes.position.empty() && planes.normal.empty() && planes.material_id.empty());
}

}  // namespace

template <class T>
void render(const NodePtr& root, const Scene& scene, const Camera& camera, const March& march, const Shading& shading,
            const Extent& extent, double lipschitz, const Planes<T>& planes, const Poll& poll) {
  Evaluator<T> field(root, poll);
  const Lens lens(camera, extent.width, extent.height);
  const MarchLimits<T> limits(march, lipschitz);
  const Shader<T> shader(field, scene, shading, limits);
  const T normal_step = shading.normals == Normals::kCentral ? T(shading.normal_step) : T(0);
  const bool needs_surface = wants_surface(planes);
  std::size_t pixel = 0;
  const Crop& crop = extent.crop;
  for (std::uint32_t row = crop.y; row < crop.y + crop.height; ++row) {
    for (std::uint32_t column = crop.x; column < crop.x + crop.width; ++column, ++pixel) {
      const Ray<T> ray = lens.ray<T>(column + 0.5, row + 0.5);
      const Arrival<T> arrival = march_ray(field, ray, limits);
      const Surface<T> surface = needs_surface ? surface_at(field, ray, arrival, normal_step) : Surface<T>{};
      if (!planes.color.empty()) store(planes.color, pixel, shader.radiance(ray, arrival, surface));
      store(planes.depth, pixel, arrival.t);
      store(planes.position, pixel, surface.position);
      store(planes.normal, pixel, surface.normal);
      store(planes.material_id, pixel, static_cast<std::int32_t>(surface.material));
      store(planes.steps, pixel, static_cast<std::int32_t>(arrival.steps));
      store(planes.status, pixel, static_cast<std::uint8_t>(arrival.status));
    }
  }
}

template void render(const NodePtr&, const Scene&, const Camera&, const March&, const Shading&, const Extent&, double,
                     const Planes<float>&, const Poll&);
template void render(const NodePtr&, const Scene&, const Camera&, const March&, const Shading&, const Extent&, double,
                     const Planes<double>&, const Poll&);

}  // namespace octomarch::reference
