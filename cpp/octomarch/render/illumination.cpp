#include "octomarch/render/illumination.hpp"

namespace octomarch {

template <class Real>
Illumination<Real>::Illumination(const Picture& picture, const kernels::KernelTable<Real>& kernels, std::size_t size)
    : picture_(picture),
      kernels_(kernels),
      albedo_(size),
      color_(size),
      toward_(size),
      diffuse_(size),
      specular_(size),
      metallic_(size),
      exponent_(size),
      distance_(size),
      cosine_(size),
      visibility_(size),
      ambient_(size),
      shadow_origin_(size),
      shadow_direction_(size),
      shadow_distance_(size),
      shadow_epsilon_(size),
      shadow_visibility_(size) {
  lit_.reserve(size);
  for (const Material& material : picture.program->attributes().materials) {
    materials_.push_back({clamped<Real>(material.color.x), clamped<Real>(material.color.y),
                          clamped<Real>(material.color.z), static_cast<Real>(1.0 - material.metallic),
                          static_cast<Real>(material.specular), static_cast<Real>(material.metallic),
                          static_cast<Real>(phong_exponent(material.roughness))});
  }
}

template <class Real>
void Illumination<Real>::run(SurfacePass<Real>& surface, const bool& cancelled, RenderStats& stats) {
  kernels_.face_rays(surface.view());
  set_materials(surface);
  add_ambient(surface, cancelled, stats);
  for (const Light& light : picture_.scene->lights) {
    if (is_set(cancelled)) return;
    const kernels::LightView<Real> view = light_view(light);
    kernels_.light_samples(surface.view(), view, samples());
    std::fill_n(visibility_.data(), surface.count(), Real(1));
    if (picture_.shading.shadows != Shadows::kNone) cast_shadows(surface, light, cancelled, stats);
    kernels_.add_light(surface.view(), view, samples(), materials());
  }
}

template <class Real>
void Illumination<Real>::set_materials(const SurfacePass<Real>& surface) {
  const Attributes& attributes = picture_.program->attributes();
  const bool several = materials_.size() > 1;
  for (std::size_t i = 0; i < surface.count(); ++i) {
    const std::size_t index =
        several ? static_cast<std::size_t>(attributes.objects[static_cast<std::size_t>(surface.object(i))].material)
                : 0;
    const MaterialTerms& material = materials_[index];
    albedo_.x[i] = material.red;
    albedo_.y[i] = material.green;
    albedo_.z[i] = material.blue;
    diffuse_[i] = material.diffuse;
    specular_[i] = material.specular;
    metallic_[i] = material.metallic;
    exponent_[i] = material.exponent;
  }
}

template <class Real>
void Illumination<Real>::add_ambient(SurfacePass<Real>& surface, const bool& cancelled, RenderStats& stats) {
  const Shading& shading = picture_.shading;
  const Vec3& ambient = picture_.scene->ambient;
  const bool dark = ambient == Vec3{};
  if (shading.occlusion > 0 && !dark) {
    kernels_.occlusion(view<Real>(picture_.program->distance()), surface.registers(), surface.view(), shading.occlusion,
                       clamped<Real>(shading.occlusion_distance), &cancelled, ambient_.data());
    stats.occlusion_evaluations += surface.count() * static_cast<std::uint64_t>(shading.occlusion);
  } else {
    std::fill_n(ambient_.data(), surface.count(), Real(1));
  }
  for (std::size_t i = 0; i < surface.count(); ++i) {
    color_.x[i] = clamped<Real>(ambient.x) * ambient_[i] * albedo_.x[i];
    color_.y[i] = clamped<Real>(ambient.y) * ambient_[i] * albedo_.y[i];
    color_.z[i] = clamped<Real>(ambient.z) * ambient_[i] * albedo_.z[i];
  }
}

template <class Real>
kernels::LightView<Real> Illumination<Real>::light_view(const Light& light) const {
  const bool directional = light.kind == LightKind::kDirectional;
  const Vec3 vector = directional ? light.vector * -1.0 : light.vector;
  // an infinity times the zero of a surface in shadow would be NaN
  const auto real = [](double value) { return clamped<Real>(value); };
  return {directional,
          {real(vector.x), real(vector.y), real(vector.z)},
          {real(light.color.x), real(light.color.y), real(light.color.z)},
          light.decay,
          clamped<Real>(picture_.march.max_distance)};
}

template <class Real>
void Illumination<Real>::cast_shadows(SurfacePass<Real>& surface, const Light& light, const bool& cancelled,
                                      RenderStats& stats) {
  lit_.clear();
  for (std::size_t i = 0; i < surface.count(); ++i) {
    if (!(cosine_[i] > Real(0))) continue;
    const std::size_t k = lit_.size();
    lit_.push_back(i);
    shadow_origin_.x[k] = surface.origin.x[i];
    shadow_origin_.y[k] = surface.origin.y[i];
    shadow_origin_.z[k] = surface.origin.z[i];
    shadow_direction_.x[k] = toward_.x[i];
    shadow_direction_.y[k] = toward_.y[i];
    shadow_direction_.z[k] = toward_.z[i];
    shadow_distance_[k] = distance_[i];
    // no pixel footprint: in a corner the other wall is often nearer than that, and would cast a shadow
    const Real reach =
        std::max({std::fabs(surface.origin.x[i]), std::fabs(surface.origin.y[i]), std::fabs(surface.origin.z[i])});
    shadow_epsilon_[k] = std::max(clamped<Real>(picture_.march.epsilon), kUlpFloor<Real> * reach);
  }

  kernels::RayView<Real> rays{};
  rays.ox.values = shadow_origin_.x.data();
  rays.oy.values = shadow_origin_.y.data();
  rays.oz.values = shadow_origin_.z.data();
  rays.dx.values = shadow_direction_.x.data();
  rays.dy.values = shadow_direction_.y.data();
  rays.dz.values = shadow_direction_.z.data();
  if (light.kind == LightKind::kDirectional) {
    rays.dx = {nullptr, toward_.x[0]};
    rays.dy = {nullptr, toward_.y[0]};
    rays.dz = {nullptr, toward_.z[0]};
  }
  rays.t_max.values = shadow_distance_.data();
  rays.epsilon.values = shadow_epsilon_.data();
  rays.count = lit_.size();

  const bool soft = picture_.shading.shadows == Shadows::kSoft;
  const Real k = soft ? clamped<Real>(picture_.shading.shadow_k) : std::numeric_limits<Real>::infinity();
  const kernels::MarchParameters<Real> parameters{static_cast<Real>(1.0 / picture_.program->lipschitz()),
                                                  kUlpFloor<Real>, picture_.march.max_steps, false, &cancelled};
  kernels_.shadow(view<Real>(picture_.program->distance()), surface.registers(), rays, parameters, k,
                  shadow_visibility_.data(), stats.shadow);
  stats.shadow_rays += lit_.size();
  for (std::size_t k = 0; k < lit_.size(); ++k) visibility_[lit_[k]] = shadow_visibility_[k];
}

template <class Real>
Vec3 Illumination<Real>::color(const SurfacePass<Real>& surface, std::size_t i) const {
  const Real dx = surface.direction.x[i];
  const Real dy = surface.direction.y[i];
  const Real dz = surface.direction.z[i];
  const Real away = surface.normal.x[i] * dx + surface.normal.y[i] * dy + surface.normal.z[i] * dz;
  if (surface.status(i) == Status::kStepLimit && away >= Real(0)) return sky_color(picture_.scene->sky, dx, dy, dz);
  return {double(color_.x[i]), double(color_.y[i]), double(color_.z[i])};
}

template class Illumination<float>;
template class Illumination<double>;

}  // namespace octomarch
