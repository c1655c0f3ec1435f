// Operators of the attribute program: they carry which primitive's surface a point lies on, beside the distances that
// decide it. Object ids are whole numbers held as lanes, exact up to 2²⁴ in float.
#pragma once

#include "octomarch/ops/csg.hpp"

namespace octomarch::ops {

/// The same value everywhere. Constants: the value.
template <class C>
struct Constant {
  C value;
  template <class Real>
  explicit Constant(const Real* p) : value(p[0]) {}

  C operator()() const { return value; }
};

/// Id of the operand that a union shows: a's where a < b. Inputs: a, b, id of a, id of b.
template <class C>
struct SelectUnion : NoConstants {
  using NoConstants::NoConstants;
  C operator()(const C& a, const C& b, const C& id_a, const C& id_b) const { return select(a < b, id_a, id_b); }
};

template <class C>
struct SelectIntersection : NoConstants {
  using NoConstants::NoConstants;
  C operator()(const C& a, const C& b, const C& id_a, const C& id_b) const { return select(a > b, id_a, id_b); }
};

/// In a difference the wall of a cut is b's.
template <class C>
struct SelectDifference : NoConstants {
  using NoConstants::NoConstants;
  C operator()(const C& a, const C& b, const C& id_a, const C& id_b) const { return select(a > -b, id_a, id_b); }
};

}  // namespace octomarch::ops
