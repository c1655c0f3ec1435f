// Operators of the attribute programs: what is carried beside the distances that decide it. Object ids are selected: whole
// numbers held as lanes, exact up to 2²⁴ in float. What surfaces are made of is selected too, and mixed across smooth
// operators by the weights with which the operands' gradients count in the blend's.
#pragma once

#include "octomarch/ops/csg.hpp"
#include "octomarch/ops/math.hpp"

namespace octomarch::ops {

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

/// Weights of a smooth operator: of the operand that min (max) takes, 1 − max(k − |gap|, 0)/(2k), of the other the rest.
/// Constants: k, 1/(2k).
template <class C>
struct MixWeight {
  C k, half_inverse, zero;
  template <class Real>
  explicit MixWeight(const Real* p) : k(p[0]), half_inverse(p[1]), zero(Real(0)) {}

  /// `taken` moved towards `other`, which does not show at all, no number or infinite as it may be, where it has no weight.
  C operator()(const C& gap, const C& taken, const C& other) const {
    const C share = max(k - abs(gap), zero) * half_inverse;
    return select(share > zero, taken + (other - taken) * share, taken);
  }
};

/// Inputs: a, b, what a shows, what b shows.
template <class C>
struct MixUnion {
  MixWeight<C> weight;
  template <class Real>
  explicit MixUnion(const Real* p) : weight(p) {}

  C operator()(const C& a, const C& b, const C& of_a, const C& of_b) const {
    const auto first = a < b;
    return weight(a - b, select(first, of_a, of_b), select(first, of_b, of_a));
  }
};

template <class C>
struct MixIntersection {
  MixWeight<C> weight;
  template <class Real>
  explicit MixIntersection(const Real* p) : weight(p) {}

  C operator()(const C& a, const C& b, const C& of_a, const C& of_b) const {
    const auto first = a > b;
    return weight(a - b, select(first, of_a, of_b), select(first, of_b, of_a));
  }
};

template <class C>
struct MixDifference {
  MixWeight<C> weight;
  template <class Real>
  explicit MixDifference(const Real* p) : weight(p) {}

  C operator()(const C& a, const C& b, const C& of_a, const C& of_b) const {
    const auto first = a > -b;
    return weight(a + b, select(first, of_a, of_b), select(first, of_b, of_a));
  }
};

/// Weight of b: 1/(1 + exp((b − a)/k)). Constants: 1/k.
template <class C>
struct MixMetaballs {
  C inverse, zero, one;
  template <class Real>
  explicit MixMetaballs(const Real* p) : inverse(p[0]), zero(Real(0)), one(Real(1)) {}

  C operator()(const C& a, const C& b, const C& of_a, const C& of_b) const {
    const C share = one / (one + exp((b - a) * inverse));
    return select(share > zero, select(share < one, of_a + (of_b - of_a) * share, of_b), of_a);
  }
};

}  // namespace octomarch::ops
