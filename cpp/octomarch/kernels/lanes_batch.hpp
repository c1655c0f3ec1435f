// Lanes over an xsimd batch. See lanes.hpp.
#pragma once

#include <type_traits>

#include <xsimd/xsimd.hpp>

namespace octomarch::kernels::OCTOMARCH_ISA {

template <class Real>
struct Mask {
  using Native = xsimd::batch_bool<Real, OCTOMARCH_ARCH>;
  Native v;

  friend Mask operator&(const Mask& a, const Mask& b) { return {a.v & b.v}; }
  friend Mask operator|(const Mask& a, const Mask& b) { return {a.v | b.v}; }
  friend Mask operator!(const Mask& a) { return {!a.v}; }
  /// Bit i is lane i.
  std::uint64_t bits() const { return v.mask(); }
  /// Of the lowest bits; the others may be anything.
  static Mask from_bits(std::uint64_t bits) {
    constexpr std::uint64_t kAll = (std::uint64_t{1} << Native::size) - 1;
    return {Native::from_mask(bits & kAll)};
  }
};

/// The nearest float to a quotient or a root: xsimd approximates both where NEON has instructions for them.
template <class Batch>
Batch quotient(const Batch& a, const Batch& b) {
#ifdef __aarch64__
  if constexpr (std::is_same_v<typename Batch::value_type, float>) return vdivq_f32(a, b);
#endif
  return a / b;
}
template <class Batch>
Batch root(const Batch& a) {
#ifdef __aarch64__
  if constexpr (std::is_same_v<typename Batch::value_type, float>) return vsqrtq_f32(a);
#endif
  return xsimd::sqrt(a);
}

template <class RealType>
struct Lanes {
  using Real = RealType;
  using Native = xsimd::batch<Real, OCTOMARCH_ARCH>;
  using Integer = std::conditional_t<sizeof(Real) == 4, std::int32_t, std::int64_t>;
  using Bits = xsimd::batch<Integer, OCTOMARCH_ARCH>;
  static constexpr std::size_t kWidth = Native::size;
  Native v;

  Lanes() = default;
  Lanes(Real c) : v(c) {}
  Lanes(const Native& native) : v(native) {}

  static Lanes load(const Real* p) { return Native::load_aligned(p); }
  static Lanes load_unaligned(const Real* p) { return Native::load_unaligned(p); }
  void store(Real* p) const { v.store_aligned(p); }

  Bits bits() const { return xsimd::bitwise_cast<Integer>(v); }
  static Lanes from_bits(const Bits& bits) { return xsimd::bitwise_cast<Real>(bits); }

