// The tape interpreter: runs a program over a block of lanes, one instruction at a time, each over all the block's
// batches. Two instances of the same operators: over lanes (distances) and over duals (distances with exact gradients).
// Compilation comes before; march.hpp and surface.hpp call it.
#pragma once

#include <type_traits>

#include "octomarch/base/dual.hpp"
#include "octomarch/kernels/api.hpp"
#include "octomarch/kernels/lanes.hpp"
#include "octomarch/ops/attribute.hpp"
#include "octomarch/ops/csg.hpp"
#include "octomarch/ops/domain.hpp"
#include "octomarch/ops/expression.hpp"
#include "octomarch/ops/flat.hpp"
#include "octomarch/ops/grid.hpp"
#include "octomarch/ops/polyhedra.hpp"
#include "octomarch/ops/primitives.hpp"
#include "octomarch/ops/texture.hpp"
#include "octomarch/program/instruction.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

/// How a number type lies in the register file: `kComponents` rows of kLanes each.
template <class T>
struct RegisterLayout;

template <class Real>
struct RegisterLayout<Lanes<Real>> {
  static constexpr std::size_t kComponents = 1;
  static Lanes<Real> load(const Real* row) { return Lanes<Real>::load(row); }
  static void store(const Lanes<Real>& a, Real* row) { a.store(row); }
};

template <class Real>
struct RegisterLayout<Dual<Lanes<Real>>> {
  static constexpr std::size_t kComponents = 4;
  static Dual<Lanes<Real>> load(const Real* row) {
    return {Lanes<Real>::load(row), Lanes<Real>::load(row + kLanes), Lanes<Real>::load(row + 2 * kLanes),
            Lanes<Real>::load(row + 3 * kLanes)};
  }
  static void store(const Dual<Lanes<Real>>& a, Real* row) {
    a.value.store(row);
    a.dx.store(row + kLanes);
    a.dy.store(row + 2 * kLanes);
    a.dz.store(row + 3 * kLanes);
  }
};

/// An operator with the constants of one instruction; some look at the tape's images too.
template <template <class> class Op, class Real>
Op<Lanes<Real>> operator_of(const Real* constants, const ImageView* images) {
  if constexpr (std::is_constructible_v<Op<Lanes<Real>>, const Real*, const ImageView*>) {
    return Op<Lanes<Real>>(constants, images);
  } else {
    return Op<Lanes<Real>>(constants);
  }
}

/// Runs one instruction over `count` batches. All inputs of a batch are read before its outputs are written, since
/// they may share registers.
template <class Real>
using Handler = void (*)(const Instruction& instruction, const Real* constants, Real* registers, std::size_t count,
                         const ImageView* images);

template <template <class> class Op, class T, class Real, std::size_t Inputs, std::size_t Outputs>
[[gnu::flatten]] void execute(const Instruction& instruction, const Real* constants, Real* registers, std::size_t count,
                              const ImageView* images) {
  using Layout = RegisterLayout<T>;
  constexpr std::size_t kRegister = Layout::kComponents * kLanes;
  const auto op = operator_of<Op, Real>(constants, images);
  Real* const out0 = registers + instruction.out[0] * kRegister;
  Real* const out1 = registers + instruction.out[1] * kRegister;
  Real* const out2 = registers + instruction.out[2] * kRegister;
  const Real* const in0 = registers + instruction.in[0] * kRegister;
  const Real* const in1 = registers + instruction.in[1] * kRegister;
  const Real* const in2 = registers + instruction.in[2] * kRegister;
  const Real* const in3 = registers + instruction.in[3] * kRegister;

  const auto call = [&](std::size_t lane) {
    if constexpr (Inputs == 0) return Lift<T>::from(op());
    if constexpr (Inputs == 1) return op(Layout::load(in0 + lane));
    if constexpr (Inputs == 2) return op(Layout::load(in0 + lane), Layout::load(in1 + lane));
    if constexpr (Inputs == 3) return op(Layout::load(in0 + lane), Layout::load(in1 + lane), Layout::load(in2 + lane));
    if constexpr (Inputs == 4) {
      return op(Layout::load(in0 + lane), Layout::load(in1 + lane), Layout::load(in2 + lane), Layout::load(in3 + lane));
    }
  };
  for_each_batch<Real>(count, [&](std::size_t lane) {
    const auto result = call(lane);
    if constexpr (Outputs == 1) {
      Layout::store(result, out0 + lane);
    } else {
      Layout::store(result.x, out0 + lane);
      Layout::store(result.y, out1 + lane);
      if constexpr (Outputs == 3) Layout::store(result.z, out2 + lane);
    }
  });
}

/// Attribute operators have no derivative and are never part of a distance program.
template <class Real>
constexpr Handler<Real> kValueHandlers[] = {
#define OCTOMARCH_OPCODE(op, mnemonic, inputs, outputs, constants) \
  &execute<ops::op, Lanes<Real>, Real, inputs, outputs>,
#include "octomarch/program/opcodes.def"
#undef OCTOMARCH_OPCODE
};

template <template <class> class Op, class Real, std::size_t Inputs, std::size_t Outputs>
constexpr Handler<Real> dual_handler() {
  if constexpr (Inputs == 4) {
    return nullptr;
  } else {
    return &execute<Op, Dual<Lanes<Real>>, Real, Inputs, Outputs>;
  }
}

template <class Real>
constexpr Handler<Real> kDualHandlers[] = {
#define OCTOMARCH_OPCODE(op, mnemonic, inputs, outputs, constants) dual_handler<ops::op, Real, inputs, outputs>(),
#include "octomarch/program/opcodes.def"
#undef OCTOMARCH_OPCODE
};

