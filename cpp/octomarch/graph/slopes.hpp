// A function of the point over a box: its values and its slope, with the rules by which both go through operations.
// Intervals come before it; expression_bounds.cpp walks expressions with it.
//
// Two bounds of the gradient are carried, since each is the better one somewhere: an interval of each partial
// derivative, and one number for the gradient's length. Where a function has a kink, both hold the gradients on either
// side; where it may jump, both are unbounded.
#pragma once

#include <array>
#include <span>

#include "octomarch/base/interval.hpp"

namespace octomarch {

struct Slopes {
  Interval value;
  std::array<Interval, 3> partial;
  double length = 0.0;  ///< ≥ ‖∇‖

  bool is_constant() const;
};

/// ‖∇‖ by the better of the two bounds.
double steepness(const Slopes& a);

/// The same number everywhere, known as far as the interval says.
Slopes level(const Interval& value);

/// A function of which only the values are known: it may jump.
Slopes jumping(const Interval& value);

/// A function that is no number somewhere: comparisons with it may turn out either way.
Slopes undefined();

/// f(a) with the given values, where the derivative f′ lies in `derivative`.
Slopes chained(const Interval& value, const Interval& derivative, const Slopes& a);

/// An operand of a function of several numbers, and the interval of the function's derivative by it.
struct Weighted {
  const Slopes* operand;
  Interval derivative;
};

/// φ(a, b, …) with the given values, where the length of φ's own gradient is at most `length`.
Slopes chained(const Interval& value, double length, std::span<const Weighted> operands);

/// One of both: where a function is chosen by comparing the two, and at ties they agree.
Slopes either(const Interval& value, const Slopes& a, const Slopes& b);

Slopes operator+(const Slopes& a, const Slopes& b);
Slopes operator-(const Slopes& a, const Slopes& b);
Slopes operator*(const Slopes& a, const Slopes& b);
Slopes operator/(const Slopes& a, const Slopes& b);
Slopes mod(const Slopes& a, const Slopes& b);
/// As C's pow.
Slopes pow(const Slopes& a, const Slopes& b);
Slopes atan2(const Slopes& y, const Slopes& x);

}  // namespace octomarch
