#include "octomarch/program/axis_steps.hpp"

#include <algorithm>

namespace octomarch {

namespace {

/// `axes`: of what is in each register.
AxisStep step_of(const Instruction& instruction, const std::vector<std::uint8_t>& axes) {
  const OpcodeInfo& shape = info(instruction.op);
  const std::size_t inputs = std::min<std::size_t>(shape.inputs, 3);
  AxisStep step{{kNoAxis, kNoAxis, kNoAxis}, shape.of_coordinates != OfCoordinates::kAnything};
  bool is_used[kNoAxis + 1] = {};
  for (std::size_t k = 0; k < inputs; ++k) {
    const std::uint8_t axis = axes[instruction.in[k]];
    step.axes[k] = axis;
    step.is_on_coordinates &= axis != kNoAxis && !is_used[axis];
    is_used[axis] = true;
  }
  for (std::size_t k = inputs; step.is_on_coordinates && k < 3; ++k) {
    step.axes[k] = static_cast<std::uint8_t>(std::find(is_used, is_used + kNoAxis, false) - is_used);
    is_used[step.axes[k]] = true;
  }
  return step;
}

}  // namespace

std::vector<AxisStep> axis_steps(std::span<const Instruction> code, std::size_t registers, std::uint16_t result) {
  std::vector<std::uint8_t> axes(std::max<std::size_t>(registers, 3), kNoAxis);
  for (std::uint8_t axis = 0; axis < 3; ++axis) axes[axis] = axis;
  std::vector<AxisStep> steps;
  steps.reserve(code.size() + 1);
  for (const Instruction& instruction : code) {
    const OpcodeInfo& shape = info(instruction.op);
    const AxisStep step = step_of(instruction, axes);
    const bool keeps = step.is_on_coordinates && shape.of_coordinates == OfCoordinates::kCoordinates;
    for (std::size_t k = 0; k < shape.outputs; ++k) axes[instruction.out[k]] = keeps ? step.axes[k] : kNoAxis;
    steps.push_back(step);
  }
  steps.push_back({{axes[result], kNoAxis, kNoAxis}, false});
  return steps;
}

}  // namespace octomarch
