// Sphere tracing in blocks: 8 packets of 8 rays stepped together by the tape interpreter, a packet's slot refilled with
// the next packet of the stream as soon as all its rays have ended. J. C. Hart, "Sphere tracing", The Visual Computer
// 12(10), 1996.
//
// A step leaves a ray that has ended as it is: at a hit t stays and hits again, past t_max it stays there, a NaN stays
// NaN. So no mask is kept with the state; which rays live is read off each step as one 64-bit word, and what became of
// a ray is read off t when its packet retires.
//
// Two blocks take turns. Whether packets of one have ended is looked at only after the other's step has been issued:
// the mispredicted branch of a retirement then finds the processor busy instead of drained.
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
  alignas(kAlignment) Real carried[kLanes];  ///< what the task remembers: the last accepted r, or a visibility
};

/// A block: its rays, and for each of its packets which rays they are and when they came.
template <class Real>
struct Block {
  BlockState<Real> state{};
  std::size_t first_ray[kPackets] = {};
  std::int64_t start[kPackets] = {};                                 ///< value of `step` at which each packet came
  std::int64_t step = 0;                                             ///< steps made so far
  std::int64_t deadline = std::numeric_limits<std::int64_t>::max();  ///< value of `step` at which a packet is spent
  std::uint64_t live = 0;                                            ///< rays that go on; bit = lane
  std::size_t slots = 0;                                             ///< packets held, in the first slots
  Real* registers = nullptr;                                         ///< a register file of its own

  std::uint64_t used_lanes() const {
    return slots == kPackets ? ~std::uint64_t{0} : (std::uint64_t{1} << (slots * kPacketLanes)) - 1;
  }

  /// Does a packet have no live ray left? (The zero-byte test of H. S. Warren, "Hacker's Delight", 2nd ed., 6-1.)
  bool any_ended() const {
    const std::uint64_t w = live | ~used_lanes();
    return ((w - 0x0101010101010101ULL) & ~w & 0x8080808080808080ULL) != 0;
  }

  void set_live(std::size_t slot, std::uint64_t bits) {
    live = (live & ~(std::uint64_t{0xFF} << (slot * kPacketLanes))) | bits << (slot * kPacketLanes);
  }

  /// Takes a packet out: the last one moves into its slot, so that fewer batches are computed.
  void close(std::size_t slot) {
    --slots;
    const std::uint64_t moved = live >> (slots * kPacketLanes) & 0xFFU;
    set_live(slots, 0);
    if (slot == slots) return;
    set_live(slot, moved);
    first_ray[slot] = first_ray[slots];
    start[slot] = start[slots];
    Real* const rows[] = {state.ox, state.oy, state.oz,    state.dx,      state.dy,
                          state.dz, state.t,  state.t_max, state.epsilon, state.carried};
    for (Real* row : rows) {
      __builtin_memcpy(row + slot * kPacketLanes, row + slots * kPacketLanes, kPacketLanes * sizeof(Real));
    }
  }
};

/// Copies the first `valid` lanes of a packet, all of them in the common case by moves of known size.
template <class T>
void copy_packet(T* to, const T* from, std::size_t valid) {
  if (valid == kPacketLanes) {
    __builtin_memcpy(to, from, kPacketLanes * sizeof(T));
  } else {
    for (std::size_t lane = 0; lane < valid; ++lane) to[lane] = from[lane];
  }
}

/// Puts a packet's part of a column into its slot, lanes past the end repeating its first. Columns of one value are set
/// once for the whole block instead.
template <class Real>
void load_packet(Real* row, std::size_t slot, const Column<Real>& column, std::size_t first, std::size_t valid) {
  if (column.values == nullptr) return;
  const Real* const from = column.values + first;
  if (valid == kPacketLanes) {
    put_packet(row, slot, from);
  } else {
    for (std::size_t lane = 0; lane < kPacketLanes; ++lane)
      row[slot * kPacketLanes + lane] = from[lane < valid ? lane : 0];
  }
}