  friend Lanes operator+(const Lanes& a, const Lanes& b) { return a.v + b.v; }
  friend Lanes operator-(const Lanes& a, const Lanes& b) { return a.v - b.v; }
  friend Lanes operator*(const Lanes& a, const Lanes& b) { return a.v * b.v; }
  friend Lanes operator/(const Lanes& a, const Lanes& b) { return quotient(a.v, b.v); }
  /// The sign is turned, also of a zero: xsimd takes 0 − a on AVX-512, which leaves +0 as it is.
  friend Lanes operator-(const Lanes& a) { return a.v ^ Native(Real(-0.0)); }
  friend Mask<Real> operator<(const Lanes& a, const Lanes& b) { return {a.v < b.v}; }
  friend Mask<Real> operator<=(const Lanes& a, const Lanes& b) { return {a.v <= b.v}; }
  friend Mask<Real> operator>(const Lanes& a, const Lanes& b) { return {a.v > b.v}; }
  friend Mask<Real> operator>=(const Lanes& a, const Lanes& b) { return {a.v >= b.v}; }
  friend Mask<Real> operator==(const Lanes& a, const Lanes& b) { return {a.v == b.v}; }
};

template <class Real>
Lanes<Real> sqrt(const Lanes<Real>& a) {
  return root(a.v);
}

template <class Real>
Lanes<Real> abs(const Lanes<Real>& a) {
  return xsimd::abs(a.v);
}

template <class Real>
Lanes<Real> select(const Mask<Real>& mask, const Lanes<Real>& a, const Lanes<Real>& b) {
  return xsimd::select(mask.v, a.v, b.v);
}

/// `mask ? a : 0`.
template <class Real>
Lanes<Real> kept(const Mask<Real>& mask, const Lanes<Real>& a) {
#if defined(__SSE2__) && !defined(__AVX512F__)
  using Native = typename Lanes<Real>::Native;  // a select would take two instructions
  return Native(typename Native::register_type(mask.v)) & a.v;
#else
  return select(mask, a, Lanes<Real>(Real(0)));
#endif
}

#ifdef __SSE2__
// The x86 instructions mean exactly a < b ? a : b and a > b ? a : b.
static inline __m128 lesser(__m128 a, __m128 b) { return _mm_min_ps(a, b); }
static inline __m128d lesser(__m128d a, __m128d b) { return _mm_min_pd(a, b); }
static inline __m128 greater(__m128 a, __m128 b) { return _mm_max_ps(a, b); }
static inline __m128d greater(__m128d a, __m128d b) { return _mm_max_pd(a, b); }
#ifdef __AVX2__
static inline __m256 lesser(__m256 a, __m256 b) { return _mm256_min_ps(a, b); }
static inline __m256d lesser(__m256d a, __m256d b) { return _mm256_min_pd(a, b); }
static inline __m256 greater(__m256 a, __m256 b) { return _mm256_max_ps(a, b); }
static inline __m256d greater(__m256d a, __m256d b) { return _mm256_max_pd(a, b); }
#endif
#ifdef __AVX512F__
static inline __m512 lesser(__m512 a, __m512 b) { return _mm512_min_ps(a, b); }
static inline __m512d lesser(__m512d a, __m512d b) { return _mm512_min_pd(a, b); }
static inline __m512 greater(__m512 a, __m512 b) { return _mm512_max_ps(a, b); }
static inline __m512d greater(__m512d a, __m512d b) { return _mm512_max_pd(a, b); }
#endif
#else
template <class Register>
Register lesser(Register a, Register b) {
  using Batch = xsimd::batch<std::remove_cvref_t<decltype(a[0])>, OCTOMARCH_ARCH>;
  return xsimd::select(Batch(a) < Batch(b), Batch(a), Batch(b));
}
template <class Register>
Register greater(Register a, Register b) {
  using Batch = xsimd::batch<std::remove_cvref_t<decltype(a[0])>, OCTOMARCH_ARCH>;
  return xsimd::select(Batch(a) > Batch(b), Batch(a), Batch(b));
}
#endif

/// a < b ? a : b.
template <class Real>
Lanes<Real> min(const Lanes<Real>& a, const Lanes<Real>& b) {
  using Register = typename Lanes<Real>::Native::register_type;
  return typename Lanes<Real>::Native(lesser(Register(a.v), Register(b.v)));
}

/// a > b ? a : b.
template <class Real>
Lanes<Real> max(const Lanes<Real>& a, const Lanes<Real>& b) {
  using Register = typename Lanes<Real>::Native::register_type;
  return typename Lanes<Real>::Native(greater(Register(a.v), Register(b.v)));
}

/// Replaces the packet in one slot of a row by `from` (kPacketLanes numbers, any alignment). Rows are read in whole
/// batches, and a batch that is read soon after a part of it was written waits for memory: so where a batch is wider
/// than a packet, it is written whole.
template <class Real>
void put_packet(Real* row, std::size_t slot, const Real* from) {
#ifdef __AVX512DQ__
  if constexpr (Lanes<Real>::kWidth == 2 * kPacketLanes) {
    float* const batch = row + slot / 2 * (2 * kPacketLanes);
    const __m512 packet = _mm512_broadcast_f32x8(_mm256_loadu_ps(from));
    const __mmask16 half = slot % 2 == 0 ? 0x00FF : 0xFF00;
    _mm512_store_ps(batch, _mm512_mask_blend_ps(half, _mm512_load_ps(batch), packet));
    return;
  }
#endif
  __builtin_memcpy(row + slot * kPacketLanes, from, kPacketLanes * sizeof(Real));
}

/// Largest whole number ≤ a. SSE2 has no such instruction: there it is rounded by adding and taking away the number
/// whose last place is 1, then corrected; the result, −0 included, is the instruction's.
template <class Real>
Lanes<Real> floor(const Lanes<Real>& a) {
  if constexpr (std::is_same_v<OCTOMARCH_ARCH, xsimd::sse2>) {
    const Lanes<Real> ulp_is_one = std::numeric_limits<Real>::digits == 24 ? Real(0x1p23) : Real(0x1p52);
    const Lanes<Real> magnitude = abs(a);
    const Lanes<Real> nearest = (magnitude + ulp_is_one) - ulp_is_one;
    const Lanes<Real> with_sign = xsimd::copysign(nearest.v, a.v);
    const Lanes<Real> lower = select(with_sign > a, with_sign - Real(1), with_sign);
    return select(magnitude < ulp_is_one, lower, a);
  } else {
    return xsimd::floor(a.v);
  }
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
