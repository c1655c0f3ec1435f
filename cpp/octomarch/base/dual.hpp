// Dual numbers in three variables: a value and its exact partial derivatives, carried through an operator's own
// formula (forward differentiation). The operators of ops/ are instantiated over Dual<lanes> to give normals.
//
// Where a function has no derivative, the result keeps the side that has one: abs takes +1 at 0, min and max take an
// operand whole, sqrt takes 0 at 0, and a quotient 0 where its divisor is. So no NaN arises, and a point exactly on a
// face still gets that face's normal. ops/dual_math.hpp has the transcendental functions.
//
// Derivatives that are 0 or 1 everywhere, as those of coordinates are, can be types: then they take no operations.
#pragma once

#include <concepts>
#include <limits>
#include <type_traits>

namespace octomarch {

/// What stands for a slope that is infinite or NaN: 0.
template <class T>
T finite_or_zero(const T& slope) {
  constexpr auto kLargest = std::numeric_limits<typename T::Real>::max();
  return kept(abs(slope) <= T(kLargest), slope);
}

template <class T>
T inverse_or_zero(const T& a) {
  return finite_or_zero(T(1) / a);
}

/// Derivatives that are known beforehand: 0 and 1. Nothing is computed with them.
struct Zero {};
struct One {};

template <class D>
concept IsKnown = std::same_as<D, Zero> || std::same_as<D, One>;
template <class D>
concept IsComputed = !IsKnown<D>;

inline Zero operator-(Zero /*a*/) { return {}; }
auto operator+(const auto& a, Zero /*b*/) { return a; }
auto operator+(Zero /*a*/, const IsComputed auto& b) { return b; }
auto operator-(const auto& a, Zero /*b*/) { return a; }
auto operator-(Zero /*a*/, const IsComputed auto& b) { return -b; }
template <IsComputed T>
T operator-(One /*a*/, const T& b) {
  return T(1) - b;
}
Zero operator*(const auto& /*a*/, Zero /*b*/) { return {}; }
Zero operator*(Zero /*a*/, const IsComputed auto& /*b*/) { return {}; }
auto operator*(const IsComputed auto& a, One /*b*/) { return a; }
auto operator*(One /*a*/, const IsComputed auto& b) { return b; }

/// `T`: a lane type. `value` is what the plain evaluation over T gives, but for the sign of a zero. Each derivative is of the
/// same type, or known.
template <class T, class X = T, class Y = T, class Z = T>
struct Dual {
  T value;
  X dx;
  Y dy;
  Z dz;
};

template <class T, class X, class Y, class Z>
Dual(T, X, Y, Z) -> Dual<T, X, Y, Z>;

template <class T, class... A, class... B>
auto operator+(const Dual<T, A...>& a, const Dual<T, B...>& b) {
  return Dual{a.value + b.value, a.dx + b.dx, a.dy + b.dy, a.dz + b.dz};
}
template <class T, class... A, class... B>
auto operator-(const Dual<T, A...>& a, const Dual<T, B...>& b) {
  return Dual{a.value - b.value, a.dx - b.dx, a.dy - b.dy, a.dz - b.dz};
}
template <class T, class... A, class... B>
auto operator*(const Dual<T, A...>& a, const Dual<T, B...>& b) {
  return Dual{a.value * b.value, a.value * b.dx + b.value * a.dx, a.value * b.dy + b.value * a.dy,
              a.value * b.dz + b.value * a.dz};
}
template <class T, class... A>
auto operator-(const Dual<T, A...>& a) {
  return Dual{-a.value, -a.dx, -a.dy, -a.dz};
}

// Constants have no derivative, so mixed forms skip the work on it.
template <class T, class... A>
Dual<T, A...> operator+(const Dual<T, A...>& a, const std::type_identity_t<T>& c) {
  return {a.value + c, a.dx, a.dy, a.dz};
}
template <class T, class... A>
Dual<T, A...> operator-(const Dual<T, A...>& a, const std::type_identity_t<T>& c) {
  return {a.value - c, a.dx, a.dy, a.dz};
}
template <class T, class... A>
auto operator-(const std::type_identity_t<T>& c, const Dual<T, A...>& a) {
  return Dual{c - a.value, -a.dx, -a.dy, -a.dz};
}
template <class T, class... A>
auto operator*(const Dual<T, A...>& a, const std::type_identity_t<T>& c) {
  return Dual{a.value * c, a.dx * c, a.dy * c, a.dz * c};
}

// (a/b)′ = (a′ − (a/b)·b′)/b.
template <class T>
Dual<T> operator/(const Dual<T>& a, const Dual<T>& b) {
  const T inverse = inverse_or_zero(b.value);
  const T quotient = a.value / b.value;
  const T slope = finite_or_zero(quotient);
  return {quotient, (a.dx - slope * b.dx) * inverse, (a.dy - slope * b.dy) * inverse, (a.dz - slope * b.dz) * inverse};
}
template <class T>
Dual<T> operator/(const Dual<T>& a, const std::type_identity_t<T>& c) {
  const T inverse = inverse_or_zero(c);
  return {a.value / c, a.dx * inverse, a.dy * inverse, a.dz * inverse};
}
template <class T>
Dual<T> operator/(const std::type_identity_t<T>& c, const Dual<T>& b) {
  const T quotient = c / b.value;
  const T slope = finite_or_zero(-quotient * inverse_or_zero(b.value));
  return {quotient, b.dx * slope, b.dy * slope, b.dz * slope};
}

/// A constant as the number type T.
template <class T>
struct Lift {
  static T from(const T& c) { return c; }
};

template <class T>
struct Lift<Dual<T>> {
  static Dual<T> from(const T& c) { return {c, T(0), T(0), T(0)}; }
};

template <class T, class... A>
auto square(const Dual<T, A...>& a) {
  const T twice = a.value + a.value;
  return Dual{a.value * a.value, twice * a.dx, twice * a.dy, twice * a.dz};
}

template <class T, class... A>
auto sqrt(const Dual<T, A...>& a) {
  const T root = sqrt(a.value);
  const T slope = kept(root > T(0), T(0.5F) / root);
  return Dual{root, a.dx * slope, a.dy * slope, a.dz * slope};
}

/// 1/a for derivatives of a length a. Of shorter ones than the root of the least normal number squares are not exact enough to say
/// where they point: they count as 0, which has no derivative.
template <class T>
T inverse_of_length(const T& a) {
  using Real = typename T::Real;
  constexpr auto kLeast = static_cast<Real>(sizeof(Real) == sizeof(float) ? 0x1p-63 : 0x1p-511);
  return kept(a >= T(kLeast), T(1) / a);
}

/// √(x² + y²), with one division for all three derivatives.
template <class T, class... A, class... B>
auto length(const Dual<T, A...>& x, const Dual<T, B...>& y) {
  const T root = sqrt(square(x.value) + square(y.value));
  const T slope = inverse_of_length(root);
  return Dual{root, (x.value * x.dx + y.value * y.dx) * slope, (x.value * x.dy + y.value * y.dy) * slope,
              (x.value * x.dz + y.value * y.dz) * slope};
}

template <class T, class... A, class... B, class... C>
auto length(const Dual<T, A...>& x, const Dual<T, B...>& y, const Dual<T, C...>& z) {
  const T root = sqrt(square(x.value) + square(y.value) + square(z.value));
  const T slope = inverse_of_length(root);
  return Dual{root, (x.value * x.dx + y.value * y.dx + z.value * z.dx) * slope,
              (x.value * x.dy + y.value * y.dy + z.value * z.dy) * slope,
              (x.value * x.dz + y.value * y.dz + z.value * z.dz) * slope};
}

/// A derivative as lanes.
template <class T, class D>
T as_lanes(const D& derivative) {
  if constexpr (std::same_as<D, Zero>) {
    return T(0);
  } else if constexpr (std::same_as<D, One>) {
    return T(1);
  } else {
    return derivative;
  }
}

/// `mask ? a : b` of derivatives.
template <class T, class Mask, class A, class B>
auto chosen(const Mask& mask, const A& a, const B& b) {
  if constexpr (IsKnown<A> && std::same_as<A, B>) {
    return a;
  } else if constexpr (std::same_as<B, Zero>) {
    return kept(mask, as_lanes<T>(a));
  } else {
    return select(mask, as_lanes<T>(a), as_lanes<T>(b));
  }
}

/// A value whose derivatives are those of `mask ? a : b`.
template <class T, class Mask, class... A, class... B>
auto chosen_at(const T& value, const Mask& mask, const Dual<T, A...>& a, const Dual<T, B...>& b) {
  return Dual{value, chosen<T>(mask, a.dx, b.dx), chosen<T>(mask, a.dy, b.dy), chosen<T>(mask, a.dz, b.dz)};
}

/// `mask ? a : b`, the derivatives with the value. `Mask`: the lane type's mask.
template <class Mask, class T, class... A, class... B>
auto select(const Mask& mask, const Dual<T, A...>& a, const Dual<T, B...>& b) {
  return chosen_at(select(mask, a.value, b.value), mask, a, b);
}

template <class T, class... A>
auto abs(const Dual<T, A...>& a) {
  const T sign = select(a.value < T(0), T(-1), T(1));
  return Dual{abs(a.value), a.dx * sign, a.dy * sign, a.dz * sign};
}

template <class T, class... A, class... B>
auto min(const Dual<T, A...>& a, const Dual<T, B...>& b) {
  return chosen_at(min(a.value, b.value), a.value < b.value, a, b);
}

template <class T, class... A, class... B>
auto max(const Dual<T, A...>& a, const Dual<T, B...>& b) {
  return chosen_at(max(a.value, b.value), a.value > b.value, a, b);
}

template <class T, class... A>
auto min(const Dual<T, A...>& a, const std::type_identity_t<T>& c) {
  return chosen_at(min(a.value, c), a.value < c, a, Dual{c, Zero{}, Zero{}, Zero{}});
}

template <class T, class... A>
auto max(const Dual<T, A...>& a, const std::type_identity_t<T>& c) {
  return chosen_at(max(a.value, c), a.value > c, a, Dual{c, Zero{}, Zero{}, Zero{}});
}

/// max(a, 0) as part of a length, whose derivative has a factor of 0 where a ≤ 0. What still has known derivatives is near a
/// coordinate and has finite ones, which need not be taken out.
template <class T, class... A>
auto positive_part(const Dual<T, A...>& a, const T& zero) {
  if constexpr ((IsKnown<A> || ...)) {
    return Dual{max(a.value, zero), a.dx, a.dy, a.dz};
  } else {
    return max(a, zero);
  }
}

/// Where a tie of two fields is to be decided for the first: where only it has a slope. A point on a sphere's surface
/// that is another's centre still gets the normal of the surface.
template <class T>
auto only_first_has_slope(const Dual<T>& a, const Dual<T>& b) {
  const T any = T::from_bits(b.dx.bits() | b.dy.bits() | b.dz.bits());  // 0 where all are, whatever their signs
  return (a.value == b.value) & (any == T(0));
}

template <class T>
Dual<T> smaller_of(const Dual<T>& a, const Dual<T>& b) {
  return select((a.value < b.value) | only_first_has_slope(a, b), a, b);
}

template <class T>
Dual<T> larger_of(const Dual<T>& a, const Dual<T>& b) {
  return select((a.value > b.value) | only_first_has_slope(a, b), a, b);
}

/// Constant between its steps.
template <class T>
Dual<T> floor(const Dual<T>& a) {
  return {floor(a.value), T(0), T(0), T(0)};
}

/// The part that comparisons look at.
template <class T, class... A>
const T& value_of(const Dual<T, A...>& a) {
  return a.value;
}

}  // namespace octomarch
