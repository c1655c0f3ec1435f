// The rules for slopes: sums, products, chains. All roundings go outward.
#include "octomarch/graph/slopes.hpp"

#include <algorithm>
#include <cmath>

namespace octomarch {
namespace {

double sum_above(double a, double b) { return rounding::add<true>(a, b); }
double product_above(double a, double b) { return rounding::multiply<true>(a, b); }
double root_above(double a) { return rounding::square_root<true>(a); }

/// |∇a·∇b| at the most.
double dot_above(const Slopes& a, const Slopes& b) {
  double sum = 0.0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    sum = sum_above(sum, product_above(a.partial[axis].magnitude(), b.partial[axis].magnitude()));
  }
  return std::min(sum, product_above(a.length, b.length));
}

/// Bound of the spectral norm of the matrix whose rows are the operands' gradients: the largest eigenvalue of its
/// product with its transpose lies within a Gershgorin disc.
double spectral_norm(std::span<const Weighted> operands) {
  double largest = 0.0;
  for (const Weighted& row : operands) {
    double sum = 0.0;
    for (const Weighted& column : operands) sum = sum_above(sum, dot_above(*row.operand, *column.operand));
    largest = std::max(largest, sum);
  }
  return root_above(largest);
}

}  // namespace

bool Slopes::is_constant() const {
  return std::ranges::all_of(partial, [](const Interval& p) { return p == Interval(0.0); });
}

double steepness(const Slopes& a) { return std::min(a.length, root_above(dot_above(a, a))); }

Slopes level(const Interval& value) { return {value, {}, 0.0}; }

Slopes jumping(const Interval& value) {
  return {value, {Interval::whole(), Interval::whole(), Interval::whole()}, kInfinity};
}

Slopes undefined() { return jumping(Interval::whole()); }

Slopes chained(const Interval& value, const Interval& derivative, const Slopes& a) {
  Slopes result{value, {}, product_above(derivative.magnitude(), a.length)};
  for (std::size_t axis = 0; axis < 3; ++axis) result.partial[axis] = derivative * a.partial[axis];
  return result;
}

Slopes chained(const Interval& value, double length, std::span<const Weighted> operands) {
  Slopes result = level(value);
  for (const auto& [operand, derivative] : operands) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      result.partial[axis] = result.partial[axis] + derivative * operand->partial[axis];
    }
    result.length = sum_above(result.length, product_above(derivative.magnitude(), operand->length));
  }
  if (!std::isinf(length)) result.length = std::min(result.length, product_above(length, spectral_norm(operands)));
  return result;
}

Slopes either(const Interval& value, const Slopes& a, const Slopes& b) {
  Slopes result{value, {}, std::max(a.length, b.length)};
  for (std::size_t axis = 0; axis < 3; ++axis) result.partial[axis] = hull(a.partial[axis], b.partial[axis]);
  return result;
}

Slopes operator+(const Slopes& a, const Slopes& b) {
  Slopes result{a.value + b.value, {}, sum_above(a.length, b.length)};
  for (std::size_t axis = 0; axis < 3; ++axis) result.partial[axis] = a.partial[axis] + b.partial[axis];
  return result;
}

Slopes operator-(const Slopes& a, const Slopes& b) { return a + chained(-b.value, -1.0, b); }

Slopes operator*(const Slopes& a, const Slopes& b) {
  const std::array<Weighted, 2> operands{{{&a, b.value}, {&b, a.value}}};
  return chained(a.value * b.value, kInfinity, operands);
}

Slopes operator/(const Slopes& a, const Slopes& b) {
  if (b.value.contains(0.0)) return undefined();
  const Interval quotient = a.value / b.value;
  const std::array<Weighted, 2> operands{{{&a, Interval(1.0) / b.value}, {&b, -quotient / b.value}}};
  Slopes result = chained(quotient, kInfinity, operands);
  // rounded once where the divisor is one number
  if (b.value.is_point() && b.is_constant()) {
    for (std::size_t axis = 0; axis < 3; ++axis) result.partial[axis] = a.partial[axis] / b.value;
    result.length = rounding::divide<true>(a.length, b.value.magnitude());
  }
  return result;
}

Slopes mod(const Slopes& a, const Slopes& b) {
  if (b.value.contains(0.0)) return undefined();
  const Interval between_0_and_b = hull(0.0, b.value);
  const Interval cells = floor(a.value / b.value);
  if (!cells.is_point() || std::isinf(cells.lo())) return jumping(between_0_and_b);
  Slopes result = a - level(cells) * b;
  result.value = overlap(result.value, between_0_and_b);
  return result;
}

Slopes pow(const Slopes& a, const Slopes& b) {
  if (b.is_constant() && b.value == Interval(0.0)) return level(1.0);
  const bool is_power = b.is_constant() && b.value.is_point() && b.value.lo() >= 1.0;
  if (a.value.lo() < 0.0 || (a.value.lo() == 0.0 && !is_power)) return undefined();
  const Interval logarithm = log(a.value);
  const Interval value = exp(b.value * logarithm);
  if (!is_power) {
    const std::array<Weighted, 2> operands{{{&a, b.value * value / a.value}, {&b, value * logarithm}}};
    return chained(value, kInfinity, operands);
  }
  return chained(value, b.value * exp((b.value - 1.0) * logarithm), a);
}

Slopes atan2(const Slopes& y, const Slopes& x) {
  const Interval angle = atan2(y.value, x.value);
  if (y.value.contains(0.0) && x.value.lo() <= 0.0) return jumping(angle);
  const Interval squared = square(y.value) + square(x.value);
  const double slope = (Interval(1.0) / sqrt(squared)).hi();  // of the angle, by the point (x, y)
  const Interval limit{-slope, slope};
  const std::array<Weighted, 2> operands{
      {{&y, overlap(x.value / squared, limit)}, {&x, overlap(-y.value / squared, limit)}}};
  return chained(angle, slope, operands);
}

}  // namespace octomarch
