// What pictures share whoever draws them: how rough a material's highlight is, and where the samples of a pixel lie. Scene
// data come before it; the renderer and the scalar reference come after.
#include "octomarch/graph/scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "octomarch/graph/builder.hpp"

namespace octomarch {

const Material& default_material() {
  static const Material material{
      {constant(0.8), constant(0.8), constant(0.8), constant(0.5), constant(0.3), constant(0.0), constant(0.0)}};
  return material;
}

double phong_exponent(double roughness) {
  const double alpha = roughness * roughness;
  return std::clamp(2.0 / (alpha * alpha) - 2.0, 1.0, 8192.0);
}

std::vector<PixelPoint> sample_points(int count) {
  const auto key = [](int k) {
    const double x = 0.5 + k / std::numbers::phi;
    return x - std::floor(x);
  };
  std::vector<PixelPoint> points;
  for (int k = 0; k < count; ++k) {
    int rank = 0;
    for (int other = 0; other < count; ++other) rank += key(other) < key(k) ? 1 : 0;
    points.push_back({(k + 0.5) / count, (rank + 0.5) / count});
  }
  return points;
}

Scene counted_from(const Vec3& origin, Scene scene) {
  for (Light& light : scene.lights) {
    if (light.kind != LightKind::kDirectional) light.vector = light.vector - origin;
  }
  return scene;
}

Camera counted_from(const Vec3& origin, Camera camera) {
  camera.eye = camera.eye - origin;
  camera.target = camera.target - origin;
  return camera;
}

}  // namespace octomarch
