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
    T own[Constants];
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

/// The field at the lanes' points, into the register that `combine` writes.
template <class Real>
void evaluate_chain(const ChainView<Real>& chain, const ChainBlock<Real>& block, Counters& counters) {
  using T = Lanes<Real>;
  const std::size_t count = batches<Real>(block.lanes);
  const auto row = [&](std::size_t index) { return block.registers + index * kLanes; };
  const std::size_t lanes = count * kWidth<Real>;
  const auto [least, most] = count_operands(block, count);
  const Instruction& combine = chain.combine;
  const Handler<Real> take_up = kValueHandlers<Real>[static_cast<std::size_t>(combine.op)];
  Instruction aside = combine;  // where not all lanes have as many operands
  aside.out[0] = combine.in[1];
  Real* const taken_up = row(combine.out[0]);
  const Real* const operand = row(combine.in[1]);
  for (std::size_t j = 0; j < most; ++j) {
    const Real* const constants = block.constants + j * chain.constants * kLanes;
    for (std::size_t k = 0; k < chain.body_length; ++k) {
      const Instruction& instruction = chain.body[k];
      kLaneHandlers<Real>[static_cast<std::size_t>(instruction.op)](
          instruction, constants + kLanes* instruction.constants, block.registers, count);
    }
    if (j == 0) {
      __builtin_memcpy(taken_up, operand, lanes * sizeof(Real));
    } else if (j < least) {
      take_up(combine, chain.combine_constants, block.registers, count, nullptr);
    } else {
      take_up(aside, chain.combine_constants, block.registers, count, nullptr);
      const T index = static_cast<Real>(j);
      for_each_batch<Real>(count, [&](std::size_t lane) {
        const Mask<Real> has = T::load(block.operands + lane) > index;
        select(has, T::load(operand + lane), T::load(taken_up + lane)).store(taken_up + lane);
      });
    }
  }
  counters.lane_slots += lanes;
  counters.instructions += lanes * (most * (chain.body_length + 1) - 1);
}

template <class Real, class Steps, class Task>
class ChainMarcher {
  using T = Lanes<Real>;

 public:
  ChainMarcher(const ChainView<Real>& chain, const ChainBlock<Real>& block, const MarchParameters<Real>& parameters,
               const Task& task)
      : chain_(chain), block_(block), stepper_(parameters, task) {}

  ChainStep step(std::uint64_t live, Counters& counters) {
    evaluate_chain(chain_, block_, counters);
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
    const Real* const field = row(chain_.combine.out[0]);
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
