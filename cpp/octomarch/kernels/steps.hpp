// How a march goes from sample to sample: when a ray has arrived, and how long a step is. r is the field over its Lipschitz
// bound, so the sphere of that radius about a sample is empty. packets.hpp comes before; march.hpp is a template over
// these, so that one way costs nothing where another is taken.
#pragma once

#include "octomarch/kernels/api.hpp"
#include "octomarch/kernels/lanes.hpp"
#include "octomarch/kernels/packets.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

/// What a march does about its hits at the end.
enum class Finish { kNone, kSecant, kBisection };

/// The part of r by which kRelaxed goes beyond it.
template <class Real>
inline constexpr Real kFirstBoldness = Real(0.6);

/// A batch of rays at a sample, and where they go from there.
template <class Real>
struct Step {
  Mask<Real> goes_on;
  Lanes<Real> next;  ///< t of the next sample; the same t where a ray does not go on
};

/// A step of a way whose samples are where the last step said. It goes on unless it "has arrived": a NaN field has to move
/// t, and make it NaN.
template <class Real, class Way>
Step<Real> straight_step(const Way& way, const Lanes<Real>& t, const Lanes<Real>& r, const Lanes<Real>& epsilon,
                         const Lanes<Real>& t_max) {
  const Mask<Real> goes_on = (t <= t_max) & !way.arrives(r, epsilon);
  return {goes_on, select(goes_on, t + way.length(r, epsilon), t)};
}

/// Sphere tracing.
template <class Real>
struct PlainSteps {
  using T = Lanes<Real>;
  static constexpr Finish kFinish = Finish::kSecant;
  static constexpr bool kIsRelaxed = false;

  explicit PlainSteps(const MarchParameters<Real>& /*parameters*/) {}

  static Mask<Real> arrives(const T& r, const T& epsilon) { return r <= epsilon; }
  static T length(const T& r, const T& /*epsilon*/) { return r; }
  Step<Real> advance(BlockState<Real>& /*state*/, std::size_t /*lane*/, const T& t, const T& r, const T& epsilon,
                     const T& t_max) const {
    return straight_step(*this, t, r, epsilon, t_max);
  }
};

/// Sphere tracing, each step shorter by a bias, but not by more than half.
template <class Real>
struct BiasedSteps {
  using T = Lanes<Real>;
  static constexpr Finish kFinish = Finish::kSecant;
  static constexpr bool kIsRelaxed = false;
  T bias;

  explicit BiasedSteps(const MarchParameters<Real>& parameters) : bias(parameters.bias) {}

  static Mask<Real> arrives(const T& r, const T& epsilon) { return r <= epsilon; }
  /// The second operand of a maximum is what a NaN passes through.
  T length(const T& r, const T& /*epsilon*/) const { return max(r * T(Real(0.5)), r - bias); }
  Step<Real> advance(BlockState<Real>& /*state*/, std::size_t /*lane*/, const T& t, const T& r, const T& epsilon,
                     const T& t_max) const {
    return straight_step(*this, t, r, epsilon, t_max);
  }
};

/// Steps of a length, or the hit epsilon, at the least, until one is in the solid.
template <class Real>
struct FixedSteps {
  using T = Lanes<Real>;
  static constexpr Finish kFinish = Finish::kBisection;
  static constexpr bool kIsRelaxed = false;
  T bias;
  T step;
  T slope;

  explicit FixedSteps(const MarchParameters<Real>& parameters)
      : bias(parameters.bias), step(parameters.step), slope(parameters.epsilon_slope) {}

  static Mask<Real> arrives(const T& r, const T& /*epsilon*/) { return r <= T(Real(0)); }
  T length(const T& r, const T& epsilon) const { return max(max(step, epsilon), r - bias); }
  Step<Real> advance(BlockState<Real>& /*state*/, std::size_t /*lane*/, const T& t, const T& r, const T& epsilon,
                     const T& t_max) const {
    return straight_step(*this, t, r, epsilon, t_max);
  }
  /// Where bisection begins when t, the sample after `before`, is inside: no more than the least step back, since a longer
  /// one went as far as the field said was free. `epsilon`: the absolute part.
  T outside(const T& before, const T& t, const T& epsilon) const {
    return max(before, t - max(step, max(epsilon, slope * before)));
  }
};

