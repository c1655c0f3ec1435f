#include "octomarch/program/margins.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "octomarch/program/grid_magnitude.hpp"
#include "octomarch/program/operator_ranges.hpp"

namespace octomarch {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// What is known of a value. Coordinates are functions of one axis each of a common frame, so that a function of several of
/// them is no steeper than the steepest: `axes` says of which (as bits), and is 0 where that is not known.
struct Steepness {
  double slope = 0.0;  ///< ≥ ‖∇‖
  double error = 0.0;  ///< what it may be off by roundings
  std::uint32_t frame = 0;
  std::uint32_t axes = 0;
};

template <class Real>
class Walk {
 public:
  Walk(const Tape& tape, const Region<Real>& everywhere)
      : tape_(tape), constants_(constants_of<Real>(tape)), values_(tape.registers), ranges_(tape.registers) {
    for (std::uint32_t i = 0; i < tape.inputs; ++i) {
      const bool is_coordinate = i < 3;
      values_[i] = {is_coordinate ? 1.0 : kInfinity, 0.0, 0, is_coordinate ? 1U << i : 0U};
      ranges_[i] = is_coordinate ? Range<Real>(everywhere.lo[i], everywhere.hi[i]) : Range<Real>::whole();
    }
  }

  Margin step(const Instruction& instruction) {
    const OpcodeInfo& shape = info(instruction.op);
    const Real* const p = constants_ + instruction.constants;
    Steepness in[kMaxInputs];
    Range<Real> in_ranges[kMaxInputs];
    for (std::size_t i = 0; i < shape.inputs; ++i) {
      in[i] = values_[instruction.in[i]];
      in_ranges[i] = ranges_[instruction.in[i]];
    }
    Range<Real> out[kMaxOutputs];
    operator_ranges(instruction.op, p, in_ranges, out);
    const double largest =
        is_grid(instruction.op) ? grid_magnitude(p, in_ranges) : magnitude_of(instruction, in_ranges, out);
    const Steepness result = after(instruction.op, p, in, rounding(largest));
    for (std::size_t i = 0; i < shape.outputs; ++i) {
      Steepness& value = values_[instruction.out[i]];
      value = result;
      if (shape.outputs > 1) value.axes = 1U << i;
      ranges_[instruction.out[i]] = out[i];
    }
    return chooses_operand(instruction.op) ? margin(instruction.op, p, in, rounding(largest)) : nothing_known();
  }

 private:
  static double magnitude(const Range<Real>& range) { return static_cast<double>(range.magnitude()); }

  /// The largest of an instruction's constants, inputs and outputs.
  double magnitude_of(const Instruction& instruction, const Range<Real>* in_ranges, const Range<Real>* out) const {
    const OpcodeInfo& shape = info(instruction.op);
    const Real* const p = constants_ + instruction.constants;
    double largest = 0.0;
    for (std::size_t i = 0; i < shape.constants; ++i) largest = std::max(largest, std::fabs(static_cast<double>(p[i])));
    const bool is_edge = instruction.op == Opcode::kPolygonEdge;  // whose third input, passed on, may be infinite
    for (std::size_t i = 0; i < (is_edge ? 2U : shape.inputs); ++i)
      largest = std::max(largest, magnitude(in_ranges[i]));
    for (std::size_t i = 0; i < (is_edge ? 0U : shape.outputs); ++i) largest = std::max(largest, magnitude(out[i]));
    return largest;
  }

  /// No operator loses more than this of what goes into it.
  static double rounding(double largest) {
    return 64.0 * static_cast<double>(std::numeric_limits<Real>::epsilon()) * largest;
  }
  static Margin nothing_known() {
    constexpr float kNever = std::numeric_limits<float>::infinity();
    return {kNever, kNever};
  }

  static Margin margin(Opcode op, const Real* p, const Steepness* in, double loss) {
    const double slope = in[0].slope + in[1].slope;
    const double room = static_cast<double>(blend_reach(op, p)) + in[0].error + in[1].error + loss;
    if (std::isnan(slope + room) || std::isinf(slope + room)) return nothing_known();
    // rounded up on the way to float
    constexpr double kUp = 1.0 + 1e-6;
    return {static_cast<float>(slope * kUp), static_cast<float>(room * kUp)};
  }

  /// A function of all inputs, of slope 1 in them.
  static Steepness joined(const Steepness* in, std::size_t count, double loss) {
    Steepness all{0.0, loss, in[0].frame, 0};
    double squares = 0.0;
    bool is_across_axes = true;
    for (std::size_t i = 0; i < count; ++i) {
      is_across_axes = is_across_axes && in[i].axes != 0 && in[i].frame == all.frame && (in[i].axes & all.axes) == 0;
      all.axes |= in[i].axes;
      all.slope = std::max(all.slope, in[i].slope);
      all.error += in[i].error;
      squares += in[i].slope * in[i].slope;
    }
    if (!is_across_axes) {
      all.axes = 0;
      all.slope = std::sqrt(squares);
    }
    return all;
  }

