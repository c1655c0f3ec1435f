// Operations of expressions: arithmetic, functions, comparisons. Each is one instruction over a whole block; an operand
// that is a constant has a form of its own where that is common. Truth values are 1 and 0.
#pragma once

#include "octomarch/ops/csg.hpp"
#include "octomarch/ops/dual_math.hpp"
#include "octomarch/ops/math.hpp"

namespace octomarch::ops {

/// The same value everywhere. Constants: the value.
template <class C>
struct Constant {
  C value;
  template <class Real>
  explicit Constant(const Real* p) : value(p[0]) {}

  C operator()() const { return value; }
};

/// An operation on one number and a constant.
template <class C>
struct OneConstant {
  C constant;
  template <class Real>
  explicit OneConstant(const Real* p) : constant(p[0]) {}
};

#define OCTOMARCH_UNARY(Name, result) \
  template <class C>                  \
  struct Name : NoConstants {         \
    using NoConstants::NoConstants;   \
    template <class T>                \
    T operator()(const T& a) const {  \
      return result;                  \
    }                                 \
  };
#define OCTOMARCH_BINARY(Name, result)           \
  template <class C>                             \
  struct Name : NoConstants {                    \
    using NoConstants::NoConstants;              \
    template <class T>                           \
    T operator()(const T& a, const T& b) const { \
      return result;                             \
    }                                            \
  };
#define OCTOMARCH_WITH_CONSTANT(Name, result) \
  template <class C>                          \
  struct Name : OneConstant<C> {              \
    using OneConstant<C>::OneConstant;        \
    template <class T>                        \
    T operator()(const T& a) const {          \
      const C& c = this->constant;            \
      return result;                          \
    }                                         \
  };

OCTOMARCH_BINARY(Add, a + b)
OCTOMARCH_BINARY(Subtract, a - b)
OCTOMARCH_BINARY(Multiply, a* b)
OCTOMARCH_BINARY(Divide, a / b)
OCTOMARCH_BINARY(Modulo, mod(a, b))
OCTOMARCH_BINARY(Power, pow(a, b))
OCTOMARCH_BINARY(ArcTangent2, atan2(a, b))
OCTOMARCH_WITH_CONSTANT(AddConstant, a + c)
OCTOMARCH_WITH_CONSTANT(SubtractFrom, c - a)
OCTOMARCH_WITH_CONSTANT(MultiplyConstant, a* c)
OCTOMARCH_WITH_CONSTANT(DivideConstant, a / c)
OCTOMARCH_WITH_CONSTANT(DivideInto, c / a)
OCTOMARCH_WITH_CONSTANT(MinimumConstant, min(a, c))
OCTOMARCH_WITH_CONSTANT(MaximumConstant, max(a, c))
OCTOMARCH_UNARY(Absolute, abs(a))
OCTOMARCH_UNARY(SquareRoot, sqrt(a))
OCTOMARCH_UNARY(Floor, floor(a))
OCTOMARCH_UNARY(Exponential, exp(a))
OCTOMARCH_UNARY(Logarithm, log(a))
OCTOMARCH_UNARY(Sine, sin(a))
OCTOMARCH_UNARY(Cosine, cos(a))
OCTOMARCH_UNARY(Tangent, tan(a))
OCTOMARCH_UNARY(ArcSine, asin(a))
OCTOMARCH_UNARY(ArcCosine, acos(a))
OCTOMARCH_UNARY(ArcTangent, atan(a))

#undef OCTOMARCH_UNARY
#undef OCTOMARCH_BINARY
#undef OCTOMARCH_WITH_CONSTANT

template <class C>
struct Less : NoConstants {
  using NoConstants::NoConstants;
  template <class T>
  T operator()(const T& a, const T& b) const {
    return Lift<T>::from(select(value_of(a) < value_of(b), C(1), C(0)));
  }
};

template <class C>
struct LessEqual : NoConstants {
  using NoConstants::NoConstants;
  template <class T>
  T operator()(const T& a, const T& b) const {
    return Lift<T>::from(select(value_of(a) <= value_of(b), C(1), C(0)));
  }
};

/// condition ? a : b.
template <class C>
struct Where : NoConstants {
  using NoConstants::NoConstants;
  template <class T>
  T operator()(const T& condition, const T& a, const T& b) const {
    return select(value_of(condition) == C(0), b, a);
  }
};

/// Inside where the condition holds. There is no distance: the smallest normal float stands for "somewhere outside".
template <class C>
struct Solid : NoConstants {
  using NoConstants::NoConstants;
  template <class T>
  T operator()(const T& condition) const {
    const C outside = C(0x1p-126F);
    return Lift<T>::from(select(value_of(condition) == C(0), outside, -outside));
  }
};

}  // namespace octomarch::ops
