// Colour of surface points: ambient light less occlusion, plus each light's diffuse and specular part times what its
// shadow rays let through. Stage by stage over a whole batch, each in lanes; a stage that a scene does not ask for does
// not run. Comes after material_pass.hpp; radiance.hpp puts it together with the sky.
#pragma once

#include "octomarch/render/material_pass.hpp"
#include "octomarch/render/render.hpp"
#include "octomarch/render/surface_pass.hpp"

namespace octomarch {

template <class Real>
class Illumination {
 public:
  Illumination(const Picture& picture, const kernels::KernelTable<Real>& kernels, std::size_t size);

  /// Does the scene have lights, or ambient light with occlusion?
  bool needs_normals() const { return has_occlusion() || !picture_.scene->lights.empty(); }

  /// Sums the colour of every point of `surface`, whose materials, and normals where they are needed, are known.
  void run(SurfacePass<Real>& surface, MaterialPass<Real>& materials, const bool& cancelled, RenderStats& stats);

  /// The colour of every surface point.
  const VectorBuffer<Real>& color() const { return color_; }

 private:
  bool has_occlusion() const;
  void add_ambient(SurfacePass<Real>& surface, const VectorBuffer<Real>& albedo, const bool& cancelled,
                   RenderStats& stats);
  void find_occlusion(SurfacePass<Real>& surface, const bool& cancelled, StageStats& stage);
  /// Rows of shadow rays.
  struct ShadowRays {
    const VectorBuffer<Real>& origin;
    const VectorBuffer<Real>& direction;
    const Buffer<Real>& distance;
    Buffer<Real>& visibility;
  };
  ShadowRays find_lit(const SurfacePass<Real>& surface);
  void cast_shadows(SurfacePass<Real>& surface, const Light& light, const bool& cancelled, RenderStats& stats);

  kernels::LightView<Real> light_view(const Light& light) const;
  kernels::LightSamples<Real> samples() {
    return {toward_.view(), distance_.data(), cosine_.data(), strength_.data(), visibility_.data()};
  }

  const Picture& picture_;
  const kernels::KernelTable<Real>& kernels_;
  VectorBuffer<Real> color_, toward_;
  Buffer<Real> distance_, cosine_, strength_, visibility_, ambient_;
  VectorBuffer<Real> above_;  ///< where occlusion is sampled
  Buffer<Real> field_above_;
  // shadow rays, gathered where a light is above the horizon of some surface points only
  IndexList lit_;
  RayBatch<Real> shadow_;
  Buffer<Real> shadow_distance_, shadow_epsilon_, shadow_visibility_;
};

}  // namespace octomarch