  /// One of both, or a blend of them with weights that add up to 1. Errors do not add up: of thousands of operands few blend at
  /// one point, and the roundings of those that do cancel as random ones do.
  static Steepness either(const Steepness& a, const Steepness& b, double loss) {
    const bool is_one_frame = a.axes != 0 && b.axes != 0 && a.frame == b.frame;
    return {std::max(a.slope, b.slope), std::max({a.error, b.error, 4.0 * loss}), a.frame,
            is_one_frame ? a.axes | b.axes : 0U};
  }

  static Steepness scaled(const Steepness& a, double factor, double loss) {
    return {a.slope * factor, a.error * factor + loss, a.frame, a.axes};
  }

  /// By the largest row sum of MᵀM, whose root is at least the norm of M.
  static double norm_of(const Real* m) {
    double largest = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
      double sum = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        double product = 0.0;
        for (std::size_t row = 0; row < 3; ++row)
          product += static_cast<double>(m[4 * row + i]) * static_cast<double>(m[4 * row + k]);
        sum += std::fabs(product);
      }
      largest = std::max(largest, sum);
    }
    return std::sqrt(largest);
  }

  Steepness after(Opcode op, const Real* p, const Steepness* in, double loss) {
    switch (op) {
      case Opcode::kSphere:
      case Opcode::kOriginSphere:
      case Opcode::kBox:
      case Opcode::kOriginBox:
      case Opcode::kCappedCylinder:
      case Opcode::kTorus:
      case Opcode::kCapsule:
      case Opcode::kBoxExterior:
      case Opcode::kBoxMaximum:
      case Opcode::kCappedCone:
      case Opcode::kOctahedron:
      case Opcode::kPyramid: return joined(in, 3, loss);
      case Opcode::kPlane: return scaled(joined(in, 3, loss), std::hypot(p[0], p[1], p[2]), 0.0);
      case Opcode::kLinearGrid:
      case Opcode::kCubicGrid: return scaled(joined(in, 3, 0.0), static_cast<double>(p[ops::kGridLipschitz]), loss);
      case Opcode::kCylinder:
      case Opcode::kOriginCylinder:
      case Opcode::kRectangle:
      case Opcode::kPolygonEdge:  // beside the edges before
      case Opcode::kExtrude: return joined(in, 2, loss);
      case Opcode::kAxisPlane:
      case Opcode::kPolygon:
      case Opcode::kComplement:
      case Opcode::kShell:
      case Opcode::kElongate:
      case Opcode::kClamp:
      case Opcode::kAddConstant:
      case Opcode::kSubtractFrom:
      case Opcode::kMinimumConstant:
      case Opcode::kMaximumConstant:
      case Opcode::kAbsolute: return scaled(in[0], 1.0, loss);
      case Opcode::kMultiplyConstant: return scaled(in[0], std::fabs(static_cast<double>(p[0])), loss);
      case Opcode::kDivideConstant: return scaled(in[0], 1.0 / std::fabs(static_cast<double>(p[0])), loss);
      case Opcode::kConstant: return {0.0, loss, 0, 0};
      case Opcode::kUnion:
      case Opcode::kIntersection:
      case Opcode::kDifference:
      case Opcode::kSmoothUnion:
      case Opcode::kSmoothIntersection:
      case Opcode::kSmoothDifference:
      case Opcode::kMetaballs: return either(in[0], in[1], loss);
      case Opcode::kAdd:
      case Opcode::kSubtract: return {in[0].slope + in[1].slope, in[0].error + in[1].error + loss, 0, 0};
      case Opcode::kRotate: {
        const double norm = norm_of(p);
        Steepness turned = joined(in, 3, 0.0);
        turned = scaled(turned, norm, loss);
        turned.frame = ++frames_;
        return turned;
      }
      default: return {kInfinity, kInfinity, 0, 0};
    }
  }

  const Tape& tape_;
  const Real* constants_ = nullptr;
  std::vector<Steepness> values_;  ///< by register
  std::vector<Range<Real>> ranges_;
  std::uint32_t frames_ = 0;
};

}  // namespace

template <class Real>
std::vector<Margin> margins_of(const Tape& tape, const Region<Real>& everywhere) {
  Walk<Real> walk(tape, everywhere);
  std::vector<Margin> margins;
  margins.reserve(tape.code.size());
  for (const Instruction& instruction : tape.code) margins.push_back(walk.step(instruction));
  return margins;
}

template std::vector<Margin> margins_of<float>(const Tape&, const Region<float>&);
template std::vector<Margin> margins_of<double>(const Tape&, const Region<double>&);

}  // namespace octomarch