template <class Real>
void set_block(Real* row, const Column<Real>& column) {
  for (std::size_t lane = 0; lane < kLanes; ++lane) row[lane] = column.value;
}

/// The first lane of the batches that hold a packet; where a batch is wider than a packet it holds others too.
template <class Real>
constexpr std::size_t first_batch_lane(std::size_t slot) {
  return slot * kPacketLanes / kWidth<Real> * kWidth<Real>;
}

/// The lanes of a batch that belong to a slot's packet.
template <class Real>
Mask<Real> packet_mask(std::size_t lane, std::size_t slot) {
  alignas(kAlignment) static constexpr auto kLaneNumbers = [] {
    struct {
      Real value[kLanes];
    } numbers{};
    for (std::size_t i = 0; i < kLanes; ++i) numbers.value[i] = static_cast<Real>(i);
    return numbers;
  }();
  const Lanes<Real> number = Lanes<Real>::load(kLaneNumbers.value + lane);
  const auto begin = static_cast<Real>(slot * kPacketLanes);
  return (number >= Lanes<Real>(begin)) & (number < Lanes<Real>(begin + Real(kPacketLanes)));
}

/// Finds hits. Carried, for the secant finish: r of the last sample that was no hit.
template <class Real, bool kSecantFinish>
struct HitTask {
  using T = Lanes<Real>;
  MarchOutput<Real> out;

  static constexpr Real kFirstCarried = 0;
  std::int32_t* steps() const { return out.steps; }

  void observe(BlockState<Real>& state, std::size_t lane, const T& /*t*/, const T& r, const Mask<Real>& goes_on) const {
    if constexpr (kSecantFinish) {
      select(goes_on, r, T::load(state.carried + lane)).store(state.carried + lane);
    }
  }

  /// Writes what became of the rays of one slot, of which those that are still live have spent their steps. `field`:
  /// values of the block's last step.
  void retire(const Block<Real>& block, const Real* field, const T& step_scale, std::size_t slot,
              std::size_t valid) const {
    alignas(kAlignment) Real results[kLanes];
    alignas(kAlignment) Real unfinished[kLanes];
    alignas(kAlignment) Real statuses[kLanes];
    const BlockState<Real>& state = block.state;
    for (std::size_t lane = first_batch_lane<Real>(slot); lane < (slot + 1) * kPacketLanes; lane += kWidth<Real>) {
      const T t = T::load(state.t + lane);
      const T t_max = T::load(state.t_max + lane);
      const Mask<Real> hit = t <= t_max;  // what ended otherwise is beyond t_max, or NaN
      const Mask<Real> inside = t == T(Real(0));
      const T end =
          kSecantFinish ? finished(t, T::load(field + lane) * step_scale, T::load(state.carried + lane), t_max) : t;
      const T nowhere = std::numeric_limits<Real>::infinity();
      select(hit, select(inside, t, end), nowhere).store(results + lane);
      if constexpr (kSecantFinish) select(hit, t, nowhere).store(unfinished + lane);
      T status = select(t > t_max, T(kMiss), T(kInvalid));
      status = select(hit, T(kHit), status);
      select(inside, T(kInside), status).store(statuses + lane);
    }
    const std::size_t lane = slot * kPacketLanes;
    const std::uint64_t spent = block.live >> lane & 0xFFU;
    for (std::size_t i = 0; spent != 0 && i < kPacketLanes; ++i) {
      if ((spent >> i & 1U) == 0) continue;
      results[lane + i] = unfinished[lane + i] = state.t[lane + i];
      statuses[lane + i] = kStepLimit;
    }
    copy_packet(out.t + block.first_ray[slot], results + lane, valid);
    if constexpr (kSecantFinish) copy_packet(out.unfinished + block.first_ray[slot], unfinished + lane, valid);
    if (out.status == nullptr) return;
    std::uint8_t codes[kPacketLanes];
    for (std::size_t i = 0; i < kPacketLanes; ++i) codes[i] = static_cast<std::uint8_t>(statuses[lane + i]);
    copy_packet(out.status + block.first_ray[slot], codes, valid);
  }

