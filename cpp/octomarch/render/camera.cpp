#include "octomarch/render/camera.hpp"

#include <numbers>

namespace octomarch {

CameraFrame frame(const Camera& camera, std::uint32_t width, std::uint32_t height) {
  const Vec3 w = normalized(camera.target - camera.eye);
  const Vec3 u = normalized(cross(w, camera.up));
  const Vec3 v = cross(u, w);
  const bool perspective = camera.kind == CameraKind::kPerspective;
  const double half = perspective ? std::tan(camera.fov * std::numbers::pi / 360.0) : camera.height / 2.0;
  const double aspect = static_cast<double>(width) / static_cast<double>(height);

  CameraFrame result{};
  result.perspective = perspective;
  result.fixed = perspective ? camera.eye : w;
  result.corner = (perspective ? w : camera.eye) - u * (half * aspect) + v * half;
  result.right = u * (2.0 * half * aspect / static_cast<double>(width));
  result.down = v * (-2.0 * half / static_cast<double>(height));
  const double pixel = half / static_cast<double>(height);
  result.pixel_slope = perspective ? pixel : 0.0;
  result.pixel_radius = perspective ? 0.0 : pixel;
  return result;
}

}  // namespace octomarch
