// Most operators are instantiated over ranges as they stand. Some say more when their monotony is used, or have operands that
// hang together; of samples of grids no more is known than between what they lie, of images nothing.
#include "octomarch/program/operator_ranges.hpp"

#include "octomarch/base/dual.hpp"
#include "octomarch/ops/attribute.hpp"
#include "octomarch/ops/csg.hpp"
#include "octomarch/ops/domain.hpp"
#include "octomarch/ops/expression.hpp"
#include "octomarch/ops/flat.hpp"
#include "octomarch/ops/grid.hpp"
#include "octomarch/ops/polyhedra.hpp"
#include "octomarch/ops/primitives.hpp"
#include "octomarch/ops/texture.hpp"

namespace octomarch {

namespace {

/// Gradient noise stays below 1.0364 (graph/expression_bounds.cpp).
constexpr double kNoise = 1.0625;

double smooth_minimum(double a, double b, double k) {
  const double overlap = std::max(k - std::fabs(a - b), 0.0);
  return std::min(a, b) - overlap * overlap / (4.0 * k);
}

double metaballs(double a, double b, double k) {
  return std::min(a, b) - k * std::log1p(std::exp(-std::fabs(a - b) / k));
}

/// A blend that grows with both operands, from its value at their ends.
template <class Real, class Blend>
Range<Real> blended(const Range<Real>& a, const Range<Real>& b, Real k, Blend&& blend) {
  if (a.is_whole() || b.is_whole()) return Range<Real>::whole();
  const auto at = [&](Real x, Real y) {
    return blend(static_cast<double>(x), static_cast<double>(y), static_cast<double>(k));
  };
  const double magnitude =
      static_cast<double>(a.magnitude()) + static_cast<double>(b.magnitude()) + static_cast<double>(k);
  return approximated<Real>(Interval(at(a.lo, b.lo), at(a.hi, b.hi)), magnitude);
}

/// A point turned about the origin by some angle, after it was pulled to within `radius` of it: by angle(u) where it is not
/// pulled.
template <class Real, class Angle>
void turned(const Range<Real>& u, const Range<Real>& v, Real radius, Angle&& angle, Range<Real>* out) {
  const Range<Real> reach = sqrt(square(u) + square(v));
  const Range<Real> turn = angle(u);
  if (!reach.is_finite() || !turn.is_finite()) {
    out[0] = out[1] = Range<Real>::whole();
    return;
  }
  if (reach.hi < radius * Real(0.999)) {  // nothing is pulled
    const Range<Real> c = cos(turn);
    const Range<Real> s = sin(turn);
    out[0] = c * u - s * v;
    out[1] = s * u + c * v;
    return;
  }
  const Real farthest = std::min(reach.hi, radius) * Real(1.001);
  out[0] = out[1] = {-farthest, farthest};
}

template <class Real>
Range<Real> noise_range(const Range<Real>* in) {
  const bool is_finite = in[0].is_finite() && in[1].is_finite() && in[2].is_finite();
  return is_finite ? Range<Real>(Real(-kNoise), Real(kNoise)) : Range<Real>::whole();
}

/// Of the samples nothing is known but between what they lie.
template <class Real>
Range<Real> grid_range(const Real* p, const Range<Real>* in) {
  const Interval between(static_cast<double>(p[ops::kGridLeast]), static_cast<double>(p[ops::kGridMost]));
  const Range<Real> zero(Real(0));
  Range<Real> excess[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Real* const of_axis = p + ops::kGridAxes + axis * ops::kGridAxisConstants;
    excess[axis] = abs(in[axis] - Range<Real>(of_axis[2])) - Range<Real>(of_axis[3]);
  }
  const Range<Real> box =
      ops::box_distance(excess[0], excess[1], excess[2], zero) * Range<Real>(p[ops::kGridSteepness]);
  return ops::box_distance(approximated<Real>(between, between.magnitude()), box, zero);
}

/// The operator itself, over ranges. Everything is inlined: this is most of the time that cells take to be made.
template <template <class> class Op, std::size_t kInputs, std::size_t kOutputs, class Real>
[[gnu::flatten]] void instantiated(const Real* constants, const Range<Real>* in, Range<Real>* out) {
  const Op<Range<Real>> op(constants);
  const auto call = [&] {
    if constexpr (kInputs == 0) return op();
    if constexpr (kInputs == 1) return op(in[0]);
    if constexpr (kInputs == 2) return op(in[0], in[1]);
    if constexpr (kInputs == 3) return op(in[0], in[1], in[2]);
    if constexpr (kInputs == 4) return op(in[0], in[1], in[2], in[3]);
  };
  const auto result = call();
  if constexpr (kOutputs == 1) {
    out[0] = result;
  } else {
    out[0] = result.x;
    out[1] = result.y;
    if constexpr (kOutputs == 3) out[2] = result.z;
  }
}

/// Operators of which more can be said than their text says over ranges, or nothing at all.
template <Opcode kOp>
constexpr bool kIsSpecial =
    kOp == Opcode::kSmoothUnion || kOp == Opcode::kSmoothIntersection || kOp == Opcode::kSmoothDifference ||
    kOp == Opcode::kMetaballs || kOp == Opcode::kElongate || kOp == Opcode::kTwist || kOp == Opcode::kBend ||
    kOp == Opcode::kNoise || kOp == Opcode::kTexel || kOp == Opcode::kLinearGrid || kOp == Opcode::kCubicGrid;

template <Opcode kOp, class Real>
void special(const Real* p, const Range<Real>* in, Range<Real>* out) {
  if constexpr (kOp == Opcode::kSmoothUnion) {
    out[0] = blended(in[0], in[1], p[0], smooth_minimum);
  } else if constexpr (kOp == Opcode::kSmoothIntersection) {
    out[0] = -blended(-in[0], -in[1], p[0], smooth_minimum);
  } else if constexpr (kOp == Opcode::kSmoothDifference) {
    out[0] = -blended(-in[0], in[1], p[0], smooth_minimum);
  } else if constexpr (kOp == Opcode::kMetaballs) {
    out[0] = blended(in[0], in[1], p[0], metaballs);
  } else if constexpr (kOp == Opcode::kElongate) {
    out[0] = {in[0].lo - std::clamp(in[0].lo, -p[0], p[0]), in[0].hi - std::clamp(in[0].hi, -p[0], p[0])};
  } else if constexpr (kOp == Opcode::kTwist) {
    turned(in[0], in[2], p[1], [&](const Range<Real>&) { return in[1] * Range<Real>(p[0]); }, out);
  } else if constexpr (kOp == Opcode::kBend) {
    turned(in[0], in[1], p[1], [&](const Range<Real>& u) { return u * Range<Real>(p[0]); }, out);
  } else if constexpr (kOp == Opcode::kNoise) {
    out[0] = noise_range(in);
  } else if constexpr (kOp == Opcode::kLinearGrid || kOp == Opcode::kCubicGrid) {
    out[0] = grid_range(p, in);
  } else {
    out[0] = out[1] = out[2] = Range<Real>::whole();
  }
}

template <class Real>
using RangeFunction = void (*)(const Real* constants, const Range<Real>* in, Range<Real>* out);

template <Opcode kOp, template <class> class Op, std::size_t kInputs, std::size_t kOutputs, class Real>
constexpr RangeFunction<Real> range_function() {
  if constexpr (kIsSpecial<kOp>) {
    return &special<kOp, Real>;
  } else {
    return &instantiated<Op, kInputs, kOutputs, Real>;
  }
}

template <class Real>
constexpr RangeFunction<Real> kRangeFunctions[] = {
#define OCTOMARCH_OPCODE(op, mnemonic, inputs, outputs, constants) \
  range_function<Opcode::k##op, ops::op, inputs, outputs, Real>(),
#include "octomarch/program/opcodes.def"
#undef OCTOMARCH_OPCODE
};

}  // namespace

template <class Real>
void operator_ranges(Opcode op, const Real* constants, const Range<Real>* in, Range<Real>* out) {
  kRangeFunctions<Real>[static_cast<std::size_t>(op)](constants, in, out);
}

template void operator_ranges(Opcode, const float*, const Range<float>*, Range<float>*);
template void operator_ranges(Opcode, const double*, const Range<double>*, Range<double>*);

}  // namespace octomarch
