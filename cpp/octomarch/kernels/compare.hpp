// Which operand each operator of a tape takes at a block of points, as far as they differ by more than given gaps. By this the
// octree prunes: the points are the middles of a cell's parts, and gaps come from slopes. evaluate.hpp comes before.
#pragma once

#include <limits>

#include "octomarch/kernels/evaluate.hpp"
#include "octomarch/program/choices.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

/// Where which operand is taken: where they differ by more than `gap`.
template <class Real>
TakenAt taken_at(const Instruction& instruction, const Real* registers, Real gap) {
  using T = Lanes<Real>;
  static_assert(kLanes == 64);
  const bool negates_second = subtracts(instruction.op);
  const Real* const a = registers + instruction.in[0] * kLanes;
  const Real* const b = registers + instruction.in[1] * kLanes;
  std::uint64_t smaller = 0;
  std::uint64_t larger = 0;
  for (std::size_t lane = 0; lane < kLanes; lane += kWidth<Real>) {
    const T first = T::load(a + lane);
    const T second = T::load(b + lane);
    const T difference = negates_second ? first + second : first - second;
    smaller |= (difference < T(-gap)).bits() << lane;
    larger |= (difference > T(gap)).bits() << lane;
  }
  return takes_larger(instruction.op) ? TakenAt{larger, smaller} : TakenAt{smaller, larger};
}

template <class Real>
void compare(const TapeView<Real>& tape, Real* registers, const Vectors<const Real>& points, double radius,
             const std::uint32_t* origins, const Margin* margins, TakenAt* taken) {
  using T = Lanes<Real>;
  for (std::size_t lane = 0; lane < kLanes; lane += kWidth<Real>) {
    T::load(points.x + lane).store(registers + lane);
    T::load(points.y + lane).store(registers + kLanes + lane);
    T::load(points.z + lane).store(registers + 2 * kLanes + lane);
  }
  for (std::size_t i = 0; i < tape.length; ++i) {
    const Instruction& instruction = tape.code[i];
    const Margin& margin = margins[origins[i]];
    const auto gap = static_cast<Real>(static_cast<double>(margin.slope) * radius + static_cast<double>(margin.room));
    const bool is_known = gap < std::numeric_limits<Real>::infinity();
    taken[i] = is_known ? taken_at(instruction, registers, gap) : TakenAt{};
    kValueHandlers<Real>[static_cast<std::size_t>(instruction.op)](instruction, tape.constants + instruction.constants,
                                                                   registers, kLanes / kWidth<Real>, tape.images);
  }
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