 private:
  // values of octomarch::Status, which kernels do not include
  static constexpr Real kHit = 0, kMiss = 1, kStepLimit = 2, kInside = 3, kInvalid = 4;

  /// The root of the secant through the last two samples, trusted for 32 times the last distance at the most, and not
  /// at all where the field did not fall between them.
  static T finished(const T& t, const T& r, const T& previous, const T& t_max) {
    const T root = select(r < previous, r * previous / (previous - r), T(Real(0)));
    const T farthest = T(Real(32)) * max(r, T(Real(0)));
    return min(t + min(root, farthest), t_max);
  }
};

/// Finds how much of a light passes. Carried: the visibility so far.
template <class Real>
struct ShadowTask {
  using T = Lanes<Real>;
  Real* visibility;
  T k;

  static constexpr Real kFirstCarried = 1;
  std::int32_t* steps() const { return nullptr; }

  void observe(BlockState<Real>& state, std::size_t lane, const T& t, const T& r, const Mask<Real>& /*goes_on*/) const {
    const T so_far = T::load(state.carried + lane);
    const T penumbra = min(k * r / t, so_far);
    select(t <= T::load(state.t_max + lane), penumbra, so_far).store(state.carried + lane);
  }

  /// A ray that ended within t_max has hit something.
  void retire(const Block<Real>& block, const Real* /*field*/, const T& /*step_scale*/, std::size_t slot,
              std::size_t valid) const {
    Real* const out = visibility + block.first_ray[slot];
    const std::size_t lane = slot * kPacketLanes;
    for (std::size_t i = 0; i < valid; ++i) {
      const bool blocked =
          block.state.t[lane + i] <= block.state.t_max[lane + i] && (block.live >> (lane + i) & 1U) == 0;
      const Real passed = block.state.carried[lane + i];
      out[i] = blocked || passed < Real(0) ? Real(0) : passed;
    }
  }
};

template <class Real, class Task>
class Marcher {
  using T = Lanes<Real>;

 public:
  Marcher(const TapeView<Real>& tape, Real* registers, const RayView<Real>& rays,
          const MarchParameters<Real>& parameters, const Task& task, Counters& counters)
      : tape_(tape), registers_(registers), rays_(rays), parameters_(parameters), task_(task), counters_(counters) {}

  void run() {
    Block<Real> blocks[2];
    open(blocks[0], registers_);
    open(blocks[1], registers_ + (tape_.registers + kFileGap) * kLanes);
    for (unsigned turn = 0; blocks[0].slots + blocks[1].slots > 0; turn ^= 1U) {
      if (__atomic_load_n(parameters_.cancelled, __ATOMIC_RELAXED)) return;
      if (blocks[turn].slots > 0) advance(blocks[turn]);
      Block<Real>& other = blocks[turn ^ 1U];
      if (other.step >= other.deadline || other.any_ended()) retire_ended(other);
    }
  }

 private:
  void open(Block<Real>& block, Real* registers) {
    block.registers = registers;
    BlockState<Real>& state = block.state;
    set_block(state.ox, rays_.ox);
    set_block(state.oy, rays_.oy);
    set_block(state.oz, rays_.oz);
    set_block(state.dx, rays_.dx);
    set_block(state.dy, rays_.dy);
    set_block(state.dz, rays_.dz);
    set_block(state.t_max, rays_.t_max);
    set_block(state.epsilon, rays_.epsilon);
    while (block.slots < kPackets && load(block, block.slots)) ++block.slots;
  }

  /// One step of every ray of a block.
  void advance(Block<Real>& block) {
    const std::size_t count = batches<Real>(block.slots * kPacketLanes);
    counters_.evaluations += static_cast<std::uint64_t>(__builtin_popcountll(block.live));
    counters_.lane_slots += count * kWidth<Real>;
    place_points(block, count);
    const Real* const field = evaluate(tape_, block.registers, count);
    const std::uint64_t live = step_rays(block.state, field, count) & block.used_lanes();
    ++block.step;
    if (task_.steps() != nullptr) record_steps(block, block.live & ~live);
    block.live = live;
  }

