// The march of one ray, one step at a time, and the surface where it ends. The evaluator comes before it; shading
// and the queries come after.
#pragma once

#include <algorithm>
#include <limits>

#include "octomarch/graph/scene.hpp"
#include "octomarch/graph/site.hpp"
#include "octomarch/reference/compiled.hpp"
#include "octomarch/reference/evaluate.hpp"

namespace octomarch::reference {

/// A ray whose direction has unit length, and how wide its pixel is: half its height at parameter t is the larger of
/// pixel_radius and pixel_slope·t, both 0 where there is no pixel. Its origin lies `lead` along the ray from where the user
/// has it, and t counts from there.
template <class T>
struct Ray {
  Vector<T> origin;
  Vector<T> direction;
  T pixel_radius = T(0);
  T pixel_slope = T(0);
  double lead = 0.0;
};

/// Half an ulp of 1: u in the hit epsilon of March.
template <class T>
constexpr T kUnitRoundoff = std::numeric_limits<T>::epsilon() / T(2);

/// The settings of a march in the precision it runs in, for rays that are not moved along. `t_max` counts along unit
/// directions.
template <class T>
struct MarchLimits {
  Method method;
  int max_steps;
  T epsilon;
  T pixel_tolerance;
  T t_min;
  T t_max;
  T bias;
  T step;
  T lipschitz;
  Doubt doubt;
  bool finish;
  T inner_offset;
  bool may_be_inside = true;  ///< where the first sample has arrived

  MarchLimits(const March& march, const Compiled& compiled, const Site& site)
      : method(march.method),
        max_steps(march.max_steps),
        epsilon(T(march.least_epsilon())),
        pixel_tolerance(T(march.pixel_tolerance)),
        t_min(T(march.min_distance)),
        t_max(T(march.max_distance)),
        bias(T(march.bias)),
        step(T(march.step)),
        lipschitz(T(compiled.lipschitz)),
        doubt(compiled.doubt),
        finish(march.finish),
        inner_offset(T(site.inner_offset)) {}

  /// Where rays are moved along by `lead`, they begin outside, and have less of `max_distance` before them.
  void move(const March& march, const Site& site, double lead, double max_distance) {
    t_max = T(max_distance - lead);
    if (lead == 0.0) return;
    t_min = T(march.min_distance + site.radius);
    may_be_inside = false;
  }

  /// The hit epsilon at parameter t of a ray; see March.
  T hit_epsilon(const Ray<T>& ray, T t) const;
  /// By how much a certified march doubts a radius there.
  T doubt_at(const Ray<T>& ray, T t) const;
  /// Has a ray arrived where the field is lipschitz·radius? A NaN has not.
  bool arrived(const Ray<T>& ray, T t, T radius) const;
  /// How far it goes on from there at the least, where steps are fixed.
  T least_step(const Ray<T>& ray, T t) const;
  /// How far it goes on from there if it has not arrived.
  T advance(const Ray<T>& ray, T t, T radius) const;
  /// Are steps never longer than the empty sphere, or if so then whatever the slope?
  bool is_straight() const {
    return method == Method::kPlain || method == Method::kFixed || method == Method::kCertified || bias > T(0);
  }
};

/// How far beyond the empty sphere a step goes by what the slope from the sample before lets hope, after Bálint and Valasek.
/// `before`: the radius there, `stride`: the way from it.
template <class T>
T hoped_beyond(T radius, T before, T stride) {
  const T growth = std::min(radius - before, T(0.9375) * stride);
  return T(0.88) * radius * (stride + growth) / (stride - growth);
}

template <class T>
struct Arrival {
  Status status = Status::kInvalid;
  T t = std::numeric_limits<T>::infinity();
  int steps = 0;  ///< evaluations made
};

/// A point of the surface, or zeros and −1 where a ray found none.
template <class T>
struct Surface {
  Vector<T> position = Vector<T>(0);
  Vector<T> normal = Vector<T>(0);
  int material = -1;
};

/// True for rays that found a surface, or may have: those that have a position, a normal and ids.
constexpr bool has_surface(Status status) { return status == Status::kHit || status == Status::kStepLimit; }

/// Marches one ray by the method of its limits. A ray that is not finite, or has no direction, is kInvalid.
template <class T>
Arrival<T> march_ray(Evaluator<T>& field, const Ray<T>& ray, const MarchLimits<T>& limits);

/// How normals are found; see Shading. `step`: of differences. A field that has no slope, since some part of it is solid,
/// has the normal that leads away from its inside among 256 points around, up to `step` away, whatever the kind.
template <class T>
struct NormalRule {
  Normals kind;
  T step;

  explicit NormalRule(const Shading& shading) : kind(shading.normals), step(T(shading.normal_step)) {}
};

template <class T>
Surface<T> surface_at(Evaluator<T>& field, const Ray<T>& ray, const Arrival<T>& arrival, const NormalRule<T>& rule);

}  // namespace octomarch::reference
