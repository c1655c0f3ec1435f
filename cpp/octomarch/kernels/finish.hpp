// The beginning and the end of a march, over all its rays in their order: where each begins, and at the end what became of
// it, with the secant finish or bisection. march.hpp runs the steps between.
#pragma once

#include "octomarch/kernels/evaluate.hpp"
#include "octomarch/kernels/steps.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

// values of octomarch::Status, which kernels do not include
inline constexpr std::uint8_t kHit = 0, kMiss = 1, kStepLimit = 2, kInside = 3, kInvalid = 4;

constexpr bool is_relaxed(Stepping stepping) {
  return stepping == Stepping::kRelaxed || stepping == Stepping::kEnhanced || stepping == Stepping::kShadow;
}

template <class Real>
void begin_march(const RayView<Real>& rays, const MarchParameters<Real>& parameters, Real carried,
                 const MarchState<Real>& state) {
  using T = Lanes<Real>;
  const bool relaxed = is_relaxed(parameters.stepping);
  const std::size_t end = padded_lanes(rays.count);
  for (std::size_t i = 0; i < end; i += kWidth<Real>) {
    const T sum = at(rays.ox, i) + at(rays.oy, i) + at(rays.oz, i) + at(rays.dx, i) + at(rays.dy, i) + at(rays.dz, i);
    const T start = sum * T(Real(0)) + at(rays.start, i);
    start.store(state.t + i);
    T(relaxed ? kNothingBefore<Real> : carried).store(state.before + i);
    if (parameters.stepping == Stepping::kCertified) {
      start.store(state.before + i);
      start.store(state.stride + i);
      T(kNothingBefore<Real>).store(state.boldness + i);
    }
    if (!relaxed) continue;
    T(kNothingBefore<Real>).store(state.stride + i);
    T(parameters.stepping == Stepping::kShadow ? carried : kFirstBoldness<Real>).store(state.boldness + i);
  }
  for (std::size_t i = rays.count; i < end; ++i) state.t[i] = std::numeric_limits<Real>::quiet_NaN();
  for (std::size_t i = 0; state.steps != nullptr && i < rays.count; ++i) state.steps[i] = 0;
}

/// Bit i: is byte i of a block's kLanes bytes `value`? (The zero-byte test of H. S. Warren, "Hacker's Delight", 2nd ed.,
/// 6-1, and a product that brings the signs together.)
inline std::uint64_t bytes_equal(const std::uint8_t* bytes, std::uint8_t value) {
  constexpr std::uint64_t kLow = 0x7F7F7F7F7F7F7F7FULL;
  std::uint64_t bits = 0;
  for (std::size_t packet = 0; packet < kPackets; ++packet) {
    std::uint64_t word = 0;
    __builtin_memcpy(&word, bytes + packet * kPacketLanes, sizeof(word));
    word ^= value * 0x0101010101010101ULL;
    const std::uint64_t zero = ~(((word & kLow) + kLow) | word | kLow);
    bits |= ((zero >> 7) * 0x0102040810204080ULL >> 56) << (packet * kPacketLanes);
  }
  return bits;
}

/// Calls f(first ray, bits) for each block of rays, bit i being set where byte i of them is `value`.
template <class Function>
void for_each_block(std::size_t count, const std::uint8_t* bytes, std::uint8_t value, Function&& f) {
  for (std::size_t first = 0; first < count; first += kLanes) {
    const std::size_t lanes = count - first < kLanes ? count - first : kLanes;
    const std::uint64_t used = ~std::uint64_t{0} >> (kLanes - lanes);
    f(first, bytes_equal(bytes + first, value) & used);
  }
}

template <class Real>
void visibility(const RayView<Real>& rays, const MarchParameters<Real>& parameters, const MarchState<Real>& state,
                Real* out) {
  using T = Lanes<Real>;
  const Real* const seen = parameters.stepping == Stepping::kShadow ? state.boldness : state.before;
  const auto ended = static_cast<std::uint8_t>(Pause::kEnded);
  for_each_block(rays.count, state.pause, ended, [&](std::size_t first, std::uint64_t bits) {
    for (std::size_t lane = 0; lane < kLanes; lane += kWidth<Real>) {
      const std::size_t i = first + lane;
      const Mask<Real> blocked = Mask<Real>::from_bits(bits >> lane) & (T::load(state.t + i) <= at(rays.t_max, i));
      select(blocked, T(Real(0)), max(T::load(seen + i), T(Real(0)))).store(out + i);
    }
  });
}

