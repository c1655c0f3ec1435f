// Camera rays and the loop over pixels; see render.hpp.
#include "octomarch/reference/render.hpp"

#include <vector>

#include "octomarch/reference/lens.hpp"
#include "octomarch/reference/shade.hpp"

namespace octomarch::reference {
namespace {

/// Makes the ray through a point of each pixel, moved along as far as the site says.
class MovedLens {
 public:
  MovedLens(const Camera& camera, double width, double height, const Site& site, double min_distance)
      : lens_(camera, width, height),
        lead_(camera.kind == CameraKind::kOrthographic
                  ? parallel_lead_of(site, camera.eye, lens_.forward(), min_distance)
                  : lead_of(site, camera.eye, min_distance)) {}

  double lead() const { return lead_; }

  /// `x` and `y` count pixels from the upper left corner of the picture.
  template <class T>
  Ray<T> ray(double x, double y) const {
    const PixelRay ray = lens_.ray(x, y);
    const Vec3 start = lead_ > 0.0 ? ray.origin + ray.direction * lead_ : ray.origin;
    return {vector<T>(start), vector<T>(ray.direction), T(ray.pixel_radius + ray.pixel_slope * lead_),
            T(ray.pixel_slope), lead_};
  }

 private:
  Lens lens_;
  double lead_;
};

/// Draws single pixels of one picture. Keeps references to its arguments.
template <class T>
class Pixels {
 public:
  Pixels(Evaluator<T>& field, const Scene& scene, const MovedLens& lens, const MarchLimits<T>& limits,
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
  const MovedLens& lens_;
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
  const MovedLens lens(camera, extent.width, extent.height, site, march.min_distance);
  const MarchLimits<T> limits(march, compiled, site);
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
