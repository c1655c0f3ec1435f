// Lanes of width one: the same kernels, one number at a time. See lanes.hpp.
#pragma once

#include <type_traits>

namespace octomarch::kernels::OCTOMARCH_ISA {

template <class Real>
struct Mask {
  bool v;

  friend Mask operator&(const Mask& a, const Mask& b) { return {a.v && b.v}; }
  friend Mask operator|(const Mask& a, const Mask& b) { return {a.v || b.v}; }
  friend Mask operator!(const Mask& a) { return {!a.v}; }
  std::uint64_t bits() const { return v ? 1 : 0; }
  static Mask from_bits(std::uint64_t bits) { return {(bits & 1U) != 0}; }
};

template <class RealType>
struct Lanes {
  using Real = RealType;
  using Integer = std::conditional_t<sizeof(Real) == 4, std::int32_t, std::int64_t>;
  using Bits = Integer;
  static constexpr std::size_t kWidth = 1;
  Real v;

  Lanes() = default;
  Lanes(Real c) : v(c) {}

  static Lanes load(const Real* p) { return *p; }
  static Lanes load_unaligned(const Real* p) { return *p; }
  void store(Real* p) const { *p = v; }

  Bits bits() const { return __builtin_bit_cast(Bits, v); }
  static Lanes from_bits(const Bits& bits) { return __builtin_bit_cast(Real, bits); }

  friend Lanes operator+(const Lanes& a, const Lanes& b) { return a.v + b.v; }
  friend Lanes operator-(const Lanes& a, const Lanes& b) { return a.v - b.v; }
  friend Lanes operator*(const Lanes& a, const Lanes& b) { return a.v * b.v; }
  friend Lanes operator/(const Lanes& a, const Lanes& b) { return a.v / b.v; }
  friend Lanes operator-(const Lanes& a) { return -a.v; }
  friend Mask<Real> operator<(const Lanes& a, const Lanes& b) { return {a.v < b.v}; }
  friend Mask<Real> operator<=(const Lanes& a, const Lanes& b) { return {a.v <= b.v}; }
  friend Mask<Real> operator>(const Lanes& a, const Lanes& b) { return {a.v > b.v}; }
  friend Mask<Real> operator>=(const Lanes& a, const Lanes& b) { return {a.v >= b.v}; }
  friend Mask<Real> operator==(const Lanes& a, const Lanes& b) { return {a.v == b.v}; }
};

template <class Real>
Lanes<Real> sqrt(const Lanes<Real>& a) {
  if constexpr (sizeof(Real) == 4) return __builtin_sqrtf(a.v);
  return static_cast<Real>(__builtin_sqrt(a.v));
}

template <class Real>
Lanes<Real> abs(const Lanes<Real>& a) {
  if constexpr (sizeof(Real) == 4) return __builtin_fabsf(a.v);
  return static_cast<Real>(__builtin_fabs(a.v));
}

template <class Real>
Lanes<Real> floor(const Lanes<Real>& a) {
  if constexpr (sizeof(Real) == 4) return __builtin_floorf(a.v);
  return static_cast<Real>(__builtin_floor(a.v));
}

/// Replaces the packet in one slot of a row by `from`.
template <class Real>
void put_packet(Real* row, std::size_t slot, const Real* from) {
  __builtin_memcpy(row + slot * kPacketLanes, from, kPacketLanes * sizeof(Real));
}

template <class Real>
Lanes<Real> select(const Mask<Real>& mask, const Lanes<Real>& a, const Lanes<Real>& b) {
  return mask.v ? a : b;
}

/// `mask ? a : 0`.
template <class Real>
Lanes<Real> kept(const Mask<Real>& mask, const Lanes<Real>& a) {
  return mask.v ? a : Lanes<Real>(Real(0));
}

template <class Real>
Lanes<Real> min(const Lanes<Real>& a, const Lanes<Real>& b) {
  return a.v < b.v ? a : b;
}

template <class Real>
Lanes<Real> max(const Lanes<Real>& a, const Lanes<Real>& b) {
  return a.v > b.v ? a : b;
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
