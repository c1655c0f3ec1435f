// What light comes back along rays that have been marched: from the surfaces that they found, from the sky where they
// found none, and from what they see in mirrors. Mirror rays go in waves: those of all surface points of a batch are
// marched and lit together, like the rays before them. Comes after surface_pass.hpp; tile.hpp writes the result.
#pragma once

#include <memory>

#include "octomarch/render/illumination.hpp"
#include "octomarch/render/material_pass.hpp"
#include "octomarch/render/render.hpp"
#include "octomarch/render/sky_pass.hpp"
#include "octomarch/render/surface_pass.hpp"

namespace octomarch {

template <class Real>
class Radiance {
 public:
  /// `sky`: the scene's, compiled; must outlive this.
  Radiance(const Picture& picture, const Expressions& sky, const kernels::KernelTable<Real>& kernels, std::size_t size);

  /// Does anything look at normals: lights, occlusion, mirrors or materials? Else only candidates do, which may face away.
  bool needs_normals() const { return needs_normals_; }

  /// Sets color[i] of each of `count` rays to what it sees, mirrors apart. `surface` holds the surface points of the
  /// batch, with normals where they are needed.
  void light(const RayBatch<Real>& batch, const RayColumns<Real>& rays, std::size_t count, SurfacePass<Real>& surface,
             const bool& cancelled, RenderStats& stats);

  /// Adds what is seen in mirrors. Comes after light(), and leaves other points in `surface`.
  void follow_mirrors(SurfacePass<Real>& surface, const bool& cancelled, RenderStats& stats);

  VectorBuffer<Real> color;

 private:
  struct MirrorRays {
    explicit MirrorRays(std::size_t size)
        : batch(size), epsilon(size), origin(size), direction(size), root(size), share(size) {}

    RayBatch<Real> batch;
    Buffer<Real> epsilon;
    VectorBuffer<Real> origin, direction;  ///< of all surface points, before those that reflect are gathered
    // the ray of the batch to which each ray's light goes, and its share in that
    Buffer<std::uint32_t> root;
    Buffer<Real> share;
  };

  void light_wave(const RayBatch<Real>& batch, const RayColumns<Real>& rays, std::size_t count,
                  SurfacePass<Real>& surface, const bool& cancelled, RenderStats& stats);
  void add_surfaces(SurfacePass<Real>& surface, std::size_t count);
  void add_sky(const bool& cancelled, RenderStats& stats);
  Real share(std::size_t ray) const { return first_wave_ ? Real(1) : mirror_->share[ray]; }
  std::size_t root(std::size_t ray) const { return first_wave_ ? ray : mirror_->root[ray]; }
  void add_all(const VectorBuffer<Real>& light, std::size_t count);
  void add(std::size_t ray, Real share, const VectorBuffer<Real>& light, std::size_t i);
  void cast_mirror_rays(SurfacePass<Real>& surface);

  const Picture& picture_;
  const kernels::KernelTable<Real>& kernels_;
  MaterialPass<Real> materials_;
  Illumination<Real> illumination_;
  SkyPass<Real> sky_;
  bool needs_normals_;
  int bounces_left_ = 0;
  bool first_wave_ = true;
  IndexList mirrors_;  ///< surface points whose mirror rays are followed
  std::unique_ptr<MirrorRays> mirror_;
};

}  // namespace octomarch
