// Rays that are marched side by side through regions of their own, each by those operands of a chain that decide in its region: their
// constants are rows, a column for each lane. march.hpp comes before; render/ puts rays and constants into the lanes.
#pragma once

#include "octomarch/kernels/march.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

/// Runs one instruction with constants of each lane's own: one row after the other.
template <class Real>
using LaneHandler = void (*)(const Instruction& instruction, const Real* constants, Real* registers, std::size_t count);

/// As execute(), but for the operator, which is made for each batch: one function for both took 3 % more of 2,000 balls' time.
template <template <class> class Op, class Real, std::size_t Inputs, std::size_t Outputs, std::size_t Constants>
[[gnu::flatten]] void execute_by_lanes(const Instruction& instruction, const Real* constants, Real* registers,
                                       std::size_t count) {
  using T = Lanes<Real>;
  const Real* const in0 = registers + instruction.in[0] * kLanes;
  const Real* const in1 = registers + instruction.in[1] * kLanes;
  const Real* const in2 = registers + instruction.in[2] * kLanes;
  Real* const out0 = registers + instruction.out[0] * kLanes;
  Real* const out1 = registers + instruction.out[1] * kLanes;
  Real* const out2 = registers + instruction.out[2] * kLanes;
  for_each_batch<Real>(count, [&](std::size_t lane) {
    T own[Constants > 0 ? Constants : 1] = {T()};
    for (std::size_t k = 0; k < Constants; ++k) own[k] = T::load(constants + k * kLanes + lane);
    const Op<T> op(static_cast<const T*>(own));
    const auto result = [&] {
      if constexpr (Inputs == 1) return op(T::load(in0 + lane));
      if constexpr (Inputs == 2) return op(T::load(in0 + lane), T::load(in1 + lane));
      if constexpr (Inputs == 3) return op(T::load(in0 + lane), T::load(in1 + lane), T::load(in2 + lane));
    }();
    if constexpr (Outputs == 1) {
      result.store(out0 + lane);
    } else {
      static_assert(Outputs == 3);
      result.x.store(out0 + lane);
      result.y.store(out1 + lane);
      result.z.store(out2 + lane);
    }
  });
}

template <Opcode kOp, template <class> class Op, class Real, std::size_t Inputs, std::size_t Outputs,
          std::size_t Constants>
constexpr LaneHandler<Real> lane_handler() {
  if constexpr (runs_by_lanes(kOp)) {
    return &execute_by_lanes<Op, Real, Inputs, Outputs, Constants>;
  } else {
    return nullptr;
  }
}

template <class Real>
constexpr LaneHandler<Real> kLaneHandlers[] = {
#define OCTOMARCH_OPCODE(op, mnemonic, inputs, outputs, constants) \
  lane_handler<Opcode::k##op, ops::op, Real, inputs, outputs, constants>(),
#include "octomarch/program/opcodes.def"
#undef OCTOMARCH_OPCODE
};

struct OperandCounts {
  std::size_t least;
  std::size_t most;
};
/// The least and the most that a lane has.
template <class Real>
OperandCounts count_operands(const ChainBlock<Real>& block, std::size_t count) {
  using T = Lanes<Real>;
  T least = T::load(block.operands);
  T most = least;
  for_each_batch<Real>(count, [&](std::size_t lane) {
    const T own = T::load(block.operands + lane);
    least = min(least, own);
    most = max(most, own);
  });
  alignas(kAlignment) Real numbers[2][kWidth<Real>];
  least.store(numbers[0]);
  most.store(numbers[1]);
  for (std::size_t i = 1; i < kWidth<Real>; ++i) {
    if (numbers[0][i] < numbers[0][0]) numbers[0][0] = numbers[0][i];
    if (numbers[1][i] > numbers[1][0]) numbers[1][0] = numbers[1][i];
  }
  return {static_cast<std::size_t>(numbers[0][0]), static_cast<std::size_t>(numbers[1][0])};
}

