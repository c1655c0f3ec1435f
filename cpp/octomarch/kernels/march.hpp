// Sphere tracing in blocks: 8 packets of 8 rays stepped together by the tape interpreter, a packet's slot refilled with
// the next packet of the stream as soon as all its rays have ended. J. C. Hart, "Sphere tracing", The Visual Computer
// 12(10), 1996.
//
// A step leaves a ray that has ended as it is: at a hit t stays and hits again, past t_max it stays past, a NaN stays
// NaN. So no mask is kept with the state; which rays live is read off each step as one 64-bit word, and what became of
// a ray is read off (t, r) when its packet retires.
#pragma once

#include <limits>

#include "octomarch/kernels/evaluate.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

/// State of the rays in a block, one row of kLanes per quantity.
template <class Real>
struct BlockState {
  alignas(kAlignment) Real ox[kLanes];
  alignas(kAlignment) Real oy[kLanes];
  alignas(kAlignment) Real oz[kLanes];
  alignas(kAlignment) Real dx[kLanes];
  alignas(kAlignment) Real dy[kLanes];
  alignas(kAlignment) Real dz[kLanes];
  alignas(kAlignment) Real t[kLanes];
  alignas(kAlignment) Real t_max[kLanes];
  alignas(kAlignment) Real epsilon[kLanes];
  alignas(kAlignment) Real carried[kLanes];  ///< what the task remembers: the last accepted step, or a visibility

  /// Copies the packet in slot `from` to slot `to`.
  void move_packet(std::size_t from, std::size_t to) {
    Real* const rows[] = {ox, oy, oz, dx, dy, dz, t, t_max, epsilon, carried};
    for (Real* row : rows) {
      for (std::size_t lane = 0; lane < kPacketLanes; ++lane) row[to * kPacketLanes + lane] = row[from * kPacketLanes + lane];
    }
  }
};

template <class Real>
void fill_lanes(Real* row, const Column<Real>& column, std::size_t first, std::size_t valid) {
  for (std::size_t lane = 0; lane < kPacketLanes; ++lane) {
    row[lane] = column.values == nullptr ? column.value : column.values[lane < valid ? first + lane : first];
  }
}

/// Finds hits. Carried: r of the last sample that was no hit, for the secant finish.
template <class Real>
struct HitTask {
  using T = Lanes<Real>;
  MarchOutput<Real> out;
  bool secant_finish;
  Real step_scale;

  static constexpr Real kFirstCarried = 0;
  std::int32_t* steps() const { return out.steps; }

  void observe(BlockState<Real>& state, std::size_t lane, const T& /*t*/, const T& r, const Mask<Real>& hit) const {
    select(hit, T::load(state.carried + lane), r).store(state.carried + lane);
  }

  /// Writes what became of the rays of one slot; `live`: bits of those that ran out of steps.
  void retire(const BlockState<Real>& state, const Real* field, Real slope, std::size_t slot, unsigned live,
              std::size_t first, std::size_t valid) const {
    for (std::size_t i = 0; i < valid; ++i) {
      const std::size_t lane = slot * kPacketLanes + i;
      const Real t = state.t[lane];
      const Real r = field[lane] * step_scale;
      const Real scaled = slope * t;
      const Real epsilon = state.epsilon[lane] > scaled ? state.epsilon[lane] : scaled;
      Real result = std::numeric_limits<Real>::infinity();
      std::uint8_t status = kInvalid;
      if ((live >> i & 1U) != 0) {
        status = kStepLimit;
        result = t;
      } else if (t > state.t_max[lane]) {
        status = kMiss;
      } else if (r < epsilon && t >= Real(0)) {
        status = t == Real(0) ? kInside : kHit;
        result = t;
        if (status == kHit && secant_finish) result = finished(t, r, state.carried[lane], state.t_max[lane]);
      }
      out.t[first + i] = result;
      if (out.status != nullptr) out.status[first + i] = status;
    }
  }

 private:
  // values of octomarch::Status, which kernels do not include
  static constexpr std::uint8_t kHit = 0, kMiss = 1, kStepLimit = 2, kInside = 3, kInvalid = 4;

  /// The secant through the last two samples, trusted for 32 times the last distance at the most.
  static Real finished(Real t, Real r, Real previous, Real t_max) {
    const Real root = r * previous / (previous - r);
    const Real farthest = Real(32) * (r > Real(0) ? r : Real(0));
    const Real end = t + (root < farthest ? root : farthest);
    return end < t_max ? end : t_max;
  }
};

/// Finds how much of a light passes. Carried: the visibility so far.
template <class Real>
struct ShadowTask {
  using T = Lanes<Real>;
  Real* visibility;
  T k;
  Real step_scale;

  static constexpr Real kFirstCarried = 1;
  std::int32_t* steps() const { return nullptr; }

  void observe(BlockState<Real>& state, std::size_t lane, const T& t, const T& r, const Mask<Real>& /*hit*/) const {
    const T so_far = T::load(state.carried + lane);
    const T penumbra = min(k * r / t, so_far);
    select(t <= T::load(state.t_max + lane), penumbra, so_far).store(state.carried + lane);
  }

