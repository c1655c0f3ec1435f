#include "octomarch/program/rounding.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "octomarch/program/grid_magnitude.hpp"
#include "octomarch/program/operator_ranges.hpp"
#include "octomarch/program/program.hpp"

namespace octomarch {

namespace {

/// Bounds are made of the numbers of exact arithmetic: this much more holds what roundings add to them, and to the bounds.
constexpr double kMargin = 1.01;
/// Bounds hold for cubes about the anchor, each twice the last: up to so many times the first.
constexpr int kCubes = 24;

double magnitude(const Range<double>& range) { return range.magnitude(); }

/// The errors of all values of a tape whose coordinates are at most `farthest`.
class ErrorWalk {
 public:
  ErrorWalk(const Tape& tape, double unit, double farthest)
      : tape_(tape), unit_(unit), errors_(tape.registers, 0.0), ranges_(tape.registers) {
    for (std::size_t i = 0; i < 3; ++i) ranges_[i] = Range<double>(-farthest, farthest);
  }

  double result() {
    for (const Instruction& instruction : tape_.code) step(instruction);
    return errors_[tape_.result()];
  }

 private:
  /// What an instruction works on.
  struct Operands {
    const double* p;
    Range<double> in[kMaxInputs];
    double error[kMaxInputs];
    double largest = 0.0;  ///< of its constants, inputs and outputs
  };

  void step(const Instruction& instruction) {
    const OpcodeInfo& shape = info(instruction.op);
    Operands o;
    o.p = tape_.constants.data() + instruction.constants;
    for (std::size_t i = 0; i < shape.constants; ++i) {
      const double size = std::fabs(o.p[i]);
      if (size < std::numeric_limits<double>::infinity()) o.largest = std::max(o.largest, size);  // else: limits
    }
    for (std::size_t i = 0; i < shape.inputs; ++i) {
      o.in[i] = ranges_[instruction.in[i]];
      o.error[i] = errors_[instruction.in[i]];
      o.largest = std::max(o.largest, magnitude(o.in[i]));
    }
    Range<double> out[kMaxOutputs];
    operator_ranges(instruction.op, o.p, o.in, out);
    for (std::size_t i = 0; i < shape.outputs; ++i) o.largest = std::max(o.largest, magnitude(out[i]));
    const double error = error_after(instruction.op, o, out[0]);
    for (std::size_t i = 0; i < shape.outputs; ++i) {
      ranges_[instruction.out[i]] = out[i];
      errors_[instruction.out[i]] = std::isnan(error) ? kInfinity : error;
    }
  }

  /// So many roundings of numbers as large as an instruction's.
  double roundings(double count, const Operands& o) const { return count * unit_ * o.largest; }
  static double sum(const Operands& o, std::size_t count) {
    double all = 0.0;
    for (std::size_t i = 0; i < count; ++i) all += o.error[i];
    return all;
  }

  /// Of an edge and a point: the distance to the edges before, which is infinite at first, has its own error.
  static double edge_size(const Operands& o) {
    double size = magnitude(o.in[0]) + magnitude(o.in[1]);
    for (std::size_t i = 0; i < 4; ++i) size += std::fabs(o.p[i]);
    return size;
  }

  static double largest_factor(const double* matrix) {
    double largest = 0.0;
    for (std::size_t i = 0; i < 12; ++i) largest = std::max(largest, i % 4 == 3 ? 0.0 : std::fabs(matrix[i]));
    return largest;
  }

  /// What has been turned with input 0 in a plane, by an angle that is off by `angle`.
  double turned(const Operands& o, std::size_t other, double angle) const {
    const double moved = o.error[0] + o.error[other];
    const double width = std::min(std::hypot(magnitude(o.in[0]), magnitude(o.in[other])), std::fabs(o.p[1]));
    return moved + width * (angle + 24.0 * unit_) + roundings(8.0, o);
  }