/// Runs chains at the points of a block's lanes.
template <class Real>
class ChainEvaluator {
  using T = Lanes<Real>;

 public:
  ChainEvaluator(const ChainView<Real>& chain, const ChainBlock<Real>& block)
      : chain_(chain), block_(block), count_(batches<Real>(block.lanes)), lanes_(count_ * kWidth<Real>) {}

  /// Leaves the field in the register of what has been taken up.
  void run(Counters& counters) const {
    counters.lane_slots += lanes_;
    counters.instructions += lanes_ * (chain_.kind_count == 1 ? run_like() : run_mixed());
  }

 private:
  Real* row(std::size_t index) const { return block_.registers + index * kLanes; }
  const Real* columns_of(std::size_t operand) const { return block_.columns + operand * chain_.columns * kLanes; }

  /// Where all operands are of one kind. Returns how many instructions were run.
  std::size_t run_like() const {
    const KindView<Real>& kind = chain_.kinds[0];
    const auto [least, most] = count_operands(block_, count_);
    for (std::size_t j = 0; j < most; ++j) {
      make_operand(kind, j);
      if (j == 0) {
        __builtin_memcpy(row(chain_.taken_up), row(operand_of(kind)), lanes_ * sizeof(Real));
      } else if (j < least) {
        combine(kind, chain_.taken_up);
      } else {
        combine(kind, operand_of(kind));
        const T index = static_cast<Real>(j);
        take_up(kind, [&](std::size_t lane) { return T::load(block_.operands + lane) > index; });
      }
    }
    return most * (kind.length + 1) - 1;
  }

  /// Where lanes may have operands of several kinds at one place: each is made for all of them, and taken up by its own.
  std::size_t run_mixed() const {
    const std::size_t most = count_operands(block_, count_).most;
    std::size_t instructions = 0;
    for (std::size_t j = 0; j < most; ++j) {
      const Real* const kinds = columns_of(j) + (chain_.columns - 1) * kLanes;
      for (std::size_t k = 0; k < chain_.kind_count; ++k) {
        const T index = static_cast<Real>(k);
        const auto has = [&](std::size_t lane) { return T::load(kinds + lane) == index; };
        Mask<Real> any = has(0);
        for_each_batch<Real>(count_, [&](std::size_t lane) { any = any | has(lane); });
        if (any.bits() == 0) continue;
        const KindView<Real>& kind = chain_.kinds[k];
        make_operand(kind, j);
        if (j > 0) combine(kind, operand_of(kind));
        take_up(kind, has);
        instructions += kind.length + (j > 0 ? 1 : 0);
      }
    }
    return instructions;
  }

  static std::size_t operand_of(const KindView<Real>& kind) { return kind.body[kind.length - 1].out[0]; }

  void make_operand(const KindView<Real>& kind, std::size_t j) const {
    const Real* const constants = columns_of(j);
    for (std::size_t k = 0; k < kind.length; ++k) {
      const Instruction& instruction = kind.body[k];
      kLaneHandlers<Real>[static_cast<std::size_t>(instruction.op)](
          instruction, constants + kLanes* instruction.constants, block_.registers, count_);
    }
  }

  /// What has been taken up with the operand, into a register.
  void combine(const KindView<Real>& kind, std::size_t into) const {
    Instruction combine = kind.combine;
    combine.out[0] = static_cast<std::uint16_t>(into);
    kValueHandlers<Real>[static_cast<std::size_t>(combine.op)](combine, kind.combine_constants, block_.registers,
                                                               count_, nullptr);
  }

  /// Moves what is in the operand's register to what has been taken up, in those lanes that have it.
  template <class Has>
  [[gnu::always_inline]] void take_up(const KindView<Real>& kind, const Has& has) const {
    Real* const taken_up = row(chain_.taken_up);
    const Real* const operand = row(operand_of(kind));
    for_each_batch<Real>(count_, [&](std::size_t lane) {
      select(has(lane), T::load(operand + lane), T::load(taken_up + lane)).store(taken_up + lane);
    });
  }

