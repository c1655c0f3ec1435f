// The colour of one ray: Lambert and Phong under directional and point lights with shadows, ambient light with occlusion,
// and the sky. The marcher comes before it; render.hpp asks it for every pixel.
#pragma once

#include "octomarch/reference/march.hpp"

namespace octomarch::reference {

/// Shades rays of one scene. Keeps references to its arguments.
template <class T>
class Shader {
 public:
  Shader(Evaluator<T>& field, const Scene& scene, const Shading& shading, const MarchLimits<T>& limits)
      : field_(field), scene_(scene), shading_(shading), limits_(limits) {}

  /// Linear RGB that comes back along `ray`. Rays that start inside a solid and invalid rays are black.
  Vector<T> radiance(const Ray<T>& ray, const Arrival<T>& arrival, const Surface<T>& surface) const;

 private:
  struct Beam {
    Vector<T> toward_light;
    T distance;
    Vector<T> irradiance;
  };

  Vector<T> sky(const Vector<T>& direction) const;
  Vector<T> lit(const Ray<T>& ray, const Arrival<T>& arrival, const Surface<T>& surface) const;
  Beam beam_of(const Light& light, const Vector<T>& origin) const;
  T ambient_occlusion(const Vector<T>& origin, const Vector<T>& normal) const;
  T visibility(const Vector<T>& origin, const Beam& beam) const;

  Evaluator<T>& field_;
  const Scene& scene_;
  const Shading& shading_;
  const MarchLimits<T>& limits_;
};

extern template class Shader<float>;
extern template class Shader<double>;

}  // namespace octomarch::reference
