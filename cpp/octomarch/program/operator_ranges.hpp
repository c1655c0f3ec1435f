// What the outputs of an instruction can be, given what its inputs can be. Comes before prune.hpp.
#pragma once

#include "octomarch/program/instruction.hpp"
#include "octomarch/program/range.hpp"

namespace octomarch {

/// Fills as many ranges as the opcode has outputs. `constants`: the instruction's first.
template <class Real>
void operator_ranges(Opcode op, const Real* constants, const Range<Real>* in, Range<Real>* out);

}  // namespace octomarch