  const ChainView<Real>& chain_;
  const ChainBlock<Real>& block_;
  const std::size_t count_;
  const std::size_t lanes_;
};

template <class Real, class Steps, class Task>
class ChainMarcher {
  using T = Lanes<Real>;

 public:
  ChainMarcher(const ChainView<Real>& chain, const ChainBlock<Real>& block, const MarchParameters<Real>& parameters,
               const Task& task)
      : chain_(chain), block_(block), stepper_(parameters, task) {}

  ChainStep step(std::uint64_t live, Counters& counters) {
    ChainEvaluator<Real>(chain_, block_).run(counters);
    counters.evaluations += static_cast<std::uint64_t>(__builtin_popcountll(live));
    return step_rays(batches<Real>(block_.lanes), live);
  }

 private:
  Real* row(std::size_t index) const { return block_.registers + index * kLanes; }

  /// Moves rays on, and places their next samples.
  [[gnu::flatten]] ChainStep step_rays(std::size_t count, std::uint64_t live) {
    BlockState<Real> state = {block_.direction.x, block_.direction.y, block_.direction.z, block_.t,
                              block_.before,      block_.origin.x,    block_.origin.y,    block_.origin.z,
                              block_.t_max,       block_.epsilon,     block_.stride,      block_.boldness};
    const Stepper<Real, Steps, Task> stepper = stepper_;
    const Real* const field = row(chain_.taken_up);
    ChainStep all{0, 0};
    for_each_batch<Real>(count, [&](std::size_t lane) {
      const T t_max = T::load(state.t_max + lane);
      const Step<Real> step = stepper.take_step(state, field, lane, t_max, T::load(state.epsilon + lane));
      const T x = T::load(state.ox + lane) + step.next * T::load(state.dx + lane);
      const T y = T::load(state.oy + lane) + step.next * T::load(state.dy + lane);
      const T z = T::load(state.oz + lane) + step.next * T::load(state.dz + lane);
      x.store(row(0) + lane);
      y.store(row(1) + lane);
      z.store(row(2) + lane);
      const auto is_between = [&](const Real* lo, const T& at, const Real* hi) {
        return (at >= T::load(lo + lane)) & (at <= T::load(hi + lane));
      };
      const Mask<Real> within = is_between(block_.lo.x, x, block_.hi.x) & is_between(block_.lo.y, y, block_.hi.y) &
                                is_between(block_.lo.z, z, block_.hi.z);
      const Mask<Real> goes_on = step.goes_on & (step.next <= t_max);
      all.live |= (goes_on & within).bits() << lane;
      all.left |= (goes_on & !within).bits() << lane;
    });
    return {all.live & live, all.left & live};
  }

  const ChainView<Real> chain_;
  const ChainBlock<Real> block_;
  const Stepper<Real, Steps, Task> stepper_;
};

template <class Real>
void run_chain(const ChainView<Real>& chain, const ChainBlock<Real>& block, Counters& counters) {
  ChainEvaluator<Real>(chain, block).run(counters);
}

template <class Real>
ChainStep step_chain(const ChainView<Real>& chain, const ChainBlock<Real>& block, std::uint64_t live,
                     const MarchParameters<Real>& parameters, Counters& counters) {
  ChainStep step{};
  with_task<Real>(parameters, [&]<class Steps, class Task>(const Task& task) {
    step = ChainMarcher<Real, Steps, Task>(chain, block, parameters, task).step(live, counters);
  });
  return step;
}

template <class Real>
ChainStep step_chain_shadow(const ChainView<Real>& chain, const ChainBlock<Real>& block, std::uint64_t live,
                            const MarchParameters<Real>& parameters, Counters& counters) {
  ChainStep step{};
  with_shadow_task<Real>(parameters, [&]<class Steps, class Task>(const Task& task) {
    step = ChainMarcher<Real, Steps, Task>(chain, block, parameters, task).step(live, counters);
  });
  return step;
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