/// 1/a less 0.3 % of it at the most, for a > 0: by the bits, since logarithms of numbers are nearly linear in them, and a
/// step of Newton. Made of operations that are the same everywhere, unlike the instructions for it.
template <class Real>
Lanes<Real> rough_reciprocal(const Lanes<Real>& a) {
  using T = Lanes<Real>;
  using Integer = typename T::Integer;
  constexpr Integer kMagic = sizeof(Real) == 4 ? Integer(0x7EF311C7) : static_cast<Integer>(0x7FDE6238DA3C2118);
  const T guess = T::from_bits(typename T::Bits(kMagic) - a.bits());
  return guess * (T(Real(2)) - a * guess);
}

/// Sphere tracing with steps longer than the empty sphere, which go back to its end where the next one does not touch it.
/// kRelaxed: by 0.6 of the radius, for as long as that holds (B. Keinert et al., "Enhanced sphere tracing", STAG 2014).
/// kEnhanced: by 0.88 of what the slope of the last step lets hope (C. Bálint, G. Valasek, "Accelerating sphere tracing",
/// EG 2018). kShadow: the same, but for where the light is dimmed or nearly so, for that is read off the samples. The state's
/// `carried` is r of the last sample that the ray stands by, `stride` how far it has gone from there.
template <class Real, Stepping kStepping>
struct LongSteps {
  using T = Lanes<Real>;
  static constexpr Finish kFinish = Finish::kSecant;
  static constexpr bool kIsRelaxed = true;
  static constexpr Real kStrength = Real(0.88);
  /// Slopes are taken for less than 1, at which a ray would never come near anything again.
  static constexpr Real kSteepest = Real(0.9375);

  /// Shadow rays take long steps where k·r/t, of which 1 is full light, is no less than this.
  static constexpr Real kClear = Real(2);
  T k;

  explicit LongSteps(const MarchParameters<Real>& parameters) : k(parameters.k) {}

  Step<Real> advance(BlockState<Real>& state, std::size_t lane, const T& t, const T& r, const T& epsilon,
                     const T& t_max) const {
    const T before = T::load(state.carried + lane);
    const T stride = T::load(state.stride + lane);
    const Mask<Real> within = t <= t_max;
    // beyond the empty sphere the field may be no number either
    const Mask<Real> back = within & (stride > before) & !(stride <= before + abs(r));
    // not "has not arrived", see straight_step
    const Mask<Real> forth = within & !back & !(r <= epsilon);
    T beyond;
    if constexpr (kStepping == Stepping::kRelaxed) {
      const T boldness = T::load(state.boldness + lane);
      beyond = r * boldness;
      select(back, T(Real(0)), boldness).store(state.boldness + lane);
    } else {
      const T growth = min(r - before, stride * T(kSteepest));
      beyond = r * T(kStrength) * (stride + growth) * rough_reciprocal(stride - growth);
    }
    if constexpr (kStepping == Stepping::kShadow) beyond = select(k * r >= T(kClear) * t, beyond, T(Real(0)));
    // What lies between the last empty sphere and t_max is not passed unseen. The way there is a little less than it is, so
    // that no sum is rounded to what is past t_max. A NaN passes a maximum's second operand.
    const T way_left = (t_max - t) * T(Real(1) - Real(4) * std::numeric_limits<Real>::epsilon());
    const T length = max(min(r + beyond, way_left), r);
    select(forth, r, before).store(state.carried + lane);
    select(forth, length, select(back, before, stride)).store(state.stride + lane);
    return {back | forth, t + select(forth, length, select(back, before - stride, T(Real(0))))};
  }
};

/// Steps that nothing is missed by. A sample proves its sign in the sphere of |r| less its `doubt`, which is what r may be off
/// by. A ray stays free up to where such spheres of samples outside of the solid have covered it; longer steps than that are
/// those of kEnhanced, or end a bracket past the free part where the slope lets hope for the solid there. The ray has hit where
/// a sample's sphere lies in the solid, and no more than a bracket past the free part. One that cannot go on looks for the
/// solid at ever less of a bracket, and ends undecided where that finds nothing.
///
/// The state's `carried` is how far the ray is free, `stride` the t of the last sample that proved a part of that, `boldness`
/// the radius of its sphere: kNothingBefore at first, 0 where the ray cannot go on, −1 once it is undecided.
template <class Real>
struct CertifiedSteps {
  using T = Lanes<Real>;
  static constexpr Finish kFinish = Finish::kNone;
  static constexpr bool kIsRelaxed = true;
  /// What of a bracket is used, so that roundings of its ends do not count.
  static constexpr Real kPart = Real(0.9375), kWhole = Real(0.96875);
  T doubt, slope, farthest;

  explicit CertifiedSteps(const MarchParameters<Real>& parameters)
      : doubt(parameters.doubt), slope(parameters.doubt_slope), farthest(parameters.doubt_reach) {}

