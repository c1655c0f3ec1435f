// Marching in blocks: 8 packets of 8 rays stepped together by the tape interpreter, a packet's slot refilled with the next
// packet of the stream as soon as all its rays have ended. steps.hpp says how long a step is, finish.hpp how rays begin and
// what became of them. J. C. Hart, "Sphere tracing", The Visual Computer 12(10), 1996.
//
// A step leaves a ray that has ended as it is: at a hit t stays and hits again, past t_max it stays there, a NaN stays
// NaN. So no mask is kept with the state; which rays live is read off each step as one 64-bit word, and what became of
// a ray is read off t when all have ended.
//
// Two blocks take turns. Whether packets of one have ended is looked at only after the other's step has been issued:
// the mispredicted branch of a retirement then finds the processor busy instead of drained.
#pragma once

#include <limits>

#include "octomarch/kernels/evaluate.hpp"
#include "octomarch/kernels/tasks.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

/// What is the same at all steps of a march.
template <class Real, class Steps, class Task>
class Stepper {
  using T = Lanes<Real>;

 public:
  Stepper(const MarchParameters<Real>& parameters, const Task& task)
      : step_scale_(parameters.step_scale), slope_(parameters.epsilon_slope), steps_(parameters), task_(task) {}

  /// Moves the rays of a batch on by the field at their samples.
  Step<Real> take_step(BlockState<Real>& state, const Real* field, std::size_t lane, const T& t_max,
                       const T& epsilon) const {
    const T t = T::load(state.t + lane);
    const T r = T::load(field + lane) * step_scale_;
    const Step<Real> step = steps_.advance(state, lane, t, r, max(epsilon, slope_ * t), t_max);
    task_.observe(state, lane, t, r, t_max, step.goes_on);
    step.next.store(state.t + lane);
    return step;
  }

 private:
  T step_scale_;
  T slope_;
  Steps steps_;
  Task task_;
};

template <class Real, class Steps, class Task>
class Marcher {
  using T = Lanes<Real>;
  /// So many rays of a cell at the most are marched where they lie.
  static constexpr std::size_t kInPlace = kWidestBatch;

 public:
  Marcher(const TapeView<Real>& tape, Real* memory, const RayView<Real>& rays, const MarchParameters<Real>& parameters,
          const Region<Real>* region, const MarchState<Real>& march, const Task& task, Counters& counters)
      : tape_(tape),
        memory_(memory),
        rays_(rays),
        parameters_(parameters),
        region_(region),
        march_(march),
        stepper_(parameters, task),
        counters_(counters) {}

