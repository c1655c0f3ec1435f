// J. C. Hart, "Sphere tracing", The Visual Computer 12(10), 1996, with a tolerance that grows with the ray and two secants at
// the end; the same with longer steps, after Keinert et al. 2014, and Bálint and Valasek 2018; and fixed steps with bisection
// at the end; and steps that nothing is missed by. See march.hpp.
#include "octomarch/reference/march.hpp"

#include <algorithm>
#include <cmath>

namespace octomarch::reference {
namespace {

template <class T>
constexpr T kNowhere = std::numeric_limits<T>::infinity();

/// The field before the first sample, and the way from there, of a ray that hits at once: its secant leads to the end of the
/// empty sphere.
template <class T>
constexpr T kNothingBefore = T(1e30);

template <class T>
T largest_magnitude(const Vector<T>& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

/// A sample of a ray: where, and the field over its Lipschitz bound.
template <class T>
struct RaySample {
  T t;
  T radius;
};

/// The root of the line through two samples, not farther than 32 radii ahead. Where the later sample is not the smaller, as
/// when the tolerance has grown past a constant distance, no root is near. `apart`: how far the later was meant to be.
template <class T>
T secant_step(T previous, T radius, T apart) {
  if (!(previous > radius)) return T(0);
  return std::min(radius * apart / (previous - radius), T(32) * std::max(radius, T(0)));
}

template <class T>
T radius_at(Evaluator<T>& field, const Ray<T>& ray, const MarchLimits<T>& limits, T t) {
  return field.distance(ray.origin + ray.direction * t) / limits.lipschitz;
}

template <class T>
Vector<T> central_differences(Evaluator<T>& field, const Vector<T>& p, T step) {
  Vector<T> difference(0);
  for (int axis = 0; axis < 3; ++axis) {
    Vector<T> offset(0);
    offset[axis] = step;
    difference[axis] = field.distance(p + offset) - field.distance(p - offset);
  }
  return difference;
}

/// Differences along the axes made of samples at alternate corners of a cube.
template <class T>
Vector<T> tetrahedron_differences(Evaluator<T>& field, const Vector<T>& p, T step) {
  const T a = field.distance(p + Vector<T>(step, -step, -step));
  const T b = field.distance(p + Vector<T>(-step, -step, step));
  const T c = field.distance(p + Vector<T>(-step, step, -step));
  const T d = field.distance(p + Vector<T>(step, step, step));
  return {(a - b) + (d - c), (c - a) + (d - b), (b - a) + (d - c)};
}

/// Minus the sum of those offsets that end inside, over the points of a lattice in a ball of radius `step` around p, which is
/// four cells wide on each side. Offsets count in that radius.
template <class T>
Vector<T> away_from_inside(Evaluator<T>& field, const Vector<T>& p, T step) {
  Vector<T> sum(0);
  for (int x = -4; x <= 4; ++x) {
    for (int y = -4; y <= 4; ++y) {
      for (int z = -4; z <= 4; ++z) {
        const Vector<T> offset = Vector<T>(T(x), T(y), T(z)) * T(0.25);
        const T distance = glm::length(offset);
        if (distance > T(0) && distance <= T(1) && field.distance(p + offset * step) < T(0)) sum -= offset;
      }
    }
  }
  return sum;
}

template <class T>
Vector<T> slope_at(Evaluator<T>& field, const Vector<T>& p, const NormalRule<T>& rule) {
  if (field.is_solid()) return away_from_inside(field, p, rule.step);
  if (rule.kind == Normals::kTetrahedron) return tetrahedron_differences(field, p, rule.step);
  return rule.kind == Normals::kCentral ? central_differences(field, p, rule.step) : field.gradient(p);
}

/// The end of the secant step, where it has all but closed the gap, moved on by the secant through the last sample and that
/// end; else the last sample, for the ray only grazes an edge. `apart`: of the last two samples.
template <class T>
T by_secant(Evaluator<T>& field, const Ray<T>& ray, const MarchLimits<T>& limits, T previous, const RaySample<T>& last,
            T apart) {
  const T end = std::min(last.t + secant_step(previous, last.radius, apart), limits.t_max);
  const T left = radius_at(field, ray, limits, end);
  if (!(std::abs(left) <= limits.hit_epsilon(ray, end) / T(16))) return last.t;
  const T fall = last.radius - left;
  const T more = std::abs(left) < std::abs(fall) ? left * (end - last.t) / fall : T(0);
  return std::min(end + more, limits.t_max);
}

/// The outer end of what ten halvings leave of the way from the sample before, but no more than a least step, to the first
/// one inside.
template <class T>
T by_bisection(Evaluator<T>& field, const Ray<T>& ray, const MarchLimits<T>& limits, T before, T inside) {
  T outside = std::max(before, inside - limits.least_step(ray, before));
  for (int i = 0; i < 10; ++i) {
    const T middle = outside + (inside - outside) / T(2);
    (radius_at(field, ray, limits, middle) <= T(0) ? inside : outside) = middle;
  }
  return outside;
}

}  // namespace

template <class T>
T MarchLimits<T>::hit_epsilon(const Ray<T>& ray, T t) const {
  const T rounding = T(16) * kUnitRoundoff<T> * std::max({largest_magnitude(ray.origin), t, inner_offset});
  return std::max({epsilon, rounding, pixel_tolerance * std::max(ray.pixel_radius, ray.pixel_slope * t)});
}

template <class T>
T MarchLimits<T>::doubt_at(const Ray<T>& ray, T t) const {
  const T far = largest_magnitude(ray.origin) + t;
  return far <= T(doubt.reach) ? T(doubt.offset) + bias + T(doubt.slope) * far : kNowhere<T>;
}

template <class T>
bool MarchLimits<T>::arrived(const Ray<T>& ray, T t, T radius) const {
  return radius <= (method == Method::kFixed ? T(0) : hit_epsilon(ray, t));
}

template <class T>
T MarchLimits<T>::least_step(const Ray<T>& ray, T t) const {
  return std::max(step, hit_epsilon(ray, t));
}

template <class T>
T MarchLimits<T>::advance(const Ray<T>& ray, T t, T radius) const {
  if (method == Method::kFixed) return std::max(radius - bias, least_step(ray, t));
  return bias > T(0) ? std::max(radius - bias, radius / T(2)) : radius;
}

/// Plain and fixed steps.
template <class T>
Arrival<T> march_straight(Evaluator<T>& field, const Ray<T>& ray, const MarchLimits<T>& limits) {
  RaySample<T> before{limits.t_min, T(0)};
  T t = limits.t_min;
  for (int steps = 1; steps <= limits.max_steps; ++steps) {
    const T radius = radius_at(field, ray, limits, t);
    if (std::isnan(radius)) return {Status::kInvalid, kNowhere<T>, steps};
    if (limits.arrived(ray, t, radius)) {
      if (steps == 1 && limits.may_be_inside) return {Status::kInside, t, steps};
      if (!limits.finish) return {Status::kHit, t, steps};
      if (limits.method == Method::kFixed) {
        return {Status::kHit, by_bisection(field, ray, limits, before.t, t), steps};
      }
      const bool is_first = steps == 1;
      const T previous = is_first ? kNothingBefore<T> : before.radius;
      const T apart = is_first ? kNothingBefore<T> : limits.advance(ray, before.t, before.radius);
      return {Status::kHit, by_secant(field, ray, limits, previous, {t, radius}, apart), steps};
    }
    before = {t, radius};
    t += limits.advance(ray, t, radius);
    if (t > limits.t_max) return {Status::kMiss, kNowhere<T>, steps};
  }
  return {Status::kStepLimit, t, limits.max_steps};
}

/// How far beyond the empty sphere a step goes: at first, by the part of it that Keinert et al. found; or by what the slope
/// to the sample before lets hope, after Bálint and Valasek.
template <class T>
struct Boldness {
  Method method;
  bool has_failed = false;

