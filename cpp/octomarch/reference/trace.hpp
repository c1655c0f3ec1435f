// A number along a piece of a ray: where it starts, where it ends, between what it stays and how fast it changes, all
// with outward rounding. Intervals come before it; traces of expressions, primitives and operators are made of these.
//
// The place on the piece is s from 0 to 1, so a rate is the change that it would make over the whole piece. Two bounds of
// the values are intersected after each operation: the operation's own over the operands' values, and what the ends and
// the rates leave, which is nearly exact on short pieces (A. Neumaier, "Interval Methods for Systems of Equations",
// Cambridge 1990, 2.3: the linear boundary value form).
#pragma once

#include <array>
#include <span>

#include "octomarch/base/interval.hpp"

namespace octomarch::reference {

struct Trace {
  Interval over;              ///< all its values
  Interval first;             ///< its value at s = 0
  Interval last;              ///< at s = 1
  Interval rise;              ///< all (f(b) − f(a))/(b − a) there are; whole() where it may jump
  bool is_straight = false;   ///< is it known to be affine in s?
  bool is_undefined = false;  ///< may it be no number somewhere? Then the rest says nothing

  friend bool operator==(const Trace&, const Trace&) = default;
};

using PointTrace = std::array<Trace, 3>;

/// The same number everywhere, known as far as the interval says.
inline Trace constant(const Interval& value) { return {value, value, value, 0.0, true}; }
Trace undefined();

/// The trace within what its ends and its rise leave.
Trace tightened(const Trace& a);

/// f of traces, where f is a function of intervals, and `rise` bounds its rate.
template <class Function, class... Operands>
Trace mapped(const Function& f, const Interval& rise, const Operands&... a) {
  return tightened({f(a.over...), f(a.first...), f(a.last...), rise, false, (a.is_undefined || ...)});
}

Trace operator+(const Trace& a, const Trace& b);
Trace operator-(const Trace& a);
Trace operator-(const Trace& a, const Trace& b);
Trace operator*(const Trace& a, const Trace& b);
Trace operator*(const Trace& a, const Interval& factor);
/// Undefined where b may be 0.
Trace operator/(const Trace& a, const Trace& b);
Trace operator/(const Trace& a, const Interval& divisor);
inline Trace operator+(const Trace& a, const Interval& b) { return a + constant(b); }
inline Trace operator-(const Trace& a, const Interval& b) { return a + constant(-b); }

Trace square(const Trace& a);
/// Undefined where a may be below 0.
Trace sqrt(const Trace& a);
Trace abs(const Trace& a);
Trace min(const Trace& a, const Trace& b);
Trace max(const Trace& a, const Trace& b);
inline Trace min(const Trace& a, double b) { return min(a, constant(b)); }
inline Trace max(const Trace& a, double b) { return max(a, constant(b)); }

/// Of a vector: its length.
Trace length(std::span<const Trace> v);
/// How fast a point that moves so can move at the most.
double speed(std::span<const Trace> v);
/// `a`, which changes no faster than `most`.
Trace no_faster(Trace a, double most);

/// (1 − share)·a + share·b, the share lying within [0, 1].
Interval blend(const Interval& a, const Interval& b, const Interval& share);

/// min(a, b) − max(k − |a − b|, 0)²/(4k); for k = 0, min(a, b).
Trace smooth_minimum(const Trace& a, const Trace& b, double k);
/// min(a, b) − k·log1p(exp(−|a − b|/k)); k > 0.
Trace exponential_minimum(const Trace& a, const Trace& b, double k);

}  // namespace octomarch::reference
