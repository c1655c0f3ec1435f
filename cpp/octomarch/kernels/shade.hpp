// Illumination after the march, in lanes: what each light sends to each point, and its Lambert and Phong terms
// (B. T. Phong, "Illumination for computer generated pictures", CACM 18(6), 1975).
#pragma once

#include "octomarch/kernels/api.hpp"
#include "octomarch/kernels/lanes.hpp"
#include "octomarch/ops/math.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

/// A row's batch brought into 0 … top and put back; NaN becomes 0, since max(NaN, 0) is 0.
template <class Real>
Lanes<Real> clamp_row(Real* row, std::size_t i, Real top) {
  using T = Lanes<Real>;
  const T value = min(max(T::load(row + i), T(Real(0))), T(top));
  value.store(row + i);
  return value;
}

template <class Real>
void clamp_colors(const Vectors<Real>& colors, std::size_t count) {
  Real* const rows[] = {colors.x, colors.y, colors.z};
  const std::size_t end = batches<Real>(count) * kWidth<Real>;
  for (std::size_t i = 0; i < end; i += kWidth<Real>) {
    for (Real* row : rows) clamp_row(row, i, std::numeric_limits<Real>::max());
  }
}

template <class Real>
void clamp_materials(const MaterialView<Real>& material, std::size_t count) {
  using T = Lanes<Real>;
  clamp_colors(material.albedo, count);
  Real* const rows[] = {material.specular, material.metallic, material.reflectivity};
  const std::size_t end = batches<Real>(count) * kWidth<Real>;
  for (std::size_t i = 0; i < end; i += kWidth<Real>) {
    for (Real* row : rows) clamp_row(row, i, Real(1));
    const T alpha = square(clamp_row(material.roughness, i, Real(1)));
    const T exponent = T(Real(2)) / (alpha * alpha) - T(Real(2));
    min(max(exponent, T(Real(1))), T(Real(8192))).store(material.exponent + i);
  }
}

/// Smoothstep of a spot's cosine from the rim of its cone to where it has its full strength.
template <class T, class Real>
T cone_strength(const LightView<Real>& light, const T& lx, const T& ly, const T& lz) {
  const T cosine = -(lx * T(light.axis[0]) + ly * T(light.axis[1]) + lz * T(light.axis[2]));
  const T x = min(max((cosine - T(light.outer_cosine)) * T(light.cone_scale), T(Real(0))), T(Real(1)));
  return x * x * (T(Real(3)) - (x + x));
}

template <class Real>
void light_samples(const SurfaceView<Real>& surface, const LightView<Real>& light, const LightSamples<Real>& out) {
  using T = Lanes<Real>;
  const std::size_t end = batches<Real>(surface.count) * kWidth<Real>;
  for (std::size_t i = 0; i < end; i += kWidth<Real>) {
    T lx = light.vector[0];
    T ly = light.vector[1];
    T lz = light.vector[2];
    T distance = light.max_distance;
    T strength = Real(1);
    if (!light.directional) {
      lx = lx - T::load(surface.origin.x + i);
      ly = ly - T::load(surface.origin.y + i);
      lz = lz - T::load(surface.origin.z + i);
      distance = sqrt(lx * lx + ly * ly + lz * lz);
      const T inverse = select(distance > T(Real(0)), T(Real(1)) / distance, T(Real(0)));
      lx = lx * inverse;
      ly = ly * inverse;
      lz = lz * inverse;
      if (light.spot) strength = cone_strength<T>(light, lx, ly, lz);
      for (int power = 0; power < light.decay; ++power) strength = strength / distance;
    }
    lx.store(out.toward.x + i);
    ly.store(out.toward.y + i);
    lz.store(out.toward.z + i);
    distance.store(out.distance + i);
    strength.store(out.strength + i);
    const T cosine =
        lx * T::load(surface.facing.x + i) + ly * T::load(surface.facing.y + i) + lz * T::load(surface.facing.z + i);
    cosine.store(out.cosine + i);
  }
}

template <class Real>
void add_light(const SurfaceView<Real>& surface, const LightView<Real>& light, const LightSamples<Real>& samples,
               const MaterialView<Real>& material, const Vectors<Real>& color) {
  using T = Lanes<Real>;
  const std::size_t end = batches<Real>(surface.count) * kWidth<Real>;
  const T zero = Real(0);
  const T one = Real(1);
  for (std::size_t i = 0; i < end; i += kWidth<Real>) {
    const T cosine = T::load(samples.cosine + i);
    const T strength = select(cosine > zero, T::load(samples.visibility + i) * T::load(samples.strength + i), zero);

    // mirror direction 2(n·l)n − l, against the ray's
    const T twice = cosine + cosine;
    const T rx = twice * T::load(surface.facing.x + i) - T::load(samples.toward.x + i);
    const T ry = twice * T::load(surface.facing.y + i) - T::load(samples.toward.y + i);
    const T rz = twice * T::load(surface.facing.z + i) - T::load(samples.toward.z + i);
    const T aligned = -(rx * T::load(surface.direction.x + i) + ry * T::load(surface.direction.y + i) +
                        rz * T::load(surface.direction.z + i));
    const T lobe = ops::power(min(max(aligned, zero), one), T::load(material.exponent + i));
    const T specular = T::load(material.specular + i);
    const T metallic = T::load(material.metallic + i);
    const T diffuse = (one - metallic) * cosine;

    const Real* const albedo[3] = {material.albedo.x, material.albedo.y, material.albedo.z};
    Real* const sum[3] = {color.x, color.y, color.z};
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const T base = T::load(albedo[channel] + i);
      const T highlight = (specular + (base - specular) * metallic) * lobe;
      const T lit = T(light.color[channel]) * strength * (base * diffuse + highlight);
      (T::load(sum[channel] + i) + lit).store(sum[channel] + i);
    }
  }
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