  T beyond(T radius, const RaySample<T>& stood, T stride) const {
    if (method == Method::kRelaxed) return has_failed ? T(0) : T(0.6) * radius;
    return hoped_beyond(radius, stood.radius, stride);
  }
};

/// Steps that go beyond the empty sphere in the hope that the next one touches it. The sample that does not keep the promise
/// is given up, and the ray takes the plain step.
template <class T>
Arrival<T> march_relaxed(Evaluator<T>& field, const Ray<T>& ray, const MarchLimits<T>& limits) {
  Boldness<T> boldness{limits.method};
  RaySample<T> stood{limits.t_min, T(0)};  // the last that was kept
  T stride = T(0);
  T t = limits.t_min;
  for (int steps = 1; steps <= limits.max_steps; ++steps) {
    const T radius = radius_at(field, ray, limits, t);
    if (stride > stood.radius && !(stride <= stood.radius + std::abs(radius))) {
      boldness.has_failed = true;
      stride = stood.radius;
      t = stood.t + stride;
      continue;
    }
    if (std::isnan(radius)) return {Status::kInvalid, kNowhere<T>, steps};
    if (limits.arrived(ray, t, radius)) {
      if (steps == 1 && limits.may_be_inside) return {Status::kInside, t, steps};
      if (!limits.finish) return {Status::kHit, radius < T(0) ? std::min(t, stood.t + stood.radius) : t, steps};
      const bool is_first = steps == 1;
      const T previous = is_first ? kNothingBefore<T> : stood.radius;
      const T apart = is_first ? kNothingBefore<T> : stride;
      return {Status::kHit, by_secant(field, ray, limits, previous, {t, radius}, apart), steps};
    }
    const bool is_first = steps == 1 && limits.method != Method::kRelaxed;
    const T beyond = is_first ? T(0) : boldness.beyond(radius, stood, stride);
    stood = {t, radius};
    stride = std::max(radius, std::min(radius + beyond, limits.t_max - t));
    t = std::min(t + stride, std::max(limits.t_max, t + radius));
    if (t > limits.t_max) return {Status::kMiss, kNowhere<T>, steps};
  }
  return {Status::kStepLimit, std::min(t, stood.t + stood.radius), limits.max_steps};
}

/// What is proven of a ray, sample by sample; see Doubt.
template <class T>
class Proof {
 public:
  Proof(Evaluator<T>& field, const Ray<T>& ray, const MarchLimits<T>& limits)
      : field_(field), ray_(ray), limits_(limits), free_(limits.t_min), last_{limits.t_min, T(0)} {}