  void retire(const BlockState<Real>& state, const Real* field, Real slope, std::size_t slot, unsigned live,
              std::size_t first, std::size_t valid) const {
    for (std::size_t i = 0; i < valid; ++i) {
      const std::size_t lane = slot * kPacketLanes + i;
      const Real scaled = slope * state.t[lane];
      const Real epsilon = state.epsilon[lane] > scaled ? state.epsilon[lane] : scaled;
      const bool ended = (live >> i & 1U) == 0 && state.t[lane] <= state.t_max[lane];
      const bool blocked = ended && field[lane] * step_scale < epsilon;
      visibility[first + i] = blocked || !(state.carried[lane] > Real(0)) ? Real(0) : state.carried[lane];
    }
  }
};

template <class Real, class Task>
class Marcher {
  using T = Lanes<Real>;

 public:
  Marcher(const TapeView<Real>& tape, Real* registers, const RayView<Real>& rays, const MarchParameters<Real>& parameters,
          const Task& task, Counters& counters)
      : tape_(tape), registers_(registers), rays_(rays), parameters_(parameters), task_(task), counters_(counters) {}

  void run() {
    while (slots_ < kPackets && load(slots_)) ++slots_;
    for (step_ = 0; slots_ > 0; ++step_) {
      if (__atomic_load_n(parameters_.cancelled, __ATOMIC_RELAXED)) return;
      const std::size_t count = batches<Real>(slots_ * kPacketLanes);
      counters_.evaluations += static_cast<std::uint64_t>(__builtin_popcountll(live_));
      counters_.lane_slots += count * kWidth<Real>;
      place_points(count);
      const Real* field = evaluate(tape_, registers_, count);
      const std::uint64_t live = advance(field, count);
      if (task_.steps() != nullptr) record_steps(live_ & ~live);
      live_ = live;
      retire_ended(field);
    }
  }

 private:
  /// Coordinates of every lane's sample point into registers 0, 1, 2.
  void place_points(std::size_t count) {
    for (std::size_t lane = 0; lane < count * kWidth<Real>; lane += kWidth<Real>) {
      const T t = T::load(state_.t + lane);
      (T::load(state_.ox + lane) + t * T::load(state_.dx + lane)).store(registers_ + lane);
      (T::load(state_.oy + lane) + t * T::load(state_.dy + lane)).store(registers_ + kLanes + lane);
      (T::load(state_.oz + lane) + t * T::load(state_.dz + lane)).store(registers_ + 2 * kLanes + lane);
    }
  }

  /// One step of every lane; returns which rays go on. Slots that hold no packet stay out of the word.
  std::uint64_t advance(const Real* field, std::size_t count) {
    const T step_scale = parameters_.step_scale;
    const T slope = parameters_.epsilon_slope;
    std::uint64_t live = 0;
    for (std::size_t lane = 0; lane < count * kWidth<Real>; lane += kWidth<Real>) {
      const T t = T::load(state_.t + lane);
      const T r = T::load(field + lane) * step_scale;
      const Mask<Real> hit = r < max(T::load(state_.epsilon + lane), slope * t);
      const T next = select(hit, t, t + r);
      task_.observe(state_, lane, t, r, hit);
      next.store(state_.t + lane);
      live |= ((next <= T::load(state_.t_max + lane)) & !hit).bits() << lane;
    }
    return slots_ == kPackets ? live : live & ((std::uint64_t{1} << (slots_ * kPacketLanes)) - 1);
  }

  void record_steps(std::uint64_t ended) {
    for (; ended != 0; ended &= ended - 1) {
      const auto lane = static_cast<std::size_t>(__builtin_ctzll(ended));
      const std::size_t slot = lane / kPacketLanes;
      task_.steps()[first_ray_[slot] + lane % kPacketLanes] = static_cast<std::int32_t>(step_ - start_[slot] + 1);
    }
  }

  /// Packets without a live ray, and those whose steps are spent, leave; others take their slots.
  void retire_ended(const Real* field) {
    const bool any_spent = step_ + 1 >= deadline_;
    if (!any_spent && !has_zero_byte(live_)) return;
    for (std::size_t slot = slots_; slot-- > 0;) {
      const auto live = static_cast<unsigned>(live_ >> (slot * kPacketLanes) & 0xFFU);
      if (live != 0 && step_ + 1 - start_[slot] < parameters_.max_steps) continue;
      const std::size_t valid = valid_rays(first_ray_[slot]);
      if (task_.steps() != nullptr) record_steps(std::uint64_t{live} << (slot * kPacketLanes));
      task_.retire(state_, field, parameters_.epsilon_slope, slot, live, first_ray_[slot], valid);
      if (!load(slot)) close(slot);
    }
    deadline_ = std::numeric_limits<std::int64_t>::max();
    for (std::size_t slot = 0; slot < slots_; ++slot) {
      if (start_[slot] + parameters_.max_steps < deadline_) deadline_ = start_[slot] + parameters_.max_steps;
    }
  }

