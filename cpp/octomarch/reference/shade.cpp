// Lights, shadows, occlusion, mirrors and sky for one ray; see shade.hpp.
#include "octomarch/reference/shade.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

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

/// x between lo and hi; 0 for what is no number.
template <class T>
T within(T x, T lo, T hi) {
  return std::isnan(x) ? T(0) : std::clamp(x, lo, hi);
}

template <class T>
Vector<T> color_of(T red, T green, T blue) {
  constexpr T kMost = std::numeric_limits<T>::max();
  return {within(red, T(0), kMost), within(green, T(0), kMost), within(blue, T(0), kMost)};
}

/// The share of a spot's strength at this cosine of the angle from its middle.
template <class T>
T spot_share(const Light& light, T cosine) {
  const T outer = T(light.outer_cosine);
  const T s = std::clamp((cosine - outer) / (T(light.inner_cosine) - outer), T(0), T(1));
  return s * s * (T(3) - T(2) * s);
}

}  // namespace

template <class T>
Shader<T>::Shader(Evaluator<T>& field, const Scene& scene, const Shading& shading, const MarchLimits<T>& limits)
    : field_(field),
      scene_(scene),
      shading_(shading),
      limits_(limits),
      mirror_limits_(limits),
      sky_{Expression<T>(*scene.sky.color[0]), Expression<T>(*scene.sky.color[1]), Expression<T>(*scene.sky.color[2])} {
  mirror_limits_.t_min = T(0);
}

template <class T>
Vector<T> Shader<T>::radiance(Ray<T> ray, Arrival<T> arrival, Surface<T> surface) {
  Vector<T> color(0);
  T weight = T(1);  // of what is still to be seen along `ray`
  for (int bounce = 0;; ++bounce) {
    const bool turned_away = glm::dot(surface.normal, ray.direction) >= T(0);
    const bool passes = arrival.status == Status::kStepLimit && turned_away;
    if (arrival.status == Status::kMiss || passes) return color + sky(ray.direction) * weight;
    if (!has_surface(arrival.status)) return color;
    const Finish finish = finish_of(surface);
    const Vector<T> own = lit(ray, arrival, surface, finish);
    const T reflected = weight * finish.reflectivity;
    if (bounce == shading_.bounces || !(reflected > T(0)) || reflected < T(shading_.reflection_cutoff)) {
      return color + own * weight;
    }
    color += own * (weight * (T(1) - finish.reflectivity));
    weight = reflected;
    ray = mirrored(ray, arrival, surface);
    arrival = march_ray(field_, ray, mirror_limits_);
    surface = surface_at(field_, ray, arrival, NormalRule<T>(shading_));
  }
}

template <class T>
Vector<T> Shader<T>::sky(const Vector<T>& direction) {
  return color_of(sky_[0].at(direction).value, sky_[1].at(direction).value, sky_[2].at(direction).value);
}

template <class T>
typename Shader<T>::Finish Shader<T>::finish_of(const Surface<T>& surface) {
  const Slots<T> slots = field_.slots(surface.position, surface.normal);
  const auto share = [&slots](std::size_t slot) { return within(slots[slot], T(0), T(1)); };
  return {color_of(slots[0], slots[1], slots[2]), share(3), share(4), share(5), share(6)};
}

/// The ray that a mirror sends on: from a little above the surface, without a pixel's footprint.
template <class T>
Ray<T> Shader<T>::mirrored(const Ray<T>& ray, const Arrival<T>& arrival, const Surface<T>& surface) const {
  const Vector<T> normal = facing_normal(surface.normal, ray.direction);
  const T offset = std::max(T(shading_.reflection_offset), T(2) * limits_.hit_epsilon(ray, arrival.t));
  const Vector<T> direction = ray.direction - normal * (T(2) * glm::dot(ray.direction, normal));
  return {.origin = surface.position + normal * offset, .direction = glm::normalize(direction)};
}

template <class T>
Vector<T> Shader<T>::lit(const Ray<T>& ray, const Arrival<T>& arrival, const Surface<T>& surface,
                         const Finish& finish) {
  const Vector<T> albedo = finish.albedo;
  const T metallic = finish.metallic;
  const Vector<T> highlight = glm::mix(Vector<T>(finish.specular), albedo, metallic);
  const T exponent = T(phong_exponent(static_cast<double>(finish.roughness)));
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
  const Vector<T> direction = direction_of(toward);
  const T share =
      light.kind == LightKind::kSpot ? spot_share(light, -glm::dot(direction, vector<T>(light.direction))) : T(1);
  return {direction, distance, color * (share / std::pow(distance, T(light.decay)))};
}

/// 1 minus the share of free space missing along the normal: expected minus real distances, weighted by 2⁻ⁱ.
template <class T>
T Shader<T>::ambient_occlusion(const Vector<T>& origin, const Vector<T>& normal) {
  if (field_.is_solid()) return T(1);  // its values are no distances
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

/// 0 behind something, 1 in free view of the light; in between, for soft shadows, the smallest k·(distance / way) over the
/// samples. Where steps are long, they are plain again where that comes near 1.
template <class T>
T Shader<T>::visibility(const Vector<T>& origin, const Beam& beam) {
  if (shading_.shadows == Shadows::kNone) return T(1);
  const Ray<T> ray{.origin = origin, .direction = beam.toward_light};  // without a pixel's footprint
  const bool is_soft = shading_.shadows == Shadows::kSoft && !field_.is_solid();
  const T k = is_soft ? T(shading_.shadow_k) : std::numeric_limits<T>::infinity();
  T openness = T(1);
  T before = T(0);  // the radius of the last sample that was kept
  T stride = T(0);
  T t = T(0);
  for (int step = 0; step < limits_.max_steps && t <= beam.distance; ++step) {
    const T radius = field_.distance(origin + beam.toward_light * t) / limits_.lipschitz;
    if (t > T(0)) openness = std::min(openness, k * radius / t);
    if (stride > before && !(stride <= before + std::abs(radius))) {  // the step was too long
      t += before - stride;
      stride = before;
      continue;
    }
    if (limits_.arrived(ray, t, radius)) return T(0);
    const bool is_long = !limits_.is_straight() && step > 0 && k * radius >= T(2) * t;
    const T beyond = is_long ? hoped_beyond(radius, before, stride) : T(0);
    stride = is_long ? std::max(radius, std::min(radius + beyond, beam.distance - t)) : limits_.advance(ray, t, radius);
    before = limits_.is_straight() ? stride : radius;
    t += stride;
  }
  return std::clamp(openness, T(0), T(1));
}

template class Shader<float>;
template class Shader<double>;

}  // namespace octomarch::reference