  T doubt_at(const T& ox, const T& oy, const T& oz, const T& t) const {
    const T far = max(abs(ox), max(abs(oy), abs(oz))) + t;
    return select(far <= farthest, doubt + slope * far, T(std::numeric_limits<Real>::infinity()));
  }
  /// Less than so many doubts no two samples can be apart that prove a root between them, where rays are not steep.
  static T bracket(const T& epsilon, const T& doubts) { return max(epsilon, T(Real(kDoubtsOfBracket)) * doubts); }

  Step<Real> advance(BlockState<Real>& state, std::size_t lane, const T& t, const T& r, const T& epsilon,
                     const T& t_max) const {
    const T free = T::load(state.carried + lane);
    const T stood = T::load(state.stride + lane);
    const T before = T::load(state.boldness + lane);
    const T doubts = doubt_at(T::load(state.ox + lane), T::load(state.oy + lane), T::load(state.oz + lane), t);
    const T most = bracket(epsilon, doubts);
    const T reach = most * T(kPart);
    const T radius = abs(r) - doubts;
    const Mask<Real> open = (t <= t_max) & (before >= T(Real(0)));
    const Mask<Real> gains = open & (r > doubts) & (t - radius <= free) & (t + radius > t);
    const Mask<Real> found = open & (r < -doubts) & (t - radius - free <= most * T(kWhole));
    const Mask<Real> fails = open & !gains & !found;
    const Mask<Real> stands = t <= free;
    const Mask<Real> is_nan = fails & stands & !(r == r);
    const Mask<Real> is_first = before == T(kNothingBefore<Real>);
    const Mask<Real> is_stuck = fails & stands & !is_first & !is_nan;
    const Mask<Real> back = fails & !stands & (before > T(Real(0)));
    const Mask<Real> looks = fails & !stands & (before == T(Real(0)));

    const T stride = t - stood;
    const T growth = min(radius - before, stride * T(LongSteps<Real, Stepping::kEnhanced>::kSteepest));
    const T hoped = radius * T(LongSteps<Real, Stepping::kEnhanced>::kStrength) * (stride + growth) *
                    rough_reciprocal(stride - growth);
    const Mask<Real> plunges = (radius + reach) * -growth >= radius * stride;
    const T beyond = select(plunges, reach, max(hoped, T(Real(0))));
    const T way_left = (t_max - t) * T(Real(1) - Real(4) * std::numeric_limits<Real>::epsilon());
    const T onward = t + max(min(radius + beyond, way_left), radius);

    const T closer = (t - free) * T(Real(0.125));
    const T look = select(is_stuck, min(free + reach, t_max), free + closer);
    const Mask<Real> looks_on = (is_stuck & (look > free)) | (looks & (closer > doubts) & (look > free));
    const Mask<Real> gives_up = fails & !is_nan & !back & !looks_on;
    select(gains, t + radius, free).store(state.carried + lane);
    select(gains, t, select(is_stuck, free, stood)).store(state.stride + lane);
    select(gains, radius, select(gives_up, T(Real(-1)), select(is_stuck, T(Real(0)), before)))
        .store(state.boldness + lane);
    const T next = select(gains, onward, select(back, free, select(looks_on, look, select(is_nan, r, t))));
    return {gains | back | looks_on | is_nan, next};
  }
};

/// Steps of a cone about its axis: where the field is r, all its rays are free as far as t + r less the cone's width there. It ends
/// where it would gain less than a quarter of its width, or no more than rays take for a hit. The state's `carried` is the width
/// at its origin, `stride` what is added for each unit of t; they stay, and are kept as for relaxed steps.
template <class Real>
struct ConeSteps {
  using T = Lanes<Real>;
  static constexpr Finish kFinish = Finish::kNone;
  static constexpr bool kIsRelaxed = true;
  T bias;

  explicit ConeSteps(const MarchParameters<Real>& parameters) : bias(parameters.bias) {}

  Step<Real> advance(BlockState<Real>& state, std::size_t lane, const T& t, const T& r, const T& epsilon,
                     const T& t_max) const {
    const T margin = Real(1.01);  // for what rounding adds to the width
    const T width = (T::load(state.carried + lane) + T::load(state.stride + lane) * t) * margin;
    const T gain = r - bias - width - epsilon;
    const Mask<Real> goes_on = (gain > width * T(Real(0.25))) & (gain > epsilon) & (t <= t_max);
    return {goes_on, select(goes_on, t + gain, t)};
  }
};

}  // namespace octomarch::kernels::OCTOMARCH_ISA