/// Where the root of a certified hit is, about: by the secant through the last sample outside and the one inside, between the
/// ends of what is proven. Of other rays, and without a finish: how far they are free.
template <class Real>
Lanes<Real> certified_end(const RayView<Real>& rays, const MarchParameters<Real>& parameters,
                          const MarchState<Real>& state, std::size_t i) {
  using T = Lanes<Real>;
  const T zero = Real(0);
  const T t = T::load(state.t + i);
  const T free = T::load(state.before + i);
  const T stood = T::load(state.stride + i);
  const T doubts = CertifiedSteps<Real>(parameters).doubt_at(at(rays.ox, i), at(rays.oy, i), at(rays.oz, i), t);
  const T before = max(T::load(state.boldness + i), zero) + doubts;
  const T r = T::load(state.radius + i) * T(parameters.step_scale);
  const Mask<Real> has_root = (r < zero) & (t > free);
  if (!parameters.finish) return select(has_root, free, t);
  const T root = stood + (t - stood) * (before / (before - r));
  return select(has_root, min(max(root, free), max(t + r + doubts, free)), t);
}

template <class Real>
void conclude(const RayView<Real>& rays, const MarchParameters<Real>& parameters, const MarchState<Real>& state,
              std::uint8_t* status) {
  using T = Lanes<Real>;
  alignas(kAlignment) Real codes[kLanes];
  const auto code = [](std::uint8_t value) { return T(static_cast<Real>(value)); };
  const auto spent = static_cast<std::uint8_t>(Pause::kSpent);
  for_each_block(rays.count, state.pause, spent, [&](std::size_t first, std::uint64_t bits) {
    for (std::size_t lane = 0; lane < kLanes; lane += kWidth<Real>) {
      const std::size_t i = first + lane;
      Mask<Real> is_spent = Mask<Real>::from_bits(bits >> lane);
      T t = T::load(state.t + i);
      if (parameters.stepping == Stepping::kCertified) {
        is_spent = is_spent | (T::load(state.boldness + i) < T(Real(0)));
        t = select(is_spent, T::load(state.before + i), certified_end(rays, parameters, state, i));
      }
      if (is_relaxed(parameters.stepping)) {
        // No farther than the last empty sphere reaches, which a sphere in the solid can touch too. The secant finds its way
        // back by itself.
        const T beyond = max(T::load(state.stride + i) - T::load(state.before + i), T(Real(0)));
        const Real surface = parameters.finish ? -std::numeric_limits<Real>::infinity() : Real(0);
        const Mask<Real> is_past = T::load(state.radius + i) < T(surface);
        t = select(is_spent | is_past, t - beyond, t);
      }
      const T t_max = at(rays.t_max, i);
      const Mask<Real> within = t <= t_max;  // what ended otherwise is beyond t_max, or NaN
      const T found = select(t == T(parameters.t_min), code(kInside), code(kHit));
      const T lost = select(t > t_max, code(kMiss), code(kInvalid));
      const T reached = select(is_spent, code(kStepLimit), found);
      select(within, reached, lost).store(codes + lane);
      select(within, t, T(std::numeric_limits<Real>::infinity())).store(state.t + i);
    }
    for (std::size_t lane = 0; lane < kLanes; ++lane) status[first + lane] = static_cast<std::uint8_t>(codes[lane]);
  });
}

/// How far apart the last two samples of a ray were.
template <class Real>
Lanes<Real> last_step(const MarchParameters<Real>& parameters, const MarchState<Real>& state, std::size_t i) {
  using T = Lanes<Real>;
  switch (parameters.stepping) {
    case Stepping::kPlain: return T::load(state.before + i);
    case Stepping::kBiased: return BiasedSteps<Real>(parameters).length(T::load(state.before + i), T(Real(0)));
    default: return T::load(state.stride + i);
  }
}

/// The way from a sample to the root of the secant through two, trusted for 32 times the field there at the most, and not
/// at all where the field did not fall between them. `apart`: from the sample before.
template <class T>
T to_root(const T& before, const T& r, const T& apart) {
  using Real = typename T::Real;
  const T root = select(r < before, r * apart / (before - r), T(Real(0)));
  return min(root, T(Real(32)) * max(r, T(Real(0))));
}

/// Hits that have been followed to their end carry 0.
template <class Real>
bool secants(const RayView<Real>& rays, const MarchParameters<Real>& parameters, const MarchState<Real>& state,
             const std::uint8_t* status, Real* ends, const Vectors<Real>& points, Counters& counters) {
  using T = Lanes<Real>;
  const T nowhere = std::numeric_limits<Real>::quiet_NaN();
  bool any = false;
  for_each_block(rays.count, status, kHit, [&](std::size_t first, std::uint64_t hits) {
    std::uint64_t open = 0;
    for (std::size_t lane = 0; lane < kLanes; lane += kWidth<Real>) {
      const std::size_t i = first + lane;
      const T t = T::load(state.t + i);
      const T before = T::load(state.before + i);
      const Mask<Real> is_open = Mask<Real>::from_bits(hits >> lane) & (before > T(Real(0)));
      const T r = T::load(state.radius + i) * T(parameters.step_scale);
      const T step = to_root(before, r, last_step(parameters, state, i));
      const T end = select(is_open, min(t + step, at(rays.t_max, i)), nowhere);
      open |= is_open.bits() << lane;
      end.store(ends + i);
      (at(rays.ox, i) + end * at(rays.dx, i)).store(points.x + i);
      (at(rays.oy, i) + end * at(rays.dy, i)).store(points.y + i);
      (at(rays.oz, i) + end * at(rays.dz, i)).store(points.z + i);
    }
    counters.evaluations += static_cast<std::uint64_t>(__builtin_popcountll(open));
    any = any || open != 0;
  });
  return any;
}