/// A coordinate, but for a constant, as the input `Index` of an operator.
template <class T, std::size_t Index>
using Coordinate = Dual<T, std::conditional_t<Index == 0, One, Zero>, std::conditional_t<Index == 1, One, Zero>,
                        std::conditional_t<Index == 2, One, Zero>>;

/// Runs an instruction whose inputs are different coordinates: derivatives by its inputs are those along their axes. Outputs that
/// are coordinates too are stored without derivatives.
template <template <class> class Op, class Real, std::size_t Inputs, std::size_t Outputs>
[[gnu::flatten]] void execute_on_coordinates(const Instruction& instruction, const AxisStep& step,
                                             const Real* constants, Real* registers, std::size_t count) {
  using T = Lanes<Real>;
  constexpr std::size_t kRegister = 4 * kLanes;
  const Op<T> op(constants);
  Real* const out0 = registers + instruction.out[0] * kRegister;
  Real* const out1 = registers + instruction.out[1] * kRegister;
  Real* const out2 = registers + instruction.out[2] * kRegister;
  const Real* const in0 = registers + instruction.in[0] * kRegister;
  const Real* const in1 = registers + instruction.in[1] * kRegister;
  const Real* const in2 = registers + instruction.in[2] * kRegister;
  Real* const along0 = out0 + (1 + step.axes[0]) * kLanes;
  Real* const along1 = out0 + (1 + step.axes[1]) * kLanes;
  Real* const along2 = out0 + (1 + step.axes[2]) * kLanes;

  const auto call = [&](std::size_t lane) {
    const Coordinate<T, 0> x{T::load(in0 + lane), {}, {}, {}};
    if constexpr (Inputs == 1) {
      return op(x);
    } else {
      const Coordinate<T, 1> y{T::load(in1 + lane), {}, {}, {}};
      if constexpr (Inputs == 2) return op(x, y);
      if constexpr (Inputs == 3) return op(x, y, Coordinate<T, 2>{T::load(in2 + lane), {}, {}, {}});
    }
  };
  for_each_batch<Real>(count, [&](std::size_t lane) {
    const auto result = call(lane);
    if constexpr (Outputs == 3) {
      result.x.value.store(out0 + lane);
      result.y.value.store(out1 + lane);
      result.z.value.store(out2 + lane);
    } else {
      result.value.store(out0 + lane);
      if constexpr (std::is_same_v<decltype(result), const Coordinate<T, 0>>) return;
      as_lanes<T>(result.dx).store(along0 + lane);
      as_lanes<T>(result.dy).store(along1 + lane);
      as_lanes<T>(result.dz).store(along2 + lane);
    }
  });
}

template <class Real>
using CoordinateHandler = void (*)(const Instruction& instruction, const AxisStep& step, const Real* constants,
                                   Real* registers, std::size_t count);

template <class Real>
constexpr CoordinateHandler<Real> kCoordinateHandlers[] = {
#define OCTOMARCH_OPCODE(op, mnemonic, inputs, outputs, constants) nullptr,
#define OCTOMARCH_AXIS_OPCODE(op, mnemonic, inputs, outputs, constants) \
  &execute_on_coordinates<ops::op, Real, inputs, outputs>,
#include "octomarch/program/opcodes.def"
#undef OCTOMARCH_OPCODE
};

/// Runs a tape whose coordinates lie in registers 0, 1, 2; returns the rows of its result.
template <class Real>
const Real* evaluate(const TapeView<Real>& tape, Real* registers, std::size_t count) {
  for (const Instruction* i = tape.code; i != tape.code + tape.length; ++i) {
    kValueHandlers<Real>[static_cast<std::size_t>(i->op)](*i, tape.constants + i->constants, registers, count,
                                                          tape.images);
  }
  return registers + tape.result * kLanes;
}

/// Stores the derivatives of registers that are coordinates; kNoAxis is none.
template <class Real>
void store_axes(const std::array<std::uint16_t, kMaxInputs>& in, const std::array<std::uint8_t, 3>& axes,
                Real* registers, std::size_t count) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (axes[k] == kNoAxis) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Lanes<Real> derivative = Real(axis == axes[k] ? 1 : 0);
      Real* const row = registers + (4 * in[k] + 1 + axis) * kLanes;
      for_each_batch<Real>(count, [&](std::size_t lane) { derivative.store(row + lane); });
    }
  }
}

/// The same over duals: rows value, ∂/∂x, ∂/∂y, ∂/∂z of the result. Registers are four times as large; of the coordinates
/// there are the values.
template <class Real>
const Real* evaluate_dual(const TapeView<Real>& tape, Real* registers, std::size_t count) {
  if (tape.axes == nullptr) store_axes<Real>({0, 1, 2}, {0, 1, 2}, registers, count);
  for (std::size_t i = 0; i < tape.length; ++i) {
    const Instruction& instruction = tape.code[i];
    const auto op = static_cast<std::size_t>(instruction.op);
    const Real* const constants = tape.constants + instruction.constants;
    if (tape.axes != nullptr && tape.axes[i].is_on_coordinates) {
      kCoordinateHandlers<Real>[op](instruction, tape.axes[i], constants, registers, count);
      continue;
    }
    if (tape.axes != nullptr) store_axes(instruction.in, tape.axes[i].axes, registers, count);
    kDualHandlers<Real>[op](instruction, constants, registers, count, tape.images);
  }
  if (tape.axes != nullptr) store_axes({tape.result}, tape.axes[tape.length].axes, registers, count);
  return registers + tape.result * 4 * kLanes;
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
