// A number with its slope in space. Vectors come before it; expressions and primitives give one at a point.
#pragma once

#include "octomarch/reference/vector.hpp"

namespace octomarch::reference {

/// A value at a point and its gradient there. Where there is no gradient it is that of a side, or zero.
template <class T>
struct Jet {
  T value = T(0);
  Vector<T> gradient = Vector<T>(0);
};

/// slope · gradient, zero where either is: an infinite slope of something constant is none.
template <class T>
Vector<T> along(T slope, const Vector<T>& gradient) {
  return slope == T(0) || gradient == Vector<T>(0) ? Vector<T>(0) : gradient * slope;
}

}  // namespace octomarch::reference
