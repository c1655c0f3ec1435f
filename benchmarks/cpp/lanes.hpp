// The operations that the hand-written fields and marches need, for one lane (float) and for an xsimd batch, in the
// namespace of the ISA they are compiled for, so that no two objects share a weak symbol. camera.hpp comes before it,
// scenes.hpp after it.
#pragma once

#include <cmath>

#include "camera.hpp"
#include <xsimd/xsimd.hpp>

#define OCTOMARCH_BENCH_INLINE [[gnu::always_inline]] inline

namespace octomarch_bench::OCTOMARCH_BENCH_ISA {

template <class A>
using Lanes = xsimd::batch<float, A>;

/// a < b ? a : b and a > b ? a : b, the engine's rule: one minps or maxps each.
OCTOMARCH_BENCH_INLINE float smaller(float a, float b) { return a < b ? a : b; }
OCTOMARCH_BENCH_INLINE float larger(float a, float b) { return a > b ? a : b; }

/// xsimd::min(a, b) is b < a ? b : a, hence the order of the arguments.
template <class A>
OCTOMARCH_BENCH_INLINE Lanes<A> smaller(const Lanes<A>& a, const Lanes<A>& b) {
  return xsimd::min(b, a);
}
template <class A>
OCTOMARCH_BENCH_INLINE Lanes<A> larger(const Lanes<A>& a, const Lanes<A>& b) {
  return xsimd::max(b, a);
}

OCTOMARCH_BENCH_INLINE float magnitude(float a) { return std::fabs(a); }
template <class A>
OCTOMARCH_BENCH_INLINE Lanes<A> magnitude(const Lanes<A>& a) {
  return xsimd::abs(a);
}

OCTOMARCH_BENCH_INLINE float root(float a) { return std::sqrt(a); }
template <class A>
OCTOMARCH_BENCH_INLINE Lanes<A> root(const Lanes<A>& a) {
  return xsimd::sqrt(a);
}

/// Without SSE4.1 std::floor is a call; rounding by conversion is faster there and right below 2³¹, far beyond t_max.
OCTOMARCH_BENCH_INLINE float round_down(float a) {
#if defined(__x86_64__) && !defined(__SSE4_1__)
  const float whole = static_cast<float>(static_cast<int>(a));
  return whole > a ? whole - 1.0f : whole;
#else
  return std::floor(a);
#endif
}
template <class A>
OCTOMARCH_BENCH_INLINE Lanes<A> round_down(const Lanes<A>& a) {
  return xsimd::floor(a);
}

template <class T>
struct Direction {
  T x, y, z;
};

/// Unit direction through the point (column, row) of the picture, in pixels from its upper left corner.
template <class T>
OCTOMARCH_BENCH_INLINE Direction<T> direction(const Frame& frame, const T& column, const T& row) {
  const T x = T(frame.corner[0]) + row * T(frame.down[0]) + column * T(frame.right[0]);
  const T y = T(frame.corner[1]) + row * T(frame.down[1]) + column * T(frame.right[1]);
  const T z = T(frame.corner[2]) + row * T(frame.down[2]) + column * T(frame.right[2]);
  const T scale = T(1.0f) / root(x * x + y * y + z * z);
  return {x * scale, y * scale, z * scale};
}

/// Centres of the pixels of a packet of kWidth × kHeight rays, in pixels from its upper left corner.
template <int kWidth, int kHeight>
struct PixelCentres {
  PixelCentres() {
    for (int ray = 0; ray < kWidth * kHeight; ++ray) {
      const int column = ray % kWidth;
      const int row = ray / kWidth;
      columns[ray] = static_cast<float>(column) + 0.5f;
      rows[ray] = static_cast<float>(row) + 0.5f;
    }
  }

  alignas(64) float columns[kWidth * kHeight];
  alignas(64) float rows[kWidth * kHeight];
};

}  // namespace octomarch_bench::OCTOMARCH_BENCH_ISA
