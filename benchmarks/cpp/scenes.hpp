// The two scenes as fields written by hand, one text over the number type: float for the scalar march, an xsimd batch
// for the SIMD ones. lanes.hpp comes before it; the marches come after it. benchmarks/scenes.py says the same in Python.
#pragma once

#include <type_traits>

#include "lanes.hpp"

namespace octomarch_bench::OCTOMARCH_BENCH_ISA {

/// Exact distance to a box about the origin, given half its size.
template <class T>
OCTOMARCH_BENCH_INLINE T box(const T& x, const T& y, const T& z, float half_x, float half_y, float half_z) {
  const T zero(0.0f);
  const T qx = magnitude(x) - T(half_x);
  const T qy = magnitude(y) - T(half_y);
  const T qz = magnitude(z) - T(half_z);
  const T ox = larger(qx, zero);
  const T oy = larger(qy, zero);
  const T oz = larger(qz, zero);
  return root(ox * ox + oy * oy + oz * oz) + smaller(larger(qx, larger(qy, qz)), zero);
}

/// Offset from the centre of the nearest cell of an endless repetition.
template <class T>
OCTOMARCH_BENCH_INLINE T repeated(const T& x, float period) {
  return x - T(period) * round_down(x * T(1.0f / period) + T(0.5f));
}

/// min(a, b) − max(k − |a − b|, 0)²/(4k). One ray at a time, a branch around the blend is faster (about 5 % of scene A).
template <class T>
OCTOMARCH_BENCH_INLINE T smooth_union(const T& a, const T& b, float k) {
  if constexpr (std::is_same_v<T, float>) {
    const float overlap = k - magnitude(a - b);
    return overlap > 0.0f ? smaller(a, b) - overlap * overlap * (1.0f / (4.0f * k)) : smaller(a, b);
  } else {
    const T overlap = larger(T(k) - magnitude(a - b), T(0.0f));
    return smaller(a, b) - overlap * overlap * T(1.0f / (4.0f * k));
  }
}

/// A sphere and a box smoothly united, on a floor.
struct SceneA {
  template <class T>
  OCTOMARCH_BENCH_INLINE static T field(const T& x, const T& y, const T& z) {
    const T ball = root(x * x + y * y + z * z) - T(1.0f);
    const T cube = box(x - T(0.9f), y - T(0.3f), z, 0.75f, 0.75f, 0.75f);
    return smaller(smooth_union(ball, cube, 0.25f), y + T(1.0f));
  }
};

/// A tower minus repeated windows minus a shaft, on a floor.
struct SceneB {
  template <class T>
  OCTOMARCH_BENCH_INLINE static T field(const T& x, const T& y, const T& z) {
    const T tower = box(x, y, z, 2.0f, 6.0f, 2.0f);
    const T window = box(repeated(x, 1.0f), repeated(y, 1.5f), repeated(z, 1.0f), 0.3f, 0.4f, 0.3f);
    const T shaft = root(x * x + z * z) - T(1.2f);
    return smaller(larger(larger(tower, -window), -shaft), y + T(6.0f));
  }
};

/// Scene A, the box left out where the floor is nearer than anything of the blend can be: the box lies within 2.25 of
/// the origin and the blend takes off at most k/4. The value is the same.
struct SceneASkipping {
  OCTOMARCH_BENCH_INLINE static float field(float x, float y, float z) {
    const float floor = y + 1.0f;
    const float radius = root(x * x + y * y + z * z);
    if (floor <= radius - 2.3125f) return floor;
    const float cube = box(x - 0.9f, y - 0.3f, z, 0.75f, 0.75f, 0.75f);
    return smaller(smooth_union(radius - 1.0f, cube, 0.25f), floor);
  }
};

/// Scene B, windows and shaft left out where they cannot decide: taken away, they are worth 0.3 and 1.2 at the most.
struct SceneBSkipping {
  OCTOMARCH_BENCH_INLINE static float field(float x, float y, float z) {
    const float floor = y + 6.0f;
    const float tower = box(x, y, z, 2.0f, 6.0f, 2.0f);
    if (tower >= 1.2f || floor <= tower) return smaller(tower, floor);
    float building = larger(tower, 1.2f - root(x * x + z * z));
    if (building < 0.3f) {
      building = larger(building, -box(repeated(x, 1.0f), repeated(y, 1.5f), repeated(z, 1.0f), 0.3f, 0.4f, 0.3f));
    }
    return smaller(building, floor);
  }
};

}  // namespace octomarch_bench::OCTOMARCH_BENCH_ISA