  /// Coordinates of every lane's sample point into registers 0, 1, 2. Where all rays start at one point, as a camera's
  /// do, that is no row to read.
  [[gnu::flatten]] void place_points(const Block<Real>& block, std::size_t count) {
    const BlockState<Real>& state = block.state;
    Real* const registers = block.registers;
    const auto place = [&](const auto& ox, const auto& oy, const auto& oz) {
      for_each_batch<Real>(count, [&](std::size_t lane) {
        const T t = T::load(state.t + lane);
        (ox(lane) + t * T::load(state.dx + lane)).store(registers + lane);
        (oy(lane) + t * T::load(state.dy + lane)).store(registers + kLanes + lane);
        (oz(lane) + t * T::load(state.dz + lane)).store(registers + 2 * kLanes + lane);
      });
    };
    if (one_origin_) {
      place(Same(rays_.ox.value), Same(rays_.oy.value), Same(rays_.oz.value));
    } else {
      place(Row(state.ox), Row(state.oy), Row(state.oz));
    }
  }

  /// Moves t along by the field; returns which rays go on.
  std::uint64_t step_rays(BlockState<Real>& state, const Real* field, std::size_t count) {
    if (one_limit_) return step_rays(state, field, count, Same(rays_.t_max.value), Same(rays_.epsilon.value));
    return step_rays(state, field, count, Row(state.t_max), Row(state.epsilon));
  }

  template <class Column>
  [[gnu::flatten]] std::uint64_t step_rays(BlockState<Real>& state, const Real* field, std::size_t count,
                                           const Column& t_max, const Column& epsilon) {
    const T step_scale = parameters_.step_scale;
    const T slope = parameters_.epsilon_slope;
    const Task task = task_;
    std::uint64_t live = 0;
    for_each_batch<Real>(count, [&](std::size_t lane) {
      const T t = T::load(state.t + lane);
      const T r = T::load(field + lane) * step_scale;
      // not "r > epsilon": a NaN field has to move t, and make it NaN
      const Mask<Real> goes_on = (t <= t_max(lane)) & !(r <= max(epsilon(lane), slope * t));
      const T next = select(goes_on, t + r, t);
      task.observe(state, lane, t, r, goes_on);
      next.store(state.t + lane);
      live |= (goes_on & (next <= t_max(lane))).bits() << lane;
    });
    return live;
  }

  void record_steps(const Block<Real>& block, std::uint64_t ended) {
    for (; ended != 0; ended &= ended - 1) {
      const auto lane = static_cast<std::size_t>(__builtin_ctzll(ended));
      const std::size_t slot = lane / kPacketLanes;
      task_.steps()[block.first_ray[slot] + lane % kPacketLanes] =
          static_cast<std::int32_t>(block.step - block.start[slot]);
    }
  }

  /// Packets without a live ray, and those whose steps are spent, leave; others take their slots.
  void retire_ended(Block<Real>& block) {
    for (std::size_t slot = block.slots; slot-- > 0;) {
      const std::uint64_t live = block.live & std::uint64_t{0xFF} << (slot * kPacketLanes);
      if (live != 0 && block.step - block.start[slot] < parameters_.max_steps) continue;
      if (task_.steps() != nullptr) record_steps(block, live);
      task_.retire(block, block.registers + tape_.result * kLanes, T(parameters_.step_scale), slot,
                   valid_rays(block.first_ray[slot]));
      if (!load(block, slot)) block.close(slot);
    }
    block.deadline = std::numeric_limits<std::int64_t>::max();
    for (std::size_t slot = 0; slot < block.slots; ++slot) note_deadline(block, slot);
  }

  void note_deadline(Block<Real>& block, std::size_t slot) const {
    const std::int64_t spent = block.start[slot] + parameters_.max_steps;
    if (spent < block.deadline) block.deadline = spent;
  }

