#include "octomarch/render/illumination.hpp"

namespace octomarch {

template <class Real>
Illumination<Real>::Illumination(const Picture& picture, const kernels::KernelTable<Real>& kernels, std::size_t size)
    : picture_(picture),
      kernels_(kernels),
      color_(size),
      toward_(size),
      distance_(size),
      cosine_(size),
      strength_(size),
      visibility_(size),
      ambient_(size),
      above_(size),
      field_above_(size),
      lit_(size),
      shadow_(size),
      shadow_distance_(size),
      shadow_epsilon_(size),
      shadow_visibility_(size) {}

template <class Real>
void Illumination<Real>::run(SurfacePass<Real>& surface, MaterialPass<Real>& materials, const bool& cancelled,
                             RenderStats& stats) {
  kernels_.face_rays(surface.view());
  add_ambient(surface, materials.albedo(), cancelled, stats);
  for (const Light& light : picture_.scene->lights) {
    if (is_set(cancelled)) return;
    const kernels::LightView<Real> view = light_view(light);
    kernels_.light_samples(surface.view(), view, samples());
    std::fill_n(visibility_.data(), surface.count(), Real(1));
    if (picture_.shading.shadows != Shadows::kNone) cast_shadows(surface, light, cancelled, stats);
    kernels_.add_light(surface.view(), view, samples(), materials.view(), color_.view());
  }
}

/// Without ambient light there is nothing to dim, and where values are no distances no way to measure.
template <class Real>
bool Illumination<Real>::has_occlusion() const {
  const bool dark = picture_.scene->ambient == Vec3{};
  return picture_.shading.occlusion > 0 && !dark && !picture_.program->is_solid();
}

/// Ambient visibility of every point from samples along its normal. Their heights grow with the square of their number: near
/// contact the first ones decide, and there they are dense.
template <class Real>
void Illumination<Real>::find_occlusion(SurfacePass<Real>& surface, const bool& cancelled, StageStats& stage) {
  const ScopedTimer timer(stage.seconds);
  const Shading& shading = picture_.shading;
  const auto distance = clamped<Real>(shading.occlusion_distance);
  const std::size_t count = surface.count();
  stage.count += count;
  std::fill_n(ambient_.data(), count, Real(0));
  Real weight = 1;
  Real most = 0;
  for (int sample = 1; sample <= shading.occlusion; ++sample) {
    weight *= Real(0.5);
    const Real share = Real(sample) / Real(shading.occlusion);
    const Real height = distance * share * share;
    most += weight * height;
    kernels_.occlusion_points(surface.view(), height, above_.view());
    surface.field().distance(above_.read(), count, cancelled, field_above_.data(), stage);
    stage.work.evaluations += count;
    kernels_.add_occlusion(field_above_.data(), count, height, weight, ambient_.data());
  }
  kernels_.ambient_visibility(count, most, ambient_.data());
}

template <class Real>
void Illumination<Real>::add_ambient(SurfacePass<Real>& surface, const VectorBuffer<Real>& albedo,
                                     const bool& cancelled, RenderStats& stats) {
  const Vec3& ambient = picture_.scene->ambient;
  if (has_occlusion()) {
    find_occlusion(surface, cancelled, stats.occlusion);
  } else {
    std::fill_n(ambient_.data(), surface.count(), Real(1));
  }
  for (std::size_t i = 0; i < surface.count(); ++i) {
    color_.x[i] = clamped<Real>(ambient.x) * ambient_[i] * albedo.x[i];
    color_.y[i] = clamped<Real>(ambient.y) * ambient_[i] * albedo.y[i];
    color_.z[i] = clamped<Real>(ambient.z) * ambient_[i] * albedo.z[i];
  }
}

template <class Real>
kernels::LightView<Real> Illumination<Real>::light_view(const Light& light) const {
  const bool directional = light.kind == LightKind::kDirectional;
  // an infinity times the zero of a surface in shadow would be NaN
  const auto real = [](double value) { return clamped<Real>(value); };
  kernels::LightView<Real> view{};
  const auto set = [&](Real(&out)[3], const Vec3& v) {
    out[0] = real(v.x);
    out[1] = real(v.y);
    out[2] = real(v.z);
  };
  view.directional = directional;
  set(view.vector, directional ? light.vector * -1.0 : light.vector);
  set(view.color, light.color);
  view.decay = light.decay;
  view.max_distance = real(picture_.march.max_distance);
  view.spot = light.kind == LightKind::kSpot;
  set(view.axis, light.direction);
  view.outer_cosine = real(light.outer_cosine);
  view.cone_scale = real(1.0 / (light.inner_cosine - light.outer_cosine));
  return view;
}

/// Finds the points that a light reaches unless something is in between. Where that is all of them, their rows serve as they are.
template <class Real>
typename Illumination<Real>::ShadowRays Illumination<Real>::find_lit(const SurfacePass<Real>& surface) {
  lit_.clear();
  for (std::size_t i = 0; i < surface.count(); ++i) {
    if (cosine_[i] > Real(0) && strength_[i] > Real(0)) lit_.push(i);
  }
  if (lit_.size() == surface.count()) return {surface.origin, toward_, distance_, visibility_};
  for (std::size_t k = 0; k < lit_.size(); ++k) {
    const std::size_t i = lit_[k];
    shadow_.origin.x[k] = surface.origin.x[i];
    shadow_.origin.y[k] = surface.origin.y[i];
    shadow_.origin.z[k] = surface.origin.z[i];
    shadow_.direction.x[k] = toward_.x[i];
    shadow_.direction.y[k] = toward_.y[i];
    shadow_.direction.z[k] = toward_.z[i];
    shadow_distance_[k] = distance_[i];
  }
  return {shadow_.origin, shadow_.direction, shadow_distance_, shadow_visibility_};
}

template <class Real>
void Illumination<Real>::cast_shadows(SurfacePass<Real>& surface, const Light& light, const bool& cancelled,
                                      RenderStats& stats) {
  const ScopedTimer timer(stats.shadow.seconds);
  const ShadowRays rays = find_lit(surface);
  const std::size_t count = lit_.size();
  // no pixel footprint: in a corner the other wall is often nearer than that, and would cast a shadow
  set_epsilons(picture_.march, picture_.program->site(), 0.0, rays.origin, count, shadow_epsilon_);
  RayColumns<Real> columns = own_columns(rays.origin, rays.direction, shadow_epsilon_);
  kernels::Column<Real> t_max{rays.distance.data(), 0};
  if (light.kind == LightKind::kDirectional) {
    columns.dx = {nullptr, toward_.x[0]};
    columns.dy = {nullptr, toward_.y[0]};
    columns.dz = {nullptr, toward_.z[0]};
    t_max = {nullptr, distance_[0]};
  }
  const bool soft = picture_.shading.shadows == Shadows::kSoft && !picture_.program->is_solid();
  const Real k = soft ? clamped<Real>(picture_.shading.shadow_k) : std::numeric_limits<Real>::infinity();
  const kernels::MarchParameters<Real> parameters =
      shadow_parameters(*picture_.program, picture_.march, k, columns.epsilon_slope, cancelled);
  surface.field().cast_shadows(columns.view({}, t_max, count), parameters, shadow_, rays.visibility.data(),
                               stats.shadow);
  stats.shadow.count += count;
  if (&rays.visibility == &visibility_) return;
  for (std::size_t i = 0; i < count; ++i) visibility_[lit_[i]] = shadow_visibility_[i];
}

template class Illumination<float>;
template class Illumination<double>;

}  // namespace octomarch
