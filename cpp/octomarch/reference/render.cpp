// Camera rays and the loop over pixels; see render.hpp.
#include "octomarch/reference/render.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include "octomarch/reference/shade.hpp"

namespace octomarch::reference {
namespace {

/// Makes the ray through a point of each pixel; see Camera for the formulas.
/// Rays are moved along as far as the site says.
class Lens {
 public:
  Lens(const Camera& camera, double width, double height, const Site& site, double min_distance)
      : camera_(camera),
        width_(width),
        height_(height),
        forward_(normalized(camera.target - camera.eye)),
        right_(normalized(cross(forward_, camera.up))),
        up_(cross(right_, forward_)),
        half_height_(camera.kind == CameraKind::kPerspective ? std::tan(camera.fov * std::numbers::pi / 360.0)
                                                             : 0.5 * camera.height),
        lead_(camera.kind == CameraKind::kOrthographic ? parallel_lead_of(site, camera.eye, forward_, min_distance)
                                                       : lead_of(site, camera.eye, min_distance)) {}

  double lead() const { return lead_; }

  /// `x` and `y` count pixels from the upper left corner of the picture.
  template <class T>
  Ray<T> ray(double x, double y) const {
    if (camera_.kind == CameraKind::kPanoramic) return panoramic<T>(x, y);
    const double s = (2.0 * x / width_ - 1.0) * width_ / height_;
    const double r = 1.0 - 2.0 * y / height_;
    const Vec3 offset = (right_ * s + up_ * r) * half_height_;
    const double pixel = half_height_ / height_;
    if (camera_.kind == CameraKind::kOrthographic) return moved<T>(camera_.eye + offset, forward_, pixel, 0.0);
    return moved<T>(camera_.eye, normalized(forward_ + offset), 0.0, pixel);
  }

 private:
  template <class T>
  Ray<T> panoramic(double x, double y) const {
    constexpr double kDegree = std::numbers::pi / 180.0;
    const double longitude = (x / width_ - 0.5) * camera_.fov_across * kDegree;
    const double latitude = (0.5 - y / height_) * camera_.fov * kDegree;
    const Vec3 level = forward_ * std::cos(longitude) + right_ * std::sin(longitude);
    const Vec3 direction = level * std::cos(latitude) + up_ * std::sin(latitude);
    return moved<T>(camera_.eye, direction, 0.0, 0.5 * camera_.fov * kDegree / height_);
  }

  template <class T>
  Ray<T> moved(const Vec3& origin, const Vec3& direction, double pixel_radius, double pixel_slope) const {
    const Vec3 start = lead_ > 0.0 ? origin + direction * lead_ : origin;
    return {vector<T>(start), vector<T>(direction), T(pixel_radius + pixel_slope * lead_), T(pixel_slope), lead_};
  }

  const Camera& camera_;
  double width_;
  double height_;
  Vec3 forward_;
  Vec3 right_;
  Vec3 up_;
  double half_height_;  // of the picture, at unit distance for perspective
  double lead_;
};

/// Draws single pixels of one picture. Keeps references to its arguments.
template <class T>
class Pixels {
 public:
  Pixels(Evaluator<T>& field, const Scene& scene, const Lens& lens, const MarchLimits<T>& limits,
         const MarchLimits<T>& moved_limits, const Shading& shading, int samples, const Vec3& anchor)
      : field_(field),
        lens_(lens),
        limits_(moved_limits),
        anchor_(anchor),
        shader_(field, scene, shading, limits),
        normals_(shading),
        samples_(sample_points(samples)) {}

  /// The mean over the samples of a pixel.
  Vector<T> color(std::uint32_t column, std::uint32_t row) {
    Vector<double> sum(0);
    for (const PixelPoint& point : samples_) {
      const Ray<T> ray = lens_.ray<T>(column + point.x, row + point.y);
      const Arrival<T> arrival = march_ray(field_, ray, limits_);
      sum += Vector<double>(shader_.radiance(ray, arrival, surface_at(field_, ray, arrival, normals_)));
    }
    return Vector<T>(sum / static_cast<double>(samples_.size()));
  }

  /// Stores what the ray through a pixel's centre found as element `i` of the planes.
  void store_centre(std::uint32_t column, std::uint32_t row, const Planes<T>& planes, std::size_t i) const {
    const Ray<T> ray = lens_.ray<T>(column + 0.5, row + 0.5);
    const Arrival<T> arrival = march_ray(field_, ray, limits_);
    const bool needs_surface = !(planes.position.empty() && planes.normal.empty() && planes.material_id.empty());
    const Surface<T> surface = needs_surface ? surface_at(field_, ray, arrival, normals_) : Surface<T>{};
    store(planes.depth, i, from_far(lens_.lead(), arrival.t));
    store(planes.position, i, has_surface(arrival.status) ? from_far(anchor_, surface.position) : surface.position);
    store(planes.normal, i, surface.normal);
    store(planes.material_id, i, static_cast<std::int32_t>(surface.material));
    store(planes.steps, i, static_cast<std::int32_t>(arrival.steps));
    store(planes.status, i, static_cast<std::uint8_t>(arrival.status));
  }

 private:
  Evaluator<T>& field_;
  const Lens& lens_;
  const MarchLimits<T>& limits_;  // of rays that the lens has moved
  const Vec3 anchor_;
  Shader<T> shader_;
  const NormalRule<T> normals_;
  const std::vector<PixelPoint> samples_;
};

/// True when a plane beside the colours is wanted.
template <class T>
bool wants_centre(const Planes<T>& planes) {
  return !(planes.depth.empty() && planes.position.empty() && planes.normal.empty() && planes.material_id.empty() &&
           planes.steps.empty() && planes.status.empty());
}

}  // namespace

template <class T>
void render(const NodePtr& root, const Scene& whole_scene, const Camera& whole_camera, const March& march,
            const Shading& shading, const Extent& extent, const Compiled& compiled, const Planes<T>& planes,
            const Poll& poll) {
  const double rounding = static_cast<double>(T(16) * kUnitRoundoff<T>);
  const Vec3 anchor = anchor_seen_from(compiled.site, whole_camera.eye, rounding, march.least_epsilon());
  const Site site = counted_from(anchor, compiled.site);
  const Scene scene = counted_from(anchor, whole_scene);
  const Camera camera = counted_from(anchor, whole_camera);
  Evaluator<T> field(root, poll, anchor);
  const Lens lens(camera, extent.width, extent.height, site, march.min_distance);
  const MarchLimits<T> limits(march, compiled.lipschitz, site);
  MarchLimits<T> moved_limits = limits;
  moved_limits.move(march, site, lens.lead(), march.max_distance);
  Pixels<T> pixels(field, scene, lens, limits, moved_limits, shading, extent.samples, anchor);
  const Crop& crop = extent.crop;
  std::size_t i = 0;
  for (std::uint32_t row = crop.y; row < crop.y + crop.height; ++row) {
    for (std::uint32_t column = crop.x; column < crop.x + crop.width; ++column, ++i) {
      if (!planes.color.empty()) store(planes.color, i, pixels.color(column, row));
      if (wants_centre(planes)) pixels.store_centre(column, row, planes, i);
    }
  }
}

template void render(const NodePtr&, const Scene&, const Camera&, const March&, const Shading&, const Extent&,
                     const Compiled&, const Planes<float>&, const Poll&);
template void render(const NodePtr&, const Scene&, const Camera&, const March&, const Shading&, const Extent&,
                     const Compiled&, const Planes<double>&, const Poll&);

}  // namespace octomarch::reference
