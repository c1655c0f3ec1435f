#include "octomarch/render/camera.hpp"

#include <numbers>
#include <vector>

#include "octomarch/render/tile_pixels.hpp"

namespace octomarch {

namespace {

constexpr double kRadians = std::numbers::pi / 180.0;  // per degree

CameraFrame panoramic(const Camera& camera, const Vec3& right, const Vec3& up, const Vec3& forward, double width,
                      double height) {
  const double across = camera.fov_across * kRadians;
  const double down = camera.fov * kRadians;
  CameraFrame result{};
  result.kind = camera.kind;
  result.fixed = camera.eye;
  result.corner = forward;
  result.right = right;
  result.down = up * -1.0;
  result.pixel_slope = 0.5 * down / height;
  result.longitude = -0.5 * across;
  result.latitude = 0.5 * down;
  result.column = across / width;
  result.row = down / height;
  return result;
}

}  // namespace

CameraFrame frame(const Camera& camera, std::uint32_t width, std::uint32_t height) {
  const Vec3 w = normalized(camera.target - camera.eye);
  const Vec3 u = normalized(cross(w, camera.up));
  const Vec3 v = cross(u, w);
  if (camera.kind == CameraKind::kPanoramic) return panoramic(camera, u, v, w, width, height);
  const bool perspective = camera.kind == CameraKind::kPerspective;
  const double half = perspective ? std::tan(camera.fov * std::numbers::pi / 360.0) : camera.height / 2.0;
  const double aspect = static_cast<double>(width) / static_cast<double>(height);

  CameraFrame result{};
  result.kind = camera.kind;
  result.fixed = perspective ? camera.eye : w;
  result.corner = (perspective ? w : camera.eye) - u * (half * aspect) + v * half;
  result.right = u * (2.0 * half * aspect / static_cast<double>(width));
  result.down = v * (-2.0 * half / static_cast<double>(height));
  const double pixel = half / static_cast<double>(height);
  result.pixel_slope = perspective ? pixel : 0.0;
  result.pixel_radius = perspective ? 0.0 : pixel;
  return result;
}

double lead_of(const CameraFrame& frame, const Site& site, double min_distance) {
  if (frame.one_origin()) return lead_of(site, frame.fixed, min_distance);
  return parallel_lead_of(site, frame.corner, frame.fixed, min_distance);
}

template <class Real>
void panoramic_rays(const CameraFrame& frame, const kernels::TileView& tile, const PixelPoint& point,
                    VectorBuffer<Real>& directions) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const std::size_t width = std::size_t{tile.blocks_across} * kernels::kBlockEdge;
  const std::size_t height = std::size_t{tile.blocks_down} * kernels::kBlockEdge;
  std::vector<Vec3> level(width);  // of each column, the direction at latitude 0; NaN outside the picture
  for (std::size_t i = 0; i < width; ++i) {
    const double longitude = frame.longitude + (static_cast<double>(tile.x + i) + point.x) * frame.column;
    level[i] = frame.corner * std::cos(longitude) + frame.right * std::sin(longitude);
    if (tile.x + i >= tile.width) level[i] = {kNone, kNone, kNone};
  }
  std::vector<double> cosine(height);  // of each row, of its latitude; NaN likewise
  std::vector<Vec3> rise(height);
  for (std::size_t j = 0; j < height; ++j) {
    const double latitude = frame.latitude - (static_cast<double>(tile.y + j) + point.y) * frame.row;
    cosine[j] = tile.y + j < tile.height ? std::cos(latitude) : kNone;
    rise[j] = frame.down * -std::sin(latitude);
  }
  for (std::size_t ray = 0; ray < tile.rays(); ++ray) {
    const Pixel pixel = pixel_of(tile, ray);
    const std::size_t i = pixel.x - tile.x;
    const std::size_t j = pixel.y - tile.y;
    const Vec3 direction = level[i] * cosine[j] + rise[j];
    directions.x[ray] = static_cast<Real>(direction.x);
    directions.y[ray] = static_cast<Real>(direction.y);
    directions.z[ray] = static_cast<Real>(direction.z);
  }
}

template <class Real>
void leading_rays(const CameraFrame& frame, const kernels::TileView& tile, const PixelPoint& point, double lead,
                  VectorBuffer<Real>& origins, VectorBuffer<Real>& directions) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const bool is_panoramic = frame.kind == CameraKind::kPanoramic;
  VectorBuffer<double> around(is_panoramic ? tile.rays() : 0);
  if (is_panoramic) panoramic_rays(frame, tile, point, around);
  const auto set = [](VectorBuffer<Real>& rows, std::size_t ray, const Vec3& v) {
    rows.x[ray] = static_cast<Real>(v.x);
    rows.y[ray] = static_cast<Real>(v.y);
    rows.z[ray] = static_cast<Real>(v.z);
  };
  for (std::size_t ray = 0; ray < tile.rays(); ++ray) {
    const Pixel pixel = pixel_of(tile, ray);
    const double x = pixel.x < tile.width && pixel.y < tile.height ? pixel.x + point.x : kNone;
    const Vec3 sum = frame.corner + frame.right * x + frame.down * (pixel.y + point.y);
    if (!frame.one_origin()) {
      set(origins, ray, sum + frame.fixed * lead);
      continue;
    }
    const Vec3 direction = is_panoramic ? Vec3{around.x[ray], around.y[ray], around.z[ray]} : normalized(sum);
    set(origins, ray, frame.fixed + direction * lead);
    set(directions, ray, direction);
  }
}

template void leading_rays(const CameraFrame&, const kernels::TileView&, const PixelPoint&, double,
                           VectorBuffer<float>&, VectorBuffer<float>&);
template void leading_rays(const CameraFrame&, const kernels::TileView&, const PixelPoint&, double,
                           VectorBuffer<double>&, VectorBuffer<double>&);
template void panoramic_rays(const CameraFrame&, const kernels::TileView&, const PixelPoint&, VectorBuffer<float>&);
template void panoramic_rays(const CameraFrame&, const kernels::TileView&, const PixelPoint&, VectorBuffer<double>&);

}  // namespace octomarch
