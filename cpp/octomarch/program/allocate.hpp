// From data flow to tape: drops what the results do not need, orders the rest so that few values live at once, and
// gives them registers. The lowering comes before, the kernels after.
#pragma once

#include "octomarch/program/dataflow.hpp"
#include "octomarch/program/program.hpp"

namespace octomarch {

/// O(n log n), constant stack. Throws SceneError when more than 65,535 values must live at once.
Tape allocate(const DataFlow& flow, std::span<const ValueId> results);

}  // namespace octomarch
