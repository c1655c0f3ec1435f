// Illumination after the march, in lanes: what each light sends to each point, and its Lambert and Phong terms
// (B. T. Phong, "Illumination for computer generated pictures", CACM 18(6), 1975).
#pragma once

#include "octomarch/kernels/api.hpp"
#include "octomarch/kernels/lanes.hpp"
#include "octomarch/ops/math.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

template <class Real>
void light_samples(const SurfaceView<Real>& surface, const LightView<Real>& light, const LightSamples<Real>& out) {
  using T = Lanes<Real>;
  const std::size_t end = batches<Real>(surface.count) * kWidth<Real>;
  for (std::size_t i = 0; i < end; i += kWidth<Real>) {
    T lx = light.vector[0];
    T ly = light.vector[1];
    T lz = light.vector[2];
    T distance = light.max_distance;
    if (!light.directional) {
      lx = lx - T::load(surface.origin.x + i);
      ly = ly - T::load(surface.origin.y + i);
      lz = lz - T::load(surface.origin.z + i);
      distance = sqrt(lx * lx + ly * ly + lz * lz);
      const T inverse = select(distance > T(Real(0)), T(Real(1)) / distance, T(Real(0)));
      lx = lx * inverse;
      ly = ly * inverse;
      lz = lz * inverse;
    }
    lx.store(out.toward.x + i);
    ly.store(out.toward.y + i);
    lz.store(out.toward.z + i);
    distance.store(out.distance + i);
    const T cosine =
        lx * T::load(surface.facing.x + i) + ly * T::load(surface.facing.y + i) + lz * T::load(surface.facing.z + i);
    cosine.store(out.cosine + i);
  }
}

template <class Real>
void add_light(const SurfaceView<Real>& surface, const LightView<Real>& light, const LightSamples<Real>& samples,
               const MaterialView<Real>& material) {
  using T = Lanes<Real>;
  const std::size_t end = batches<Real>(surface.count) * kWidth<Real>;
  const T zero = Real(0);
  for (std::size_t i = 0; i < end; i += kWidth<Real>) {
    const T cosine = T::load(samples.cosine + i);
    const Mask<Real> faces_light = cosine > zero;
    T strength = T::load(samples.visibility + i);
    if (!light.directional) {
      for (int power = 0; power < light.decay; ++power) strength = strength / T::load(samples.distance + i);
    }
    strength = select(faces_light, strength, zero);

    // mirror direction 2(n·l)n − l, against the ray's
    const T twice = cosine + cosine;
    const T rx = twice * T::load(surface.facing.x + i) - T::load(samples.toward.x + i);
    const T ry = twice * T::load(surface.facing.y + i) - T::load(samples.toward.y + i);
    const T rz = twice * T::load(surface.facing.z + i) - T::load(samples.toward.z + i);
    const T aligned = -(rx * T::load(surface.direction.x + i) + ry * T::load(surface.direction.y + i) +
                        rz * T::load(surface.direction.z + i));
    const T lobe = ops::power(min(max(aligned, zero), T(Real(1))), T::load(material.exponent + i));
    const T specular = T::load(material.specular + i);
    const T metallic = T::load(material.metallic + i);
    const T diffuse = T::load(material.diffuse + i) * cosine;

    const Real* const albedo[3] = {material.albedo.x, material.albedo.y, material.albedo.z};
    Real* const color[3] = {material.color.x, material.color.y, material.color.z};
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const T base = T::load(albedo[channel] + i);
      const T highlight = (specular + (base - specular) * metallic) * lobe;
      const T lit = T(light.color[channel]) * strength * (base * diffuse + highlight);
      (T::load(color[channel] + i) + lit).store(color[channel] + i);
    }
  }
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
