// Lights, shadows, occlusion and sky for one ray; see shade.hpp.
#include "octomarch/reference/shade.hpp"

#include <algorithm>
#include <cmath>

namespace octomarch::reference {
namespace {

template <class T>
T positive(T x) {
  return std::max(x, T(0));
}

/// The normal to shade with: one that faces away, where a ray grazes an edge within tolerance, is turned to the side.
template <class T>
Vector<T> facing_normal(const Vector<T>& normal, const Vector<T>& direction) {
  const T away = glm::dot(normal, direction);
  if (!(away > T(0))) return normal;
  const Vector<T> sideways = direction_of(normal - direction * away);
  return sideways == Vector<T>(0) ? -direction : sideways;
}

}  // namespace

template <class T>
Vector<T> Shader<T>::radiance(const Ray<T>& ray, const Arrival<T>& arrival, const Surface<T>& surface) const {
  if (arrival.status == Status::kMiss) return sky(ray.direction);
  const bool turned_away = glm::dot(surface.normal, ray.direction) >= T(0);
  if (arrival.status == Status::kStepLimit && turned_away) return sky(ray.direction);
  return has_surface(arrival.status) ? lit(ray, arrival, surface) : Vector<T>(0);
}

template <class T>
Vector<T> Shader<T>::sky(const Vector<T>& direction) const {
  const Sky& sky = scene_.sky;
  const T along = glm::dot(direction, vector<T>(sky.axis));
  return vector<T>(sky.toward) * positive(along) + vector<T>(sky.away) * positive(-along) + vector<T>(sky.base);
}

template <class T>
Vector<T> Shader<T>::lit(const Ray<T>& ray, const Arrival<T>& arrival, const Surface<T>& surface) const {
  const Material& material = field_.materials()[static_cast<std::size_t>(surface.material)];
  const Vector<T> albedo = vector<T>(material.color);
  const T metallic = T(material.metallic);
  const Vector<T> highlight = glm::mix(Vector<T>(T(material.specular)), albedo, metallic);
  const T exponent = T(phong_exponent(material.roughness));
  const Vector<T> normal = facing_normal(surface.normal, ray.direction);
  const T epsilon = limits_.hit_epsilon(ray, arrival.t);
  // Two tolerances off the surface no shadow ray meets the surface it leaves, whatever its direction.
  const Vector<T> origin = surface.position + normal * (T(2) * epsilon);

  Vector<T> color = vector<T>(scene_.ambient) * albedo * ambient_occlusion(origin, normal);
  for (const Light& light : scene_.lights) {
    const Beam beam = beam_of(light, origin);
    const T cosine = glm::dot(normal, beam.toward_light);
    if (!(cosine > T(0))) continue;
    const T visible = visibility(origin, beam);
    const Vector<T> reflected = normal * (T(2) * cosine) - beam.toward_light;
    const T phong = std::pow(positive(glm::dot(reflected, -ray.direction)), exponent);
    color += beam.irradiance * visible * (albedo * ((T(1) - metallic) * cosine) + highlight * phong);
  }
  return color;
}

template <class T>
typename Shader<T>::Beam Shader<T>::beam_of(const Light& light, const Vector<T>& origin) const {
  const Vector<T> color = vector<T>(light.color);
  if (light.kind == LightKind::kDirectional) return {-vector<T>(light.vector), limits_.t_max, color};
  const Vector<T> toward = vector<T>(light.vector) - origin;
  const T distance = glm::length(toward);
  return {direction_of(toward), distance, color / std::pow(distance, T(light.decay))};
}

/// 1 minus the share of free space missing along the normal: expected minus real distances, weighted by 2⁻ⁱ.
template <class T>
T Shader<T>::ambient_occlusion(const Vector<T>& origin, const Vector<T>& normal) const {
  T missing = T(0);
  T expected = T(0);
  for (int i = 1; i <= shading_.occlusion; ++i) {
    const T share = T(i) / T(shading_.occlusion);
    const T height = T(shading_.occlusion_distance) * share * share;
    const T weight = std::ldexp(T(1), -i);
    missing += weight * std::min(positive(height - field_.distance(origin + normal * height)), height);
    expected += weight * height;
  }
  return expected > T(0) ? T(1) - std::clamp(missing / expected, T(0), T(1)) : T(1);
}

/// 0 behind something, 1 in free view of the light; in between, for soft shadows, the smallest k·(distance / way).
template <class T>
T Shader<T>::visibility(const Vector<T>& origin, const Beam& beam) const {
  if (shading_.shadows == Shadows::kNone) return T(1);
  const Ray<T> ray{.origin = origin, .direction = beam.toward_light};  // without a pixel's footprint
  T openness = T(1);
  T t = T(0);
  for (int step = 0; step < limits_.max_steps && t <= beam.distance; ++step) {
    const T radius = field_.distance(origin + beam.toward_light * t) / limits_.lipschitz;
    if (radius <= limits_.hit_epsilon(ray, t)) return T(0);
    if (shading_.shadows == Shadows::kSoft && t > T(0)) {
      openness = std::min(openness, T(shading_.shadow_k) * radius / t);
    }
    t += radius;
  }
  return std::clamp(openness, T(0), T(1));
}

template class Shader<float>;
template class Shader<double>;

}  // namespace octomarch::reference