/// On a surface the secant all but closes the gap; where a sixteenth of the hit epsilon is left, a ray that only grazes an
/// edge was sent past it, and the sample stands. What is left is followed along the secant through the sample and that
/// end, which costs no evaluation. A ray that hit with its first sample has no secant: it goes to the end of the empty sphere,
/// where it has one.
template <class Real>
void follow_secants(const RayView<Real>& rays, const MarchParameters<Real>& parameters, const MarchState<Real>& state,
                    const std::uint8_t* status, const Real* ends, const Real* field) {
  using T = Lanes<Real>;
  for_each_block(rays.count, status, kHit, [&](std::size_t first, std::uint64_t hits) {
    for (std::size_t lane = 0; hits != 0 && lane < kLanes; lane += kWidth<Real>) {
      const std::size_t i = first + lane;
      const T t = T::load(state.t + i);
      const T end = T::load(ends + i);
      const T before = T::load(state.before + i);
      const T value = T::load(field + i);
      const Mask<Real> is_open = Mask<Real>::from_bits(hits >> lane) & (before > T(Real(0)));
      const T r_before = T::load(state.radius + i) * T(parameters.step_scale);
      const T r = value * T(parameters.step_scale);
      const T epsilon = max(at(rays.epsilon, i), T(parameters.epsilon_slope) * end);
      const Mask<Real> kept = is_open & (abs(r) <= epsilon * T(Real(0.0625)));
      const Mask<Real> again = is_open & !kept & (before == T(kNothingBefore<Real>)) & (abs(r) < r_before);
      const T fall = r_before - r;
      const T more = select(abs(r) < abs(fall), r * (end - t) / fall, T(Real(0)));  // no farther than the secant itself
      select(kept, min(end + more, at(rays.t_max, i)), select(again, end, t)).store(state.t + i);
      select(again, r_before, T(Real(0))).store(state.before + i);
      select(again, end - t, T(Real(0))).store(state.stride + i);
      select(again, value, T::load(state.radius + i)).store(state.radius + i);
    }
  });
}

/// Halves the way from the last sample outside to the first inside until a 1024th of it is left; t becomes its end outside.
/// Ten evaluations for each hit.
template <class Real>
void bisect(const TapeView<Real>& tape, Real* registers, const RayView<Real>& rays,
            const MarchParameters<Real>& parameters, const MarchState<Real>& state, const std::uint8_t* status,
            Counters& counters) {
  using T = Lanes<Real>;
  constexpr int kHalvings = 10;
  const FixedSteps<Real> way(parameters);
  alignas(kAlignment) Real outside[kLanes];
  alignas(kAlignment) Real inside[kLanes];
  alignas(kAlignment) Real middle[kLanes];
  for_each_block(rays.count, status, kHit, [&](std::size_t first, std::uint64_t hits) {
    const std::size_t count = batches<Real>(rays.count - first < kLanes ? rays.count - first : kLanes);
    for_each_batch<Real>(count, [&](std::size_t lane) {
      const std::size_t i = first + lane;
      const T t = T::load(state.t + i);
      const T from = way.outside(T::load(state.before + i), t, at(rays.epsilon, i));
      t.store(inside + lane);
      select(Mask<Real>::from_bits(hits >> lane), from, t).store(outside + lane);
    });
    for (int halving = 0; hits != 0 && halving < kHalvings; ++halving) {
      if (is_set(parameters.cancelled)) return;
      for_each_batch<Real>(count, [&](std::size_t lane) {
        const std::size_t i = first + lane;
        const T from = T::load(outside + lane);
        const T half = from + (T::load(inside + lane) - from) * T(Real(0.5));
        half.store(middle + lane);
        (at(rays.ox, i) + half * at(rays.dx, i)).store(registers + lane);
        (at(rays.oy, i) + half * at(rays.dy, i)).store(registers + kLanes + lane);
        (at(rays.oz, i) + half * at(rays.dz, i)).store(registers + 2 * kLanes + lane);
      });
      counters.evaluations += static_cast<std::uint64_t>(__builtin_popcountll(hits));
      counters.lane_slots += count * kWidth<Real>;
      const Real* const field = evaluate(tape, registers, count);
      for_each_batch<Real>(count, [&](std::size_t lane) {
        const Mask<Real> in_solid = T::load(field + lane) * T(parameters.step_scale) <= T(Real(0));
        const T half = T::load(middle + lane);
        select(in_solid, half, T::load(inside + lane)).store(inside + lane);
        select(in_solid, T::load(outside + lane), half).store(outside + lane);
      });
    }
    for_each_batch<Real>(count, [&](std::size_t lane) {
      const T t = T::load(state.t + first + lane);
      select(Mask<Real>::from_bits(hits >> lane), T::load(outside + lane), t).store(state.t + first + lane);
    });
  });
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