  std::size_t valid_rays(std::size_t first) const {
    const std::size_t left = rays_.count - first;
    return left < kPacketLanes ? left : kPacketLanes;
  }

  /// Puts the next packet of the stream into a slot; false when there is none. Lanes past the end, and rays with a NaN,
  /// get t = NaN: they never live, and touch no other lane.
  bool load(Block<Real>& block, std::size_t slot) {
    if (next_ray_ >= rays_.count) return false;
    const std::size_t first = next_ray_;
    const std::size_t valid = valid_rays(first);
    BlockState<Real>& state = block.state;
    next_ray_ += kPacketLanes;
    ++counters_.packets;
    block.first_ray[slot] = first;
    block.start[slot] = block.step;
    load_packet(state.ox, slot, rays_.ox, first, valid);
    load_packet(state.oy, slot, rays_.oy, first, valid);
    load_packet(state.oz, slot, rays_.oz, first, valid);
    load_packet(state.dx, slot, rays_.dx, first, valid);
    load_packet(state.dy, slot, rays_.dy, first, valid);
    load_packet(state.dz, slot, rays_.dz, first, valid);
    load_packet(state.t_max, slot, rays_.t_max, first, valid);
    load_packet(state.epsilon, slot, rays_.epsilon, first, valid);
    block.set_live(slot, start_packet(state, slot) & 0xFFU >> (kPacketLanes - valid));
    for (std::size_t i = valid; i < kPacketLanes; ++i)
      state.t[slot * kPacketLanes + i] = std::numeric_limits<Real>::quiet_NaN();
    if (task_.steps() != nullptr) {
      for (std::size_t i = 0; i < valid; ++i) task_.steps()[first + i] = 0;
    }
    note_deadline(block, slot);
    return true;
  }

  /// Sets t of a packet's rays to 0, or to NaN where anything of the ray is not finite; returns a bit for each number.
  static std::uint64_t start_packet(BlockState<Real>& state, std::size_t slot) {
    const std::size_t begin = first_batch_lane<Real>(slot);
    std::uint64_t bits = 0;
    for (std::size_t lane = begin; lane < (slot + 1) * kPacketLanes; lane += kWidth<Real>) {
      const T sum = T::load(state.ox + lane) + T::load(state.oy + lane) + T::load(state.oz + lane) +
                    T::load(state.dx + lane) + T::load(state.dy + lane) + T::load(state.dz + lane);
      const T start = sum * T(Real(0)) + T(Real(0));
      const Mask<Real> ours = packet_mask<Real>(lane, slot);
      select(ours, start, T::load(state.t + lane)).store(state.t + lane);
      select(ours, T(Task::kFirstCarried), T::load(state.carried + lane)).store(state.carried + lane);
      bits |= (start == start).bits() << (lane - begin);
    }
    return bits >> (slot * kPacketLanes - begin) & 0xFFU;
  }

  /// One value for all lanes, or a row of the block's state, read alike.
  struct Same {
    T value;
    explicit Same(Real v) : value(v) {}
    T operator()(std::size_t /*lane*/) const { return value; }
  };
  struct Row {
    const Real* row;
    explicit Row(const Real* r) : row(r) {}
    T operator()(std::size_t lane) const { return T::load(row + lane); }
  };

  const TapeView<Real> tape_;
  Real* const registers_;
  const RayView<Real> rays_;
  const MarchParameters<Real> parameters_;
  const Task task_;
  Counters& counters_;
  const bool one_origin_ = rays_.ox.values == nullptr && rays_.oy.values == nullptr && rays_.oz.values == nullptr;
  const bool one_limit_ = rays_.t_max.values == nullptr && rays_.epsilon.values == nullptr;
  std::size_t next_ray_ = 0;
};

