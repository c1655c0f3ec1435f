// Every operation over traces, with its derivative. See trace_expression.hpp.
#include "octomarch/reference/trace_expression.hpp"

#include <cmath>

#include "octomarch/reference/trace_lattice.hpp"

namespace octomarch::reference {
namespace {

/// A function of one number by its interval extension, where its derivative lies in `derivative`.
template <class Function>
Trace chained(const Function& f, const Interval& derivative, const Trace& a) {
  return mapped(f, derivative * a.rise, a);
}

/// A number of which only the values are known: it may jump.
Trace jumping(const Interval& over, const Interval& first, const Interval& last) {
  return {over, first, last, Interval::whole()};
}

/// Is the function no number for some x in the interval?
bool may_be_undefined(NodeKind kind, const Interval& x) {
  if (kind == NodeKind::kSquareRoot || kind == NodeKind::kLogarithm) return x.lo() < 0.0;
  if (kind == NodeKind::kTangent) return tan(x) == Interval::whole();  // a pole
  if (kind == NodeKind::kArcSine || kind == NodeKind::kArcCosine) return x.lo() < -1.0 || x.hi() > 1.0;
  return false;
}

/// 1/√(1 − x²), for x in [−1, 1].
Interval slope_of_arcsine(const Interval& x) { return Interval(1.0) / sqrt(Interval(1.0) - square(x)); }

Trace floor_of(const Trace& a) {
  const Interval whole = floor(a.over);
  return whole.is_point() ? constant(whole) : jumping(whole, floor(a.first), floor(a.last));
}

Trace unary(NodeKind kind, const Trace& a) {
  const Interval& x = a.over;
  if (may_be_undefined(kind, x)) return undefined();
  switch (kind) {
    case NodeKind::kNegate: return -a;
    case NodeKind::kAbsolute: return abs(a);
    case NodeKind::kSquareRoot: return sqrt(a);
    case NodeKind::kFloor: return floor_of(a);
    case NodeKind::kExponential: return chained([](const Interval& y) { return exp(y); }, exp(x), a);
    case NodeKind::kLogarithm: return chained([](const Interval& y) { return log(y); }, Interval(1.0) / x, a);
    case NodeKind::kSine: return chained([](const Interval& y) { return sin(y); }, cos(x), a);
    case NodeKind::kCosine: return chained([](const Interval& y) { return cos(y); }, -sin(x), a);
    case NodeKind::kTangent:
      return chained([](const Interval& y) { return tan(y); }, Interval(1.0) + square(tan(x)), a);
    case NodeKind::kArcSine: return chained([](const Interval& y) { return asin(y); }, slope_of_arcsine(x), a);
    case NodeKind::kArcCosine: return chained([](const Interval& y) { return acos(y); }, -slope_of_arcsine(x), a);
    default: return chained([](const Interval& y) { return atan(y); }, Interval(1.0) / (Interval(1.0) + square(x)), a);
  }
}

Trace mod(const Trace& a, const Trace& b) {
  if (b.over.contains(0.0)) return undefined();
  const auto remainder = [](const Interval& x, const Interval& y) {
    return overlap(x - y * floor(x / y), hull(0.0, y));
  };
  const Interval cells = floor(a.over / b.over);
  const Interval rise = cells.is_point() ? a.rise - cells * b.rise : Interval::whole();
  return mapped(remainder, rise, a, b);
}

/// x^y for x ≥ 0, and y > 0 where x may be 0.
Interval power(const Interval& x, const Interval& y) {
  const auto raised = [&y](double base) { return base == 0.0 ? Interval(0.0) : exp(y * log(Interval(base))); };
  return hull(raised(x.lo()), raised(x.hi()));
}

Trace power(const Trace& a, const Trace& b) {
  const bool is_positive = a.over.lo() > 0.0 || (a.over.lo() == 0.0 && b.over.lo() > 0.0);
  if (!is_positive) return undefined();
  const auto value = [](const Interval& x, const Interval& y) { return power(x, y); };
  if (b.rise == Interval(0.0)) {
    const bool is_smooth = a.over.lo() > 0.0 || b.over.lo() > 1.0;
    const Interval slope = is_smooth ? b.over * power(a.over, b.over - 1.0) : Interval{0.0, kInfinity};
    return mapped(value, slope * a.rise, a, b);
  }
  if (a.over.lo() == 0.0) return jumping(value(a.over, b.over), value(a.first, b.first), value(a.last, b.last));
  const Interval raised = value(a.over, b.over);
  return mapped(value, b.over * raised / a.over * a.rise + raised * log(a.over) * b.rise, a, b);
}

Trace angle(const Trace& y, const Trace& x) {
  const auto value = [](const Interval& v, const Interval& u) { return atan2(v, u); };
  const bool may_jump = y.over.contains(0.0) && x.over.lo() <= 0.0;
  const Interval squared = square(x.over) + square(y.over);
  return mapped(value, may_jump ? Interval::whole() : (x.over * y.rise - y.over * x.rise) / squared, y, x);
}

/// The truth of a < b, or of a ≤ b where equal ones count. Whatever is no number is neither.
Trace comparison(const Trace& a, const Trace& b, bool equal_counts) {
  if (a.is_undefined || b.is_undefined) return jumping({0.0, 1.0}, {0.0, 1.0}, {0.0, 1.0});
  const auto truth = [equal_counts](const Interval& x, const Interval& y) -> Interval {
    const bool holds = equal_counts ? x.hi() <= y.lo() : x.hi() < y.lo();
    const bool fails = equal_counts ? x.lo() > y.hi() : x.lo() >= y.hi();
    return holds ? Interval(1.0) : fails ? Interval(0.0) : Interval{0.0, 1.0};
  };
  const Interval over = truth(a.over, b.over);
  return over.is_point() ? constant(over) : jumping(over, truth(a.first, b.first), truth(a.last, b.last));
}

Trace where(const Trace& condition, const Trace& a, const Trace& b) {
  if (!condition.is_undefined && condition.over == Interval(0.0)) return b;
  if (!condition.over.contains(0.0)) return a;
  if (condition.is_undefined || a.is_undefined || b.is_undefined) return undefined();
  const auto chosen = [](const Interval& test, const Interval& x, const Interval& y) {
    if (!test.contains(0.0)) return x;
    return test == Interval(0.0) ? y : hull(x, y);
  };
  return jumping(chosen(condition.over, a.over, b.over), chosen(condition.first, a.first, b.first),
                 chosen(condition.last, a.last, b.last));
}

/// Infinite numbers are none to calculate with: ∞ − ∞ and 0·∞ are undefined. Ends at infinity are no such numbers.
bool is_infinite(const Trace& a) { return std::isinf(a.over.lo()) && a.over.is_point(); }

Trace binary(NodeKind kind, const Trace& a, const Trace& b) {
  switch (kind) {
    case NodeKind::kLess: return comparison(a, b, false);
    case NodeKind::kLessEqual: return comparison(a, b, true);
    case NodeKind::kMinimum: return min(a, b);
    case NodeKind::kMaximum: return max(a, b);
    default: break;
  }
  if (a.is_undefined || b.is_undefined || is_infinite(a) || is_infinite(b)) return undefined();
  switch (kind) {
    case NodeKind::kAdd: return a + b;
    case NodeKind::kSubtract: return a - b;
    case NodeKind::kMultiply: return a * b;
    case NodeKind::kDivide: return a / b;
    case NodeKind::kModulo: return mod(a, b);
    case NodeKind::kPower: return power(a, b);
    default: return angle(a, b);
  }
}

/// Of the point, by index; the normal, of which nothing is known, after it.
Trace coordinate(std::size_t index, const PointTrace& p) {
  return index < 3 ? p[index] : jumping({-1.0, 1.0}, {-1.0, 1.0}, {-1.0, 1.0});
}

}  // namespace

TracedExpression::TracedExpression(const Node& root) : steps_(steps_of(root)), results_(steps_.size()) {
  for (const Step& step : steps_) {
    ranges_.push_back(step.node->kind() == NodeKind::kTexel ? channel_range(*step.node) : Interval());
  }
}

const Trace& TracedExpression::along(const PointTrace& p) {
  for (std::size_t i = 0; i < steps_.size(); ++i) results_[i] = result(i, p);
  return results_.back();
}

Trace TracedExpression::result(std::size_t i, const PointTrace& p) const {
  const Step& step = steps_[i];
  const Node& node = *step.node;
  const auto operand = [&](std::size_t number) -> const Trace& { return results_[step.operands[number]]; };
  switch (node.kind()) {
    case NodeKind::kCoordinate: return coordinate(static_cast<std::size_t>(node.parameter(0)), p);
    case NodeKind::kConstant: return constant(node.parameter(0));
    case NodeKind::kWhere: return where(operand(0), operand(1), operand(2));
    case NodeKind::kNoise: return noise(node, {operand(0), operand(1), operand(2)});
    case NodeKind::kTexel: return texel(node, ranges_[i], operand(0), operand(1));
    case NodeKind::kMultiply:
      if (step.operands[0] == step.operands[1]) return square(operand(0));
      break;
    default: break;
  }
  if (node.children().size() == 2) return binary(node.kind(), operand(0), operand(1));
  return operand(0).is_undefined || is_infinite(operand(0)) ? undefined() : unary(node.kind(), operand(0));
}

}  // namespace octomarch::reference