  bool has_zero_byte(std::uint64_t word) const {
    const std::uint64_t unused = slots_ == kPackets ? 0 : ~std::uint64_t{0} << (slots_ * kPacketLanes);
    const std::uint64_t w = word | unused;
    return ((w - 0x0101010101010101ULL) & ~w & 0x8080808080808080ULL) != 0;
  }

  std::size_t valid_rays(std::size_t first) const {
    const std::size_t left = rays_.count - first;
    return left < kPacketLanes ? left : kPacketLanes;
  }

  /// Puts the next packet of the stream into a slot; false when there is none. Lanes past the end, and rays that are not
  /// finite or not of unit length, get t = NaN: they never live, and touch no other lane.
  bool load(std::size_t slot) {
    if (next_ray_ >= rays_.count) return false;
    const std::size_t first = next_ray_;
    const std::size_t valid = valid_rays(first);
    const std::size_t lane = slot * kPacketLanes;
    next_ray_ += kPacketLanes;
    first_ray_[slot] = first;
    start_[slot] = step_ + 1;
    fill_lanes(state_.ox + lane, rays_.ox, first, valid);
    fill_lanes(state_.oy + lane, rays_.oy, first, valid);
    fill_lanes(state_.oz + lane, rays_.oz, first, valid);
    fill_lanes(state_.dx + lane, rays_.dx, first, valid);
    fill_lanes(state_.dy + lane, rays_.dy, first, valid);
    fill_lanes(state_.dz + lane, rays_.dz, first, valid);
    fill_lanes(state_.t_max + lane, rays_.t_max, first, valid);
    fill_lanes(state_.epsilon + lane, rays_.epsilon, first, valid);
    std::uint64_t live = 0;
    for (std::size_t i = 0; i < kPacketLanes; ++i) {
      const bool good = i < valid && is_valid_ray(lane + i);
      state_.t[lane + i] = good ? Real(0) : std::numeric_limits<Real>::quiet_NaN();
      state_.carried[lane + i] = Task::kFirstCarried;
      live |= std::uint64_t{good} << i;
      if (i < valid && task_.steps() != nullptr) task_.steps()[first + i] = 0;
    }
    live_ = (live_ & ~(std::uint64_t{0xFF} << lane)) | live << lane;
    ++counters_.packets;
    if (start_[slot] + parameters_.max_steps < deadline_) deadline_ = start_[slot] + parameters_.max_steps;
    return true;
  }

  bool is_valid_ray(std::size_t lane) const {
    const Real length2 = state_.dx[lane] * state_.dx[lane] + state_.dy[lane] * state_.dy[lane] + state_.dz[lane] * state_.dz[lane];
    const Real zero = (state_.ox[lane] - state_.ox[lane]) + (state_.oy[lane] - state_.oy[lane]) + (state_.oz[lane] - state_.oz[lane]);
    return length2 > Real(0.5) && length2 < Real(2) && zero == Real(0);
  }

  /// Takes a slot out of the block: the last one moves into its place, so that fewer batches are computed.
  void close(std::size_t slot) {
    --slots_;
    const std::size_t last = slots_;
    const std::uint64_t moved = live_ >> (last * kPacketLanes) & 0xFFU;
    live_ &= ~(std::uint64_t{0xFF} << (last * kPacketLanes));
    if (slot == last) return;
    live_ = (live_ & ~(std::uint64_t{0xFF} << (slot * kPacketLanes))) | moved << (slot * kPacketLanes);
    state_.move_packet(last, slot);
    first_ray_[slot] = first_ray_[last];
    start_[slot] = start_[last];
  }

  const TapeView<Real> tape_;
  Real* const registers_;
  const RayView<Real> rays_;
  const MarchParameters<Real> parameters_;
  const Task task_;
  Counters& counters_;

  BlockState<Real> state_{};
  std::size_t first_ray_[kPackets] = {};
  std::int64_t start_[kPackets] = {};  ///< block step at which each packet takes its first sample
  std::int64_t step_ = -1;
  std::int64_t deadline_ = std::numeric_limits<std::int64_t>::max();  ///< first block step at which a packet is spent
  std::uint64_t live_ = 0;
  std::size_t slots_ = 0;
  std::size_t next_ray_ = 0;
};

template <class Real>
void march(const TapeView<Real>& tape, Real* registers, const RayView<Real>& rays,
           const MarchParameters<Real>& parameters, const MarchOutput<Real>& out, Counters& counters) {
  const HitTask<Real> task{out, parameters.secant_finish, parameters.step_scale};
  Marcher<Real, HitTask<Real>>(tape, registers, rays, parameters, task, counters).run();
}

template <class Real>
void shadow(const TapeView<Real>& tape, Real* registers, const RayView<Real>& rays,
            const MarchParameters<Real>& parameters, Real k, Real* visibility, Counters& counters) {
  const ShadowTask<Real> task{visibility, Lanes<Real>(k), parameters.step_scale};
  Marcher<Real, ShadowTask<Real>>(tape, registers, rays, parameters, task, counters).run();
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
