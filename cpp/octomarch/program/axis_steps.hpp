// Which instructions of a tape read coordinates: the derivatives of these are 1 and 0, and gradients need not compute with them.
// Comes after compilation; the kernels' evaluate_dual goes by it.
#pragma once

#include <span>
#include <vector>

#include "octomarch/program/instruction.hpp"

namespace octomarch {

/// A step for each instruction of code whose registers 0, 1, 2 are the coordinates, and one for whoever reads the result. O(code).
std::vector<AxisStep> axis_steps(std::span<const Instruction> code, std::size_t registers, std::uint16_t result);

}  // namespace octomarch
