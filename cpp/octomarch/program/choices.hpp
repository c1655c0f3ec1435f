// Which opcodes take one of two operands, and by what. margins.hpp, prune.hpp and the kernel that compares build on it.
#pragma once

#include <limits>

#include "octomarch/program/instruction.hpp"

namespace octomarch {

/// Does an opcode take one of its operands by which of two distances is the smaller or the larger, where these differ by enough?
/// All that unite, intersect or subtract, and what selects or mixes attributes accordingly.
constexpr bool chooses_operand(Opcode op) {
  switch (op) {
    case Opcode::kUnion:
    case Opcode::kIntersection:
    case Opcode::kDifference:
    case Opcode::kSmoothUnion:
    case Opcode::kSmoothIntersection:
    case Opcode::kSmoothDifference:
    case Opcode::kMetaballs:
    case Opcode::kSelectUnion:
    case Opcode::kSelectIntersection:
    case Opcode::kSelectDifference:
    case Opcode::kMixUnion:
    case Opcode::kMixIntersection:
    case Opcode::kMixDifference:
    case Opcode::kMixMetaballs: return true;
    default: return false;
  }
}

/// Are its third and fourth operands what is taken, by the first and second?
constexpr bool chooses_attribute(Opcode op) { return chooses_operand(op) && info(op).inputs == 4; }

/// Does it compare the first operand with the negative of the second?
constexpr bool subtracts(Opcode op) {
  return op == Opcode::kDifference || op == Opcode::kSmoothDifference || op == Opcode::kSelectDifference ||
         op == Opcode::kMixDifference;
}

/// Does it go by the larger of both, not by the smaller?
constexpr bool takes_larger(Opcode op) {
  return subtracts(op) || op == Opcode::kIntersection || op == Opcode::kSmoothIntersection ||
         op == Opcode::kSelectIntersection || op == Opcode::kMixIntersection;
}

/// Is there a kernel that runs it with constants of each lane's own? Of what primitives are made by, moved and put together.
constexpr bool runs_by_lanes(Opcode op) {
  switch (op) {
    case Opcode::kCappedCone:
    case Opcode::kOctahedron:
    case Opcode::kPyramid:
    case Opcode::kComplement:
    case Opcode::kShell:
    case Opcode::kExtrude:
    case Opcode::kRotate:
    case Opcode::kElongate:
    case Opcode::kAbsolute:
    case Opcode::kAddConstant:
    case Opcode::kMultiplyConstant: return true;
    default:
      return info(op).of_coordinates == OfCoordinates::kNumber || (chooses_operand(op) && !chooses_attribute(op));
  }
}

/// In so many times its k the exponential blend is nothing, even beside a denormal number.
template <class Real>
constexpr Real kMetaballReach = sizeof(Real) == sizeof(float) ? Real(128) : Real(1024);

/// By how much its two distances must differ for it to take one of its operands as it is. `p`: its first constant.
template <class Real>
constexpr Real blend_reach(Opcode op, const Real* p) {
  switch (op) {
    case Opcode::kSmoothUnion:
    case Opcode::kSmoothIntersection:
    case Opcode::kSmoothDifference:
    case Opcode::kMixUnion:
    case Opcode::kMixIntersection:
    case Opcode::kMixDifference: return p[0];
    case Opcode::kMetaballs: return p[0] * kMetaballReach<Real>;
    case Opcode::kMixMetaballs: return kMetaballReach<Real> / p[0];
    default: return Real(0);
  }
}

/// For each instruction of a tape: operands whose difference at a point is more than room + slope·R keep their order, and do not
/// blend, within R of it, roundings included. Infinite where nothing is known: operands that jump, or have no bound, and whatever
/// is no operator of two distances.
struct Margin {
  float slope;
  float room;
};

constexpr bool is_known(const Margin& margin) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  return margin.slope < kInfinity && margin.room < kInfinity;
}

/// At which of 64 points an operator is known to take its first operand, and where its second.
struct TakenAt {
  std::uint64_t first = 0;
  std::uint64_t second = 0;
};

}  // namespace octomarch