  Arrival<T> run() {
    T t = limits_.t_min;
    T look = T(0);  // how far ahead the solid is looked for, where a ray cannot go on
    while (steps_ < limits_.max_steps) {
      const T r = sample(t);
      if (std::isnan(r) && t <= free_) return {Status::kInvalid, kNowhere<T>, steps_};
      if (steps_ == 1 && r < -doubt_) return {Status::kInside, t, steps_};
      if (r < -doubt_ && t - (-r - doubt_) - free_ <= bracket(t)) return {Status::kHit, end(t, r), steps_};
      if (steps_ == 1 && !(r > doubt_)) return {Status::kStepLimit, t, steps_};
      const T radius = r - doubt_;
      if (radius > T(0) && t - radius <= free_ && t + radius > t) {
        const T next = t + length(t, radius);
        free_ = t + radius;
        last_ = {t, radius};
        look = T(0);
        if (free_ > limits_.t_max) return {Status::kMiss, kNowhere<T>, steps_};
        t = next;
      } else if (t > free_ && look == T(0)) {
        t = free_;
      } else {
        const bool begins = look == T(0);
        look = begins ? T(0.9375) * bracket(t) : look / T(8);
        if (begins) last_ = {free_, T(0)};
        t = std::min(free_ + look, limits_.t_max);
        if (t <= free_ || (!begins && look <= doubt_)) break;
      }
    }
    return {Status::kStepLimit, free_, steps_};
  }

 private:
  T sample(T t) {
    ++steps_;
    doubt_ = limits_.doubt_at(ray_, t);
    constexpr T kShorter = T(1) - T(32) * kUnitRoundoff<T>;
    return radius_at(field_, ray_, limits_, t) * kShorter;
  }
  T bracket(T t) const { return std::max(limits_.hit_epsilon(ray_, t), T(16) * doubt_) * T(0.96875); }

  /// As enhanced steps, or to where the slope lets hope for a hit.
  T length(T t, T radius) const {
    const T reach = T(0.9375) * bracket(t);
    const T stride = t - last_.t;
    const T growth = std::min(radius - last_.radius, T(0.9375) * stride);
    const bool plunges = stride == T(0) || -growth * (radius + reach) >= radius * stride;
    const T beyond = plunges ? reach : std::max(T(0), T(0.88) * radius * (stride + growth) / (stride - growth));
    return std::max(radius, std::min(radius + beyond, limits_.t_max - t));
  }

  T end(T t, T r) const {
    if (!limits_.finish) return free_;
    const T before = last_.radius + doubt_;
    const T root = last_.t + (t - last_.t) * before / (before - r);
    return std::clamp(root, free_, std::max(free_, t + r + doubt_));
  }

  Evaluator<T>& field_;
  const Ray<T>& ray_;
  const MarchLimits<T>& limits_;
  T free_;             ///< there is no root up to here
  RaySample<T> last_;  ///< that proved a part of that, with the radius of its ball
  T doubt_ = T(0);
  int steps_ = 0;
};

template <class T>
Arrival<T> march_ray(Evaluator<T>& field, const Ray<T>& ray, const MarchLimits<T>& limits) {
  if (!is_finite(ray.origin) || !is_finite(ray.direction) || ray.direction == Vector<T>(0)) return {};
  if (limits.t_min > limits.t_max) return {Status::kMiss, kNowhere<T>, 0};
  if (limits.method == Method::kCertified) return Proof<T>(field, ray, limits).run();
  return limits.is_straight() ? march_straight(field, ray, limits) : march_relaxed(field, ray, limits);
}

template <class T>
Surface<T> surface_at(Evaluator<T>& field, const Ray<T>& ray, const Arrival<T>& arrival, const NormalRule<T>& rule) {
  if (!has_surface(arrival.status)) return {};
  const Vector<T> position = ray.origin + ray.direction * arrival.t;
  const Vector<T> gradient = slope_at(field, position, rule);
  const Vector<T> normal = is_finite(gradient) ? direction_of(gradient) : Vector<T>(0);
  return {position, normal == Vector<T>(0) ? -ray.direction : normal, field.material(position)};
}

template struct MarchLimits<float>;
template struct MarchLimits<double>;
template Arrival<float> march_ray(Evaluator<float>&, const Ray<float>&, const MarchLimits<float>&);
template Arrival<double> march_ray(Evaluator<double>&, const Ray<double>&, const MarchLimits<double>&);
template Surface<float> surface_at(Evaluator<float>&, const Ray<float>&, const Arrival<float>&,
                                   const NormalRule<float>&);
template Surface<double> surface_at(Evaluator<double>&, const Ray<double>&, const Arrival<double>&,
                                    const NormalRule<double>&);

}  // namespace octomarch::reference