  void run() {
    if (region_ != nullptr && rays_.count <= kInPlace) return run_in_place();
    Block<Real> blocks[2];
    const std::size_t files = 2 * kBusyRows;
    const std::size_t relaxation = files + 2 * std::size_t{tape_.registers};
    const std::size_t quiet = relaxation + 2 * kRelaxationRows;
    for (std::size_t i = 0; i < 2; ++i) {
      open(blocks[i], row(i * kBusyRows), row(files + i * tape_.registers), row(relaxation + i * kRelaxationRows),
           row(quiet + i * kQuietRows));
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

  /// A few rays, which share a block as they lie: nothing is copied into slots, and none is refilled.
  [[gnu::noinline]] void run_in_place() {
    Block<Real> block;
    block.slots = (rays_.count + kPacketLanes - 1) / kPacketLanes;
    const std::size_t count = batches<Real>(block.slots * kPacketLanes);
    std::size_t filled = 0;
    const auto row_of = [&](const Column<Real>& column) {
      if (column.values != nullptr) return const_cast<Real*>(column.values);  // which is read only
      Real* const constant = row(filled++);
      for_each_batch<Real>(count, [&](std::size_t lane) { T(column.value).store(constant + lane); });
      return constant;
    };
    block.state = {row_of(rays_.dx),    row_of(rays_.dy),      row_of(rays_.dz), march_.t,
                   march_.before,       row_of(rays_.ox),      row_of(rays_.oy), row_of(rays_.oz),
                   row_of(rays_.t_max), row_of(rays_.epsilon), march_.stride,    march_.boldness};
    block.registers = row(filled);
    for (std::size_t slot = 0; slot < block.slots; ++slot) block.first_ray[slot] = slot * kPacketLanes;
    counters_.packets += block.slots;
    for_each_batch<Real>(count, [&](std::size_t lane) {
      block.live |= (T::load(march_.t + lane) <= T::load(block.state.t_max + lane)).bits() << lane;
    });
    block.live &= ~std::uint64_t{0} >> (kLanes - rays_.count);
    while (block.live != 0 && block.step < parameters_.max_steps) {
      if (is_set(parameters_.cancelled)) return;
      advance(block);
    }
    if (march_.steps != nullptr) record_steps(block, block.live);
    __builtin_memcpy(march_.radius, block.registers + tape_.result * kLanes, rays_.count * sizeof(Real));
    for (std::size_t ray = 0; ray < rays_.count; ++ray) march_.pause[ray] = pause_of(block, ray);
  }

  static std::uint8_t pause_of(const Block<Real>& block, std::size_t lane) {
    if ((block.left >> lane & 1U) != 0) return static_cast<std::uint8_t>(Pause::kLeft);
    return static_cast<std::uint8_t>((block.live >> lane & 1U) != 0 ? Pause::kSpent : Pause::kEnded);
  }

  void open(Block<Real>& block, Real* busy, Real* registers, Real* relaxation, Real* quiet) {
    block.registers = registers;
    block.state = {busy,       busy + kLanes,      busy + 2 * kLanes,  busy + 3 * kLanes,  busy + 4 * kLanes,
                   quiet,      quiet + kLanes,     quiet + 2 * kLanes, quiet + 3 * kLanes, quiet + 4 * kLanes,
                   relaxation, relaxation + kLanes};
    BlockState<Real>& state = block.state;
    if (next_ray_ >= rays_.count) return;
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

  /// One step of every ray of a block. Inlined where it is called: a call cost 3 % of a small program's picture.
  [[gnu::always_inline]] void advance(Block<Real>& block) {
    const std::size_t count = batches<Real>(block.slots * kPacketLanes);
    counters_.evaluations += static_cast<std::uint64_t>(__builtin_popcountll(block.live));
    counters_.lane_slots += count * kWidth<Real>;
    place_points(block, count);
    const Real* const field = evaluate(tape_, block.registers, count);
    const std::uint64_t live = step_rays(block, field, count) & block.used_lanes();
    ++block.step;
    if (march_.steps != nullptr) record_steps(block, block.live & ~live);
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
  std::uint64_t step_rays(Block<Real>& block, const Real* field, std::size_t count) {
    if (region_ != nullptr) return step_rays_in_region(block, field, count);
    if (one_limit_) return step_rays(block, field, count, Same(rays_.t_max.value), Same(rays_.epsilon.value));
    return step_rays(block, field, count, Row(block.state.t_max), Row(block.state.epsilon));
  }

  template <class Column>
  [[gnu::flatten]] std::uint64_t step_rays(Block<Real>& block, const Real* field, std::size_t count,
                                           const Column& t_max, const Column& epsilon) {
    const Stepper<Real, Steps, Task> stepper = stepper_;
    std::uint64_t live = 0;
    for_each_batch<Real>(count, [&](std::size_t lane) {
      const T limit = t_max(lane);
      const Step<Real> step = stepper.take_step(block.state, field, lane, limit, epsilon(lane));
      live |= (step.goes_on & (step.next <= limit)).bits() << lane;
    });
    return live;
  }

  /// The same for a tape that may not be run everywhere: a ray whose next sample lies outside of the region is left as it
  /// is from then on.
  [[gnu::flatten]] std::uint64_t step_rays_in_region(Block<Real>& block, const Real* field, std::size_t count) {
    const Stepper<Real, Steps, Task> stepper = stepper_;
    const BlockState<Real>& state = block.state;
    const Region<Real> region = *region_;
    const T nowhere = -std::numeric_limits<Real>::infinity();
    std::uint64_t live = 0;
    std::uint64_t left = 0;
    for_each_batch<Real>(count, [&](std::size_t lane) {
      const T t_max = T::load(state.t_max + lane);
      const T limit = select(Mask<Real>::from_bits(block.left >> lane), nowhere, t_max);
      const Step<Real> step = stepper.take_step(block.state, field, lane, limit, T::load(state.epsilon + lane));
      const T x = T::load(state.ox + lane) + step.next * T::load(state.dx + lane);
      const T y = T::load(state.oy + lane) + step.next * T::load(state.dy + lane);
      const T z = T::load(state.oz + lane) + step.next * T::load(state.dz + lane);
      const Mask<Real> within = (x >= T(region.lo[0])) & (x <= T(region.hi[0])) & (y >= T(region.lo[1])) &
                                (y <= T(region.hi[1])) & (z >= T(region.lo[2])) & (z <= T(region.hi[2]));
      const Mask<Real> goes_on = step.goes_on & (step.next <= limit);
      live |= (goes_on & within).bits() << lane;
      left |= (goes_on & !within).bits() << lane;
    });
    block.left |= left & block.live;
    return live;
  }

  void record_steps(const Block<Real>& block, std::uint64_t ended) {
    for (; ended != 0; ended &= ended - 1) {
      const auto lane = static_cast<std::size_t>(__builtin_ctzll(ended));
      const std::size_t slot = lane / kPacketLanes;
      march_.steps[block.first_ray[slot] + lane % kPacketLanes] =
          static_cast<std::int32_t>(block.step - block.start[slot]);
    }
  }

  /// Packets without a live ray, and those whose steps are spent, leave; others take their slots.
  void retire_ended(Block<Real>& block) {
    for (std::size_t slot = block.slots; slot-- > 0;) {
      const std::uint64_t live = block.live & std::uint64_t{0xFF} << (slot * kPacketLanes);
      if (live != 0 && block.step - block.start[slot] < parameters_.max_steps) continue;
      if (march_.steps != nullptr) record_steps(block, live);
      retire(block, slot);
      if (load(block, slot)) {
        ++counters_.refills;
      } else {
        block.close(slot);
      }
    }
    block.deadline = std::numeric_limits<std::int64_t>::max();
    for (std::size_t slot = 0; slot < block.slots; ++slot) note_deadline(block, slot);
  }

  /// Writes the state of a slot's rays back. Those that are still live have spent their steps.
  void retire(const Block<Real>& block, std::size_t slot) {
    const BlockState<Real>& state = block.state;
    const std::size_t ray = block.first_ray[slot];
    take_packet(state.t, slot, march_.t + ray);
    take_packet(block.registers + tape_.result * kLanes, slot, march_.radius + ray);
    if constexpr (Task::kCarries) take_packet(state.carried, slot, march_.before + ray);
    if constexpr (Task::kIsRelaxed) {
      take_packet(state.stride, slot, march_.stride + ray);
      take_packet(state.boldness, slot, march_.boldness + ray);
    }
    const std::uint64_t spent = Block<Real>::packet_of(block.live, slot);
    const std::uint64_t left = Block<Real>::packet_of(block.left, slot);
    __builtin_memset(march_.pause + ray, static_cast<int>(Pause::kEnded), kPacketLanes);
    if ((spent | left) == 0) return;
    for (std::size_t i = 0; i < kPacketLanes; ++i) {
      if ((left >> i & 1U) != 0) march_.pause[ray + i] = static_cast<std::uint8_t>(Pause::kLeft);
      if ((spent >> i & 1U) != 0) march_.pause[ray + i] = static_cast<std::uint8_t>(Pause::kSpent);
    }
  }

  void note_deadline(Block<Real>& block, std::size_t slot) const {
    const std::int64_t spent = block.start[slot] + parameters_.max_steps;
    if (spent < block.deadline) block.deadline = spent;
  }

  /// Puts the next packet of the stream into a slot; false when there is none.
  bool load(Block<Real>& block, std::size_t slot) {
    if (next_ray_ >= rays_.count) return false;
    const std::size_t first = next_ray_;
    BlockState<Real>& state = block.state;
    next_ray_ += kPacketLanes;
    ++counters_.packets;
    block.first_ray[slot] = first;
    block.start[slot] = block.step;
    load_packet(state.ox, slot, rays_.ox, first);
    load_packet(state.oy, slot, rays_.oy, first);
    load_packet(state.oz, slot, rays_.oz, first);
    load_packet(state.dx, slot, rays_.dx, first);
    load_packet(state.dy, slot, rays_.dy, first);
    load_packet(state.dz, slot, rays_.dz, first);
    load_packet(state.t_max, slot, rays_.t_max, first);
    load_packet(state.epsilon, slot, rays_.epsilon, first);
    put_packet(state.t, slot, march_.t + first);
    if constexpr (Task::kCarries) put_packet(state.carried, slot, march_.before + first);
    if constexpr (Task::kIsRelaxed) {
      put_packet(state.stride, slot, march_.stride + first);
      put_packet(state.boldness, slot, march_.boldness + first);
    }
    Block<Real>::set_packet_of(block.left, slot, 0);
    Block<Real>::set_packet_of(block.live, slot, packet_bits<Real>(first, [&](std::size_t i) {
                                 return T::load(march_.t + i) <= at(rays_.t_max, i);
                               }));
    note_deadline(block, slot);
    return true;
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
  const Region<Real>* const region_;
  const MarchState<Real> march_;
  const Stepper<Real, Steps, Task> stepper_;
  Counters& counters_;
  const bool one_origin_ = rays_.ox.values == nullptr && rays_.oy.values == nullptr && rays_.oz.values == nullptr;
  const bool one_limit_ = rays_.t_max.values == nullptr && rays_.epsilon.values == nullptr;
  std::size_t next_ray_ = 0;
};

/// Calls run(steps, task) for how rays are to be marched.
template <class Real, class Run>
void with_task(const MarchParameters<Real>& parameters, Run&& run) {
  const auto run_steps = [&]<class Steps>(const Steps& /*which*/) {
    if (parameters.finish) {
      run.template operator()<Steps>(HitTask<Real, Steps, Steps::kFinish>{});
    } else {
      run.template operator()<Steps>(HitTask<Real, Steps, Finish::kNone>{});
    }
  };
  switch (parameters.stepping) {
    case Stepping::kPlain: return run_steps(PlainSteps<Real>(parameters));
    case Stepping::kBiased: return run_steps(BiasedSteps<Real>(parameters));
    case Stepping::kRelaxed: return run_steps(LongSteps<Real, Stepping::kRelaxed>(parameters));
    case Stepping::kEnhanced: return run_steps(LongSteps<Real, Stepping::kEnhanced>(parameters));
    case Stepping::kFixed: return run_steps(FixedSteps<Real>(parameters));
    case Stepping::kCertified: return run_steps(CertifiedSteps<Real>(parameters));
    case Stepping::kCone: return run_steps(ConeSteps<Real>(parameters));
    case Stepping::kShadow: return;  // of shadow rays alone
  }
}

/// The same for shadow rays.
template <class Real, class Run>
void with_shadow_task(const MarchParameters<Real>& parameters, Run&& run) {
  const auto run_steps = [&]<class Steps>(const Steps& /*which*/) {
    run.template operator()<Steps>(ShadowTask<Real, Steps>{Lanes<Real>(parameters.k)});
  };
  switch (parameters.stepping) {
    case Stepping::kPlain: return run_steps(PlainSteps<Real>(parameters));
    case Stepping::kBiased: return run_steps(BiasedSteps<Real>(parameters));
    case Stepping::kShadow: return run_steps(LongSteps<Real, Stepping::kShadow>(parameters));
    case Stepping::kFixed: return run_steps(FixedSteps<Real>(parameters));
    case Stepping::kRelaxed:
    case Stepping::kEnhanced:
    case Stepping::kCertified:
    case Stepping::kCone: return;  // of other rays
  }
}

template <class Real>
void march(const TapeView<Real>& tape, Real* memory, const RayView<Real>& rays, const MarchParameters<Real>& parameters,
           const Region<Real>* region, const MarchState<Real>& state, Counters& counters) {
  with_task<Real>(parameters, [&]<class Steps, class Task>(const Task& task) {
    Marcher<Real, Steps, Task>(tape, memory, rays, parameters, region, state, task, counters).run();
  });
}

template <class Real>
void march_shadow(const TapeView<Real>& tape, Real* memory, const RayView<Real>& rays,
                  const MarchParameters<Real>& parameters, const Region<Real>* region, const MarchState<Real>& state,
                  Counters& counters) {
  with_shadow_task<Real>(parameters, [&]<class Steps, class Task>(const Task& task) {
    Marcher<Real, Steps, Task>(tape, memory, rays, parameters, region, state, task, counters).run();
  });
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
