// Dual numbers in three variables: a value and its exact partial derivatives, carried through an operator's own
// formula (forward differentiation). The operators of ops/ are instantiated over Dual<lanes> to give normals.
//
// Where a function has no derivative, the result keeps the side that has one: abs takes +1 at 0, min and max take an
// operand whole, sqrt takes 0 at 0, and a quotient 0 where its divisor is. So no NaN arises, and a point exactly on a
// face still gets that face's normal. ops/dual_math.hpp has the transcendental functions.
#pragma once

#include <limits>

namespace octomarch {

/// What stands for a slope that is infinite or NaN: 0.
template <class T>
T finite_or_zero(const T& slope) {
  constexpr auto kLargest = std::numeric_limits<typename T::Real>::max();
  return select(abs(slope) <= T(kLargest), slope, T(0));
}

template <class T>
T inverse_or_zero(const T& a) {
  return finite_or_zero(T(1) / a);
}

/// `T`: a lane type. `value` is what the plain evaluation over T gives, but for the sign of a zero.
template <class T>
struct Dual {
  T value;
  T dx;
  T dy;
  T dz;

  friend Dual operator+(const Dual& a, const Dual& b) {
    return {a.value + b.value, a.dx + b.dx, a.dy + b.dy, a.dz + b.dz};
  }
  friend Dual operator-(const Dual& a, const Dual& b) {
    return {a.value - b.value, a.dx - b.dx, a.dy - b.dy, a.dz - b.dz};
  }
  friend Dual operator*(const Dual& a, const Dual& b) {
    return {a.value * b.value, a.value * b.dx + b.value * a.dx, a.value * b.dy + b.value * a.dy,
            a.value * b.dz + b.value * a.dz};
  }
  friend Dual operator-(const Dual& a) { return {-a.value, -a.dx, -a.dy, -a.dz}; }

  // Constants have no derivative, so mixed forms skip the work on it.
  friend Dual operator+(const Dual& a, const T& c) { return {a.value + c, a.dx, a.dy, a.dz}; }
  friend Dual operator-(const Dual& a, const T& c) { return {a.value - c, a.dx, a.dy, a.dz}; }
  friend Dual operator-(const T& c, const Dual& a) { return {c - a.value, -a.dx, -a.dy, -a.dz}; }
  friend Dual operator*(const Dual& a, const T& c) { return {a.value * c, a.dx * c, a.dy * c, a.dz * c}; }

  // (a/b)′ = (a′ − (a/b)·b′)/b.
  friend Dual operator/(const Dual& a, const Dual& b) {
    const T inverse = inverse_or_zero(b.value);
    const T quotient = a.value / b.value;
    const T slope = finite_or_zero(quotient);
    return {quotient, (a.dx - slope * b.dx) * inverse, (a.dy - slope * b.dy) * inverse,
            (a.dz - slope * b.dz) * inverse};
  }
  friend Dual operator/(const Dual& a, const T& c) {
    const T inverse = inverse_or_zero(c);
    return {a.value / c, a.dx * inverse, a.dy * inverse, a.dz * inverse};
  }
  friend Dual operator/(const T& c, const Dual& b) {
    const T quotient = c / b.value;
    const T slope = finite_or_zero(-quotient * inverse_or_zero(b.value));
    return {quotient, b.dx * slope, b.dy * slope, b.dz * slope};
  }
};

/// A constant as the number type T.
template <class T>
struct Lift {
  static T from(const T& c) { return c; }
};

template <class T>
struct Lift<Dual<T>> {
  static Dual<T> from(const T& c) { return {c, T(0), T(0), T(0)}; }
};

template <class T>
Dual<T> square(const Dual<T>& a) {
  const T twice = a.value + a.value;
  return {a.value * a.value, twice * a.dx, twice * a.dy, twice * a.dz};
}

template <class T>
Dual<T> sqrt(const Dual<T>& a) {
  const T root = sqrt(a.value);
  const T slope = select(root > T(0), T(0.5F) / root, T(0));
  return {root, a.dx * slope, a.dy * slope, a.dz * slope};
}

/// `mask ? a : b`, the derivatives with the value. `Mask`: the lane type's mask.
template <class Mask, class T>
Dual<T> select(const Mask& mask, const Dual<T>& a, const Dual<T>& b) {
  return {select(mask, a.value, b.value), select(mask, a.dx, b.dx), select(mask, a.dy, b.dy), select(mask, a.dz, b.dz)};
}

template <class T>
Dual<T> abs(const Dual<T>& a) {
  return select(a.value < T(0), -a, a);
}

template <class T>
Dual<T> min(const Dual<T>& a, const Dual<T>& b) {
  return select(a.value < b.value, a, b);
}

template <class T>
Dual<T> max(const Dual<T>& a, const Dual<T>& b) {
  return select(a.value > b.value, a, b);
}

template <class T>
Dual<T> min(const Dual<T>& a, const T& c) {
  const auto kept = a.value < c;
  return {select(kept, a.value, c), select(kept, a.dx, T(0)), select(kept, a.dy, T(0)), select(kept, a.dz, T(0))};
}

template <class T>
Dual<T> max(const Dual<T>& a, const T& c) {
  const auto kept = a.value > c;
  return {select(kept, a.value, c), select(kept, a.dx, T(0)), select(kept, a.dy, T(0)), select(kept, a.dz, T(0))};
}

/// Where a tie of two fields is to be decided for the first: where only it has a slope. A point on a sphere's surface
/// that is another's centre still gets the normal of the surface.
template <class T>
auto only_first_has_slope(const Dual<T>& a, const Dual<T>& b) {
  const T none = T(0);
  return (a.value == b.value) & (b.dx == none) & (b.dy == none) & (b.dz == none);
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
template <class T>
const T& value_of(const Dual<T>& a) {
  return a.value;
}

}  // namespace octomarch
