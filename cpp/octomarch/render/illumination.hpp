// Colour of surface points: ambient light less occlusion, plus each light's diffuse and specular part times what its
// shadow rays let through. Stage by stage over a whole batch, each in lanes; a stage that a scene does not ask for does
// not run. Comes after surface_pass.hpp.
#pragma once

#include "octomarch/render/render.hpp"
#include "octomarch/render/surface_pass.hpp"

namespace octomarch {

template <class Real>
class Illumination {
 public:
  Illumination(const Picture& picture, const kernels::KernelTable<Real>& kernels, std::size_t size);

  /// Sums the colour of every point of `surface`, whose normals (and, with several materials, objects) are known.
  void run(SurfacePass<Real>& surface, const bool& cancelled, RenderStats& stats);

  /// Colour of surface point i. A candidate (STEP_LIMIT) whose surface faces away is none: it shows the sky.
  Vec3 color(const SurfacePass<Real>& surface, std::size_t i) const;

 private:
  void set_materials(const SurfacePass<Real>& surface);
  void add_ambient(SurfacePass<Real>& surface, const bool& cancelled, RenderStats& stats);
  void cast_shadows(SurfacePass<Real>& surface, const Light& light, const bool& cancelled, RenderStats& stats);

  kernels::LightView<Real> light_view(const Light& light) const;
  kernels::LightSamples<Real> samples() {
    return {toward_.view(), distance_.data(), cosine_.data(), visibility_.data()};
  }
  kernels::MaterialView<Real> materials() {
    return {albedo_.view(), diffuse_.data(), specular_.data(), metallic_.data(), exponent_.data(), color_.view()};
  }

  /// A material as the kernels take it, converted once.
  struct MaterialTerms {
    Real red, green, blue, diffuse, specular, metallic, exponent;
  };

  const Picture& picture_;
  const kernels::KernelTable<Real>& kernels_;
  std::vector<MaterialTerms> materials_;
  VectorBuffer<Real> albedo_, color_, toward_;
  Buffer<Real> diffuse_, specular_, metallic_, exponent_;
  Buffer<Real> distance_, cosine_, visibility_, ambient_;
  // shadow rays, gathered where a light is above the surface's horizon
  std::vector<std::size_t> lit_;
  VectorBuffer<Real> shadow_origin_, shadow_direction_;
  Buffer<Real> shadow_distance_, shadow_epsilon_, shadow_visibility_;
};

/// Radiance of a ray that hits nothing.
template <class Real>
Vec3 sky_color(const Sky& sky, Real dx, Real dy, Real dz) {
  const Real facing =
      dx * static_cast<Real>(sky.axis.x) + dy * static_cast<Real>(sky.axis.y) + dz * static_cast<Real>(sky.axis.z);
  const auto toward = static_cast<double>(std::max(facing, Real(0)));
  const auto away = static_cast<double>(std::max(-facing, Real(0)));
  return sky.base + sky.toward * toward + sky.away * away;
}

}  // namespace octomarch
