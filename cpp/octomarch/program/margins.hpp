// By how much the operands of an operator must differ at a point so that it takes the same one everywhere near. A field's value
// changes by its slope times the distance at the most, so that samples in the middles of small balls speak for all of space that
// these cover (W. Barbier et al., "Lipschitz pruning", CGF 44(2), 2025). Comes before prune.hpp, which decides by them.
#pragma once

#include <cstdint>
#include <vector>

#include "octomarch/program/choices.hpp"
#include "octomarch/program/program.hpp"
#include "octomarch/program/region.hpp"

namespace octomarch {

/// O(tape). `everywhere`: holds all points at which the tape is run.
template <class Real>
std::vector<Margin> margins_of(const Tape& tape, const Region<Real>& everywhere);

}  // namespace octomarch
