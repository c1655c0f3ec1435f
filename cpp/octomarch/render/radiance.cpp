#include "octomarch/render/radiance.hpp"

namespace octomarch {

template <class Real>
Radiance<Real>::Radiance(const Picture& picture, const Expressions& sky, const kernels::KernelTable<Real>& kernels,
                         std::size_t size)
    : color(size),
      picture_(picture),
      kernels_(kernels),
      materials_(*picture.program, kernels, size),
      illumination_(picture, kernels, size),
      sky_(sky, kernels, size),
      needs_normals_(illumination_.needs_normals() || picture.program->surface().uses_normal() ||
                     (materials_.reflects() && picture.shading.bounces > 0)),
      mirrors_(size) {}

template <class Real>
void Radiance<Real>::light(const RayBatch<Real>& batch, const RayColumns<Real>& rays, std::size_t count,
                           SurfacePass<Real>& surface, const bool& cancelled, RenderStats& stats) {
  for (Buffer<Real>* channel : {&color.x, &color.y, &color.z}) std::fill_n(channel->data(), count, Real(0));
  first_wave_ = true;
  bounces_left_ = materials_.reflects() ? picture_.shading.bounces : 0;
  light_wave(batch, rays, count, surface, cancelled, stats);
}

template <class Real>
void Radiance<Real>::follow_mirrors(SurfacePass<Real>& surface, const bool& cancelled, RenderStats& stats) {
  while (!mirrors_.empty() && !is_set(cancelled)) {
    const std::size_t count = mirrors_.size();
    cast_mirror_rays(surface);
    --bounces_left_;
    RayBatch<Real>& batch = mirror_->batch;
    const RayColumns<Real> columns = own_columns(batch.origin, batch.direction, mirror_->epsilon);
    const kernels::MarchParameters<Real> parameters =
        secondary_parameters(*picture_.program, picture_.march, columns.epsilon_slope, cancelled);
    const kernels::Column<Real> t_max{nullptr, clamped<Real>(picture_.march.max_distance)};
    {
      const ScopedTimer timer(stats.reflection.seconds);
      stats.reflection.count += count;
      surface.field().march(columns.view({}, t_max, count), parameters, batch, nullptr, stats.reflection);
    }
    if (is_set(cancelled)) return;
    surface.gather(batch, columns, count);
    surface.find_normals(picture_.shading, cancelled, stats.normals);
    light_wave(batch, columns, count, surface, cancelled, stats);
  }
}

/// Adds the light of a wave of rays, and notes which of its surfaces have mirror rays to follow.
template <class Real>
void Radiance<Real>::light_wave(const RayBatch<Real>& batch, const RayColumns<Real>& rays, std::size_t count,
                                SurfacePass<Real>& surface, const bool& cancelled, RenderStats& stats) {
  materials_.run(surface, cancelled, stats.materials);
  illumination_.run(surface, materials_, cancelled, stats);
  add_surfaces(surface, count);

  sky_.clear();
  const auto look = [&](std::size_t ray) {
    sky_.add(ray, RayColumns<Real>::at(rays.dx, ray), RayColumns<Real>::at(rays.dy, ray),
             RayColumns<Real>::at(rays.dz, ray));
  };
  for (std::size_t ray = 0; ray < count; ++ray) {
    if (static_cast<Status>(batch.status[ray]) == Status::kMiss) look(ray);
  }
  for (std::size_t i = 0; surface.has_candidates() && i < surface.count(); ++i) {
    if (surface.is_nothing(i)) look(surface.ray(i));
  }
  add_sky(cancelled, stats);
}

template <class Real>
void Radiance<Real>::add_surfaces(SurfacePass<Real>& surface, std::size_t count) {
  mirrors_.clear();
  if (first_wave_ && bounces_left_ == 0 && !surface.has_candidates() && surface.count() == count) {
    add_all(illumination_.color(), count);
    return;
  }
  const Real cutoff = clamped<Real>(picture_.shading.reflection_cutoff);
  const Real* const reflectivity = materials_.view().reflectivity;
  for (std::size_t i = 0; i < surface.count(); ++i) {
    if (surface.is_nothing(i)) continue;
    const std::size_t ray = surface.ray(i);
    Real own = share(ray);
    if (bounces_left_ > 0) {
      const Real mirrored = own * reflectivity[i];
      if (mirrored > Real(0) && mirrored >= cutoff) {
        mirrors_.push(i);
        own *= Real(1) - reflectivity[i];
      }
    }
    add(ray, own, illumination_.color(), i);
  }
}

template <class Real>
void Radiance<Real>::add_sky(const bool& cancelled, RenderStats& stats) {
  sky_.run(cancelled, stats.sky);
  for (std::size_t i = 0; i < sky_.count(); ++i) add(sky_.ray(i), share(sky_.ray(i)), sky_.color, i);
}

template <class Real>
void Radiance<Real>::add(std::size_t ray, Real share, const VectorBuffer<Real>& light, std::size_t i) {
  const std::size_t at = root(ray);
  color.x[at] += share * light.x[i];
  color.y[at] += share * light.y[i];
  color.z[at] += share * light.z[i];
}

/// Adds light to every ray: the i-th to ray i.
template <class Real>
void Radiance<Real>::add_all(const VectorBuffer<Real>& light, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) color.x[i] += light.x[i];
  for (std::size_t i = 0; i < count; ++i) color.y[i] += light.y[i];
  for (std::size_t i = 0; i < count; ++i) color.z[i] += light.z[i];
}

/// Makes the next wave of the surface points in mirrors_.
template <class Real>
void Radiance<Real>::cast_mirror_rays(SurfacePass<Real>& surface) {
  if (!mirror_) mirror_ = std::make_unique<MirrorRays>(color.x.size());
  MirrorRays& mirror = *mirror_;
  kernels_.mirror_rays(surface.view(), clamped<Real>(picture_.shading.reflection_offset), mirror.origin.view(),
                       mirror.direction.view());
  const Real* const reflectivity = materials_.view().reflectivity;
  for (std::size_t k = 0; k < mirrors_.size(); ++k) {
    const std::size_t i = mirrors_[k];
    mirror.batch.origin.x[k] = mirror.origin.x[i];
    mirror.batch.origin.y[k] = mirror.origin.y[i];
    mirror.batch.origin.z[k] = mirror.origin.z[i];
    mirror.batch.direction.x[k] = mirror.direction.x[i];
    mirror.batch.direction.y[k] = mirror.direction.y[i];
    mirror.batch.direction.z[k] = mirror.direction.z[i];
    // k ≤ i ≤ ray: what is overwritten has been read
    const std::size_t ray = surface.ray(i);
    const Real mirrored = share(ray) * reflectivity[i];
    mirror.root[k] = static_cast<std::uint32_t>(root(ray));
    mirror.share[k] = mirrored;
  }
  set_epsilons(picture_.march, picture_.program->site(), 0.0, mirror.batch.origin, mirrors_.size(), mirror.epsilon);
  first_wave_ = false;
}

template class Radiance<float>;
template class Radiance<double>;

}  // namespace octomarch
