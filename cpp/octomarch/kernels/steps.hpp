// How a march goes from sample to sample: where rays begin, when one has arrived, and how long a step is. r is the field
// over its Lipschitz bound. packets.hpp comes before; march.hpp is a
// template over these, so that one way costs nothing where another is taken.
#pragma once

#include "octomarch/kernels/api.hpp"
#include "octomarch/kernels/lanes.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

/// What a march does about its hits at the end.
enum class Finish { kNone, kSecant, kBisection };

/// Sphere tracing from t = 0 on.
template <class Real>
struct PlainSteps {
  using T = Lanes<Real>;
  static constexpr Finish kFinish = Finish::kSecant;

  explicit PlainSteps(const MarchParameters<Real>& /*parameters*/) {}

  static T start() { return Real(0); }
  static Mask<Real> begins(const T& t, const T& /*t_max*/) { return t == t; }
  static Mask<Real> arrives(const T& r, const T& epsilon) { return r <= epsilon; }
  static T length(const T& r, const T& /*epsilon*/) { return r; }
};

/// Sphere tracing from t_min on, each step shorter by a bias, but not by more than half.
template <class Real>
struct BiasedSteps {
  using T = Lanes<Real>;
  static constexpr Finish kFinish = Finish::kSecant;
  T t_min;
  T bias;

  explicit BiasedSteps(const MarchParameters<Real>& parameters) : t_min(parameters.t_min), bias(parameters.bias) {}

  T start() const { return t_min; }
  static Mask<Real> begins(const T& t, const T& t_max) { return t <= t_max; }
  static Mask<Real> arrives(const T& r, const T& epsilon) { return r <= epsilon; }
  /// The second operand of a maximum is what a NaN passes through.
  T length(const T& r, const T& /*epsilon*/) const { return max(r * T(Real(0.5)), r - bias); }
};

/// Steps of a length, or the hit epsilon, at the least, until one is in the solid.
template <class Real>
struct FixedSteps {
  using T = Lanes<Real>;
  static constexpr Finish kFinish = Finish::kBisection;
  T t_min;
  T bias;
  T step;
  T slope;

  explicit FixedSteps(const MarchParameters<Real>& parameters)
      : t_min(parameters.t_min), bias(parameters.bias), step(parameters.step), slope(parameters.epsilon_slope) {}

  T start() const { return t_min; }
  static Mask<Real> begins(const T& t, const T& t_max) { return t <= t_max; }
  static Mask<Real> arrives(const T& r, const T& /*epsilon*/) { return r <= T(Real(0)); }
  T length(const T& r, const T& epsilon) const { return max(max(step, epsilon), r - bias); }
  /// Where bisection begins when t, the sample after `before`, is inside: no more than the least step back, since a longer
  /// one went as far as the field said was free. `epsilon`: the absolute part.
  T outside(const T& before, const T& t, const T& epsilon) const {
    return max(before, t - max(step, max(epsilon, slope * before)));
  }
};

}  // namespace octomarch::kernels::OCTOMARCH_ISA
