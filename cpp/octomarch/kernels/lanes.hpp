// Lanes: the number type that kernels compute in, one xsimd batch of the ISA at hand (or a single number in the
// one-lane build). Every operation here is exact or correctly rounded on every ISA, which is what makes results equal
// bit for bit: so no fused multiply-add, no reciprocal estimates, and minima with the one meaning a < b ? a : b, which
// xsimd has changed between versions.
//
// Included by isa_*.cpp only, after OCTOMARCH_ISA (the namespace) and, for batches, OCTOMARCH_ARCH (xsimd's tag) are
// defined: all names live in a namespace of their own per ISA, so that no symbol of one can be linked into another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

#include "octomarch/kernels/block.hpp"

#ifdef OCTOMARCH_ARCH
#include "octomarch/kernels/lanes_batch.hpp"
#else
#include "octomarch/kernels/lanes_one.hpp"
#endif

namespace octomarch::kernels::OCTOMARCH_ISA {

template <class Real>
Lanes<Real> square(const Lanes<Real>& a) {
  return a * a;
}

/// Plain lanes are what comparisons look at; a Dual has an overload of its own.
template <class Real>
const Lanes<Real>& value_of(const Lanes<Real>& a) {
  return a;
}

template <class Real>
inline constexpr std::size_t kWidth = Lanes<Real>::kWidth;

/// Reads a flag that another thread may be setting.
inline bool is_set(const bool* flag) { return __atomic_load_n(flag, __ATOMIC_RELAXED); }

/// Batches that `lanes` lanes take.
template <class Real>
constexpr std::size_t batches(std::size_t lanes) {
  return (lanes + kWidth<Real> - 1) / kWidth<Real>;
}

/// Calls f(first lane) for `count` batches of a block; a whole block by code without a loop count.
template <class Real, class Function>
[[gnu::always_inline]] inline void for_each_batch(std::size_t count, Function&& f) {
  if (count == batches<Real>(kLanes)) {
#pragma GCC unroll 4
    for (std::size_t lane = 0; lane < kLanes; lane += kWidth<Real>) f(lane);
  } else {
    for (std::size_t lane = 0; lane < count * kWidth<Real>; lane += kWidth<Real>) f(lane);
  }
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
