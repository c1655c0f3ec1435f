// By how much the field that kernels compute may be off the one that its operators describe, by a static bound of the roundings
// of every instruction (N. J. Higham, "Accuracy and Stability of Numerical Algorithms", 2nd ed., 2002, ch. 3). Tapes come
// before it; certified marches need it.
#pragma once

#include "octomarch/graph/scene.hpp"

namespace octomarch {

struct Tape;

/// A tape's result at points with |p|∞ ≤ reach is off by no more than offset + slope·|p|∞. The offset is infinite where nothing
/// is known.
struct Rounding {
  double offset;
  double slope;
  double reach;
};

/// O(tape). `unit`: half an ulp of 1. `size`: the largest coordinate of what rays are meant to hit, > 0.
Rounding rounding_of(const Tape& tape, double unit, double size);

/// What certified marches of the tape in such numbers allow for, the roundings of a ray's points included.
Doubt doubt_of(const Tape& tape, double unit, double size, double lipschitz);

}  // namespace octomarch
