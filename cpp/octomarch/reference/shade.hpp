// The colour of one ray: Lambert and Phong under directional, point and spot lights with shadows, ambient light with
// occlusion, mirror images, and the sky. The marcher comes before it; render.hpp asks it for every pixel.
#pragma once

#include <array>

#include "octomarch/reference/march.hpp"

namespace octomarch::reference {

/// Shades rays of one scene. Keeps references to its arguments.
template <class T>
class Shader {
 public:
  Shader(Evaluator<T>& field, const Scene& scene, const Shading& shading, const MarchLimits<T>& limits);

  /// Linear RGB that comes back along `ray`. Rays that start inside a solid and invalid rays are black.
  Vector<T> radiance(Ray<T> ray, Arrival<T> arrival, Surface<T> surface);

 private:
  struct Beam {
    Vector<T> toward_light;
    T distance;
    Vector<T> irradiance;
  };
  /// What a surface is made of at a point, within bounds.
  struct Finish {
    Vector<T> albedo;
    T roughness, specular, metallic, reflectivity;
  };

  Vector<T> sky(const Vector<T>& direction);
  Finish finish_of(const Surface<T>& surface);
  Vector<T> lit(const Ray<T>& ray, const Arrival<T>& arrival, const Surface<T>& surface, const Finish& finish);
  Beam beam_of(const Light& light, const Vector<T>& origin) const;
  T ambient_occlusion(const Vector<T>& origin, const Vector<T>& normal);
  T visibility(const Vector<T>& origin, const Beam& beam);
  Ray<T> mirrored(const Ray<T>& ray, const Arrival<T>& arrival, const Surface<T>& surface) const;

  Evaluator<T>& field_;
  const Scene& scene_;
  const Shading& shading_;
  const MarchLimits<T>& limits_;
  MarchLimits<T> mirror_limits_;  ///< the same from t = 0 on
  std::array<Expression<T>, 3> sky_;
};

extern template class Shader<float>;
extern template class Shader<double>;

}  // namespace octomarch::reference
