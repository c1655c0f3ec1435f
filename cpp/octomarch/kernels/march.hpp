// Marching in blocks: 8 packets of 8 rays stepped together by the tape interpreter, a packet's slot refilled with the next
// packet of the stream as soon as all its rays have ended. steps.hpp says how long a step is: sphere tracing by default,
// J. C. Hart, "Sphere tracing", The Visual Computer 12(10), 1996.
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
#include "octomarch/kernels/finish.hpp"
#include "octomarch/kernels/tasks.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

template <class Real, class Steps, class Task>
class Marcher {
  using T = Lanes<Real>;

 public:
  Marcher(const TapeView<Real>& tape, Real* memory, const RayView<Real>& rays, const MarchParameters<Real>& parameters,
          const Task& task, Counters& counters)
      : tape_(tape),
        memory_(memory),
        rays_(rays),
        parameters_(parameters),
        steps_(parameters),
        task_(task),
        counters_(counters) {}

  void run() {
    Block<Real> blocks[2];
    const std::size_t files = 2 * kBusyRows;
    const std::size_t quiet = files + 2 * std::size_t{tape_.registers};
    for (std::size_t i = 0; i < 2; ++i) {
      open(blocks[i], row(i * kBusyRows), row(files + i * tape_.registers), row(quiet + i * kBusyRows));
    }
    for (unsigned turn = 0; blocks[0].slots + blocks[1].slots > 0; turn ^= 1U) {
      if (is_set(parameters_.cancelled)) return;
      if (blocks[turn].slots > 0) advance(blocks[turn]);
      Block<Real>& other = blocks[turn ^ 1U];
      if (other.step >= other.deadline || other.any_ended()) retire_ended(other);
    }
  }

 private:
  /// A row of the march's memory.
  Real* row(std::size_t index) const { return memory_ + index * kLanes; }

  void open(Block<Real>& block, Real* busy, Real* registers, Real* quiet) {
    block.registers = registers;
    block.state = {busy,  busy + kLanes,  busy + 2 * kLanes,  busy + 3 * kLanes,  busy + 4 * kLanes,
                   quiet, quiet + kLanes, quiet + 2 * kLanes, quiet + 3 * kLanes, quiet + 4 * kLanes};
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
    const Steps steps = steps_;
    const Task task = task_;
    std::uint64_t live = 0;
    for_each_batch<Real>(count, [&](std::size_t lane) {
      const T t = T::load(state.t + lane);
      const T r = T::load(field + lane) * step_scale;
      const T tolerance = max(epsilon(lane), slope * t);
      // not "has not arrived": a NaN field has to move t, and make it NaN
      const Mask<Real> goes_on = (t <= t_max(lane)) & !steps.arrives(r, tolerance);
      const T next = select(goes_on, t + steps.length(r, tolerance), t);
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

  /// Sets t of a packet's rays to their start, or to NaN where anything of the ray is not finite; returns a bit for each
  /// that begins.
  std::uint64_t start_packet(BlockState<Real>& state, std::size_t slot) const {
    const std::size_t begin = first_batch_lane<Real>(slot);
    std::uint64_t bits = 0;
    for (std::size_t lane = begin; lane < (slot + 1) * kPacketLanes; lane += kWidth<Real>) {
      const T sum = T::load(state.ox + lane) + T::load(state.oy + lane) + T::load(state.oz + lane) +
                    T::load(state.dx + lane) + T::load(state.dy + lane) + T::load(state.dz + lane);
      const T start = sum * T(Real(0)) + steps_.start();
      const Mask<Real> ours = packet_mask<Real>(lane, slot);
      select(ours, start, T::load(state.t + lane)).store(state.t + lane);
      select(ours, T(Task::kFirstCarried), T::load(state.carried + lane)).store(state.carried + lane);
      bits |= steps_.begins(start, T::load(state.t_max + lane)).bits() << (lane - begin);
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
  Real* const memory_;
  const RayView<Real> rays_;
  const MarchParameters<Real> parameters_;
  const Steps steps_;
  const Task task_;
  Counters& counters_;
  const bool one_origin_ = rays_.ox.values == nullptr && rays_.oy.values == nullptr && rays_.oz.values == nullptr;
  const bool one_limit_ = rays_.t_max.values == nullptr && rays_.epsilon.values == nullptr;
  std::size_t next_ray_ = 0;
};

template <class Real, class Steps, Finish kFinish>
void find_hits(const TapeView<Real>& tape, Real* memory, const RayView<Real>& rays,
               const MarchParameters<Real>& parameters, const MarchOutput<Real>& out, Counters& counters) {
  using Task = HitTask<Real, Steps, kFinish>;
  Marcher<Real, Steps, Task>(tape, memory, rays, parameters, Task{out, Steps(parameters)}, counters).run();
  if constexpr (kFinish == Finish::kSecant) check_secant(tape, memory, rays, parameters, out, counters);
  if constexpr (kFinish == Finish::kBisection) bisect(tape, memory, rays, parameters, out, counters);
}

/// Calls f with the steps that the parameters ask for.
template <class Real, class Function>
void with_steps(const MarchParameters<Real>& parameters, Function&& f) {
  switch (parameters.stepping) {
    case Stepping::kPlain: return f(PlainSteps<Real>(parameters));
    case Stepping::kBiased: return f(BiasedSteps<Real>(parameters));
    case Stepping::kFixed: return f(FixedSteps<Real>(parameters));
  }
}

template <class Real>
void march(const TapeView<Real>& tape, Real* memory, const RayView<Real>& rays, const MarchParameters<Real>& parameters,
           const MarchOutput<Real>& out, Counters& counters) {
  with_steps(parameters, [&]<class Steps>(const Steps&) {
    if (parameters.finish) {
      find_hits<Real, Steps, Steps::kFinish>(tape, memory, rays, parameters, out, counters);
    } else {
      find_hits<Real, Steps, Finish::kNone>(tape, memory, rays, parameters, out, counters);
    }
  });
}

template <class Real>
void shadow(const TapeView<Real>& tape, Real* memory, const RayView<Real>& rays,
            const MarchParameters<Real>& parameters, Real k, Real* visibility, Counters& counters) {
  const ShadowTask<Real> task{visibility, Lanes<Real>(k)};
  with_steps(parameters, [&]<class Steps>(const Steps&) {
    Marcher<Real, Steps, ShadowTask<Real>>(tape, memory, rays, parameters, task, counters).run();
  });
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