/// Takes back what the secant finish got wrong. On a surface it all but closes the gap; where a sixteenth of the hit
/// epsilon is left, a ray that only grazes an edge was sent past it, and the sample before stands. One evaluation for
/// each finished ray.
template <class Real>
void check_finish(const TapeView<Real>& tape, Real* registers, const RayView<Real>& rays,
                  const MarchParameters<Real>& parameters, const MarchOutput<Real>& out, Counters& counters) {
  using T = Lanes<Real>;
  alignas(kAlignment) Real t[kLanes];
  alignas(kAlignment) Real unfinished[kLanes];
  alignas(kAlignment) Real epsilon[kLanes];
  alignas(kAlignment) Real origin[kLanes];
  alignas(kAlignment) Real direction[kLanes];
  const Column<Real>* const origins[] = {&rays.ox, &rays.oy, &rays.oz};
  const Column<Real>* const directions[] = {&rays.dx, &rays.dy, &rays.dz};
  for (std::size_t first = 0; first < rays.count; first += kLanes) {
    if (__atomic_load_n(parameters.cancelled, __ATOMIC_RELAXED)) return;
    const std::size_t left = rays.count - first;
    const std::size_t lanes = left < kLanes ? left : kLanes;
    const std::size_t count = batches<Real>(lanes);
    const auto copy = [&](Real* row, const Column<Real>& column) {
      if (column.values == nullptr) {
        for (std::size_t i = 0; i < kLanes; ++i) row[i] = column.value;
      } else if (lanes == kLanes) {
        __builtin_memcpy(row, column.values + first, kLanes * sizeof(Real));
      } else {
        for (std::size_t i = 0; i < kLanes; ++i) row[i] = i < lanes ? column.values[first + i] : Real(0);
      }
    };
    copy(t, {out.t, 0});
    copy(unfinished, {out.unfinished, 0});
    std::uint64_t changed = 0;
    for_each_batch<Real>(count, [&](std::size_t lane) {
      changed |= (!(T::load(t + lane) == T::load(unfinished + lane))).bits() << lane;
    });
    if (changed == 0) continue;
    copy(epsilon, rays.epsilon);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      copy(origin, *origins[axis]);
      copy(direction, *directions[axis]);
      for_each_batch<Real>(count, [&](std::size_t lane) {
        (T::load(origin + lane) + T::load(t + lane) * T::load(direction + lane))
            .store(registers + axis * kLanes + lane);
      });
    }
    const Real* const field = evaluate(tape, registers, count);
    counters.evaluations += static_cast<std::uint64_t>(__builtin_popcountll(changed));
    counters.lane_slots += count * kWidth<Real>;
    for_each_batch<Real>(count, [&](std::size_t lane) {
      const T end = T::load(t + lane);
      const T r = T::load(field + lane) * T(parameters.step_scale);
      const T hit_epsilon = max(T::load(epsilon + lane), T(parameters.epsilon_slope) * end);
      const Mask<Real> kept = abs(r) <= hit_epsilon * T(Real(0.0625));
      select(kept, end, T::load(unfinished + lane)).store(t + lane);
    });
    for (std::size_t i = 0; i < lanes; ++i) out.t[first + i] = t[i];
  }
}

template <class Real>
void march(const TapeView<Real>& tape, Real* registers, const RayView<Real>& rays,
           const MarchParameters<Real>& parameters, const MarchOutput<Real>& out, Counters& counters) {
  if (parameters.secant_finish) {
    using Task = HitTask<Real, true>;
    Marcher<Real, Task>(tape, registers, rays, parameters, Task{out}, counters).run();
    check_finish(tape, registers, rays, parameters, out, counters);
  } else {
    using Task = HitTask<Real, false>;
    Marcher<Real, Task>(tape, registers, rays, parameters, Task{out}, counters).run();
  }
}

template <class Real>
void shadow(const TapeView<Real>& tape, Real* registers, const RayView<Real>& rays,
            const MarchParameters<Real>& parameters, Real k, Real* visibility, Counters& counters) {
  const ShadowTask<Real> task{visibility, Lanes<Real>(k)};
  Marcher<Real, ShadowTask<Real>>(tape, registers, rays, parameters, task, counters).run();
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