  /// Counts are of the operations in ops/, each with its worst sign; primitives are no steeper than 1 in their inputs.
  double error_after(Opcode op, const Operands& o, const Range<double>& out) const {
    const double* const e = o.error;
    switch (op) {
      case Opcode::kSphere:
      case Opcode::kOriginSphere:
      case Opcode::kBox:
      case Opcode::kOriginBox:
      case Opcode::kBoxExterior:
      case Opcode::kBoxMaximum:
      case Opcode::kCylinder:
      case Opcode::kOriginCylinder:
      case Opcode::kRectangle:
      case Opcode::kCappedCylinder:
      case Opcode::kTorus:
      case Opcode::kPlane: return sum(o, info(op).inputs) + roundings(24.0, o);
      case Opcode::kLinearGrid:
      case Opcode::kCubicGrid: return o.p[ops::kGridLipschitz] * sum(o, 3) + 64.0 * unit_ * grid_magnitude(o.p, o.in);
      case Opcode::kCapsule:
      case Opcode::kCappedCone:
      case Opcode::kOctahedron:
      case Opcode::kPyramid: return sum(o, 3) + roundings(128.0, o);
      case Opcode::kAxisPlane:
      case Opcode::kShell:
      case Opcode::kElongate:
      case Opcode::kAddConstant:
      case Opcode::kSubtractFrom: return e[0] + roundings(4.0, o);
      case Opcode::kAdd:
      case Opcode::kSubtract: return e[0] + e[1] + roundings(2.0, o);
      case Opcode::kExtrude: return e[0] + e[1] + roundings(16.0, o);
      case Opcode::kComplement:
      case Opcode::kClamp:
      case Opcode::kAbsolute:
      case Opcode::kMinimumConstant:
      case Opcode::kMaximumConstant: return e[0] + roundings(1.0, o);  // of the constant
      case Opcode::kUnion:
      case Opcode::kIntersection:
      case Opcode::kDifference: return std::max(e[0], e[1]);
      case Opcode::kSmoothUnion:
      case Opcode::kSmoothIntersection:
      case Opcode::kSmoothDifference: return std::max(e[0], e[1]) + roundings(16.0, o);  // weights that add up to 1
      case Opcode::kMetaballs: return std::max(e[0], e[1]) + roundings(64.0, o);
      case Opcode::kPolygonEdge: return std::max(e[2], e[0] + e[1] + 32.0 * unit_ * edge_size(o));
      case Opcode::kPolygon: return e[0];
      case Opcode::kRotate: return sum(o, 3) * largest_factor(o.p) + roundings(32.0, o);
      // where a rounding chooses another cell, the contents of both say the same
      case Opcode::kRepeat: return sum(o, 3) + roundings(16.0, o);
      case Opcode::kRepeatAxis:
      case Opcode::kRepeatCounted:
      case Opcode::kRepeatNeighbour: return e[0] + roundings(8.0, o);
      case Opcode::kTwist: {
        const double rate = std::fabs(o.p[0]);
        return turned(o, 2, rate * (e[1] + 4.0 * unit_ * magnitude(o.in[1])));
      }
      case Opcode::kBend: {
        const double rate = std::fabs(o.p[0]);
        return turned(o, 1, rate * (e[0] + e[1] + 8.0 * unit_ * magnitude(o.in[0])));
      }
      default: return error_of_expression(op, o, out);
    }
  }

  /// The same of those that only expressions have.
  double error_of_expression(Opcode op, const Operands& o, const Range<double>& out) const {
    const double* const e = o.error;
    switch (op) {
      case Opcode::kConstant: return std::isinf(o.p[0]) ? 0.0 : roundings(1.0, o);
      case Opcode::kMultiplyConstant: return std::fabs(o.p[0]) * e[0] + 4.0 * unit_ * magnitude(out);
      case Opcode::kDivideConstant: return e[0] / std::fabs(o.p[0]) + 4.0 * unit_ * magnitude(out);
      case Opcode::kMultiply:
        return magnitude(o.in[0]) * e[1] + magnitude(o.in[1]) * e[0] + e[0] * e[1] + 2.0 * unit_ * magnitude(out);
      case Opcode::kSquareRoot: return std::sqrt(e[0]) + 2.0 * unit_ * magnitude(out);
      case Opcode::kSine:
      case Opcode::kCosine: return e[0] + unit_ * (8.0 + 4.0 * magnitude(o.in[0]));
      default: return kInfinity;
    }
  }

  const Tape& tape_;
  double unit_;
  std::vector<double> errors_;  ///< by register
  std::vector<Range<double>> ranges_;
};

}  // namespace

Rounding rounding_of(const Tape& tape, double unit, double size) {
  Rounding rounding{kMargin * ErrorWalk(tape, unit, size).result(), 0.0, size};
  for (int cube = 0; cube < kCubes; ++cube) {
    const double before = rounding.reach;
    const double error = kMargin * ErrorWalk(tape, unit, 2.0 * before).result();
    if (!(error < kInfinity)) break;
    rounding.slope = std::max(rounding.slope, (error - rounding.offset) / before);
    rounding.reach = 2.0 * before;
  }
  return rounding;
}

Doubt doubt_of(const Tape& tape, double unit, double size, double lipschitz) {
  // squares of what is farther away, and sums of them, may be more than the largest number
  const double farthest = unit > 0x1p-30 ? 0x1p60 : 0x1p500;
  // a point o + t·d, with o and d rounded, and t as the sum of two numbers
  const double place = 8.0 * unit;
  const Rounding rounding = rounding_of(tape, unit, size);
  return {kMargin * rounding.offset / lipschitz, kMargin * (rounding.slope / lipschitz + place),
          std::min(rounding.reach, farthest)};
}

}  // namespace octomarch
