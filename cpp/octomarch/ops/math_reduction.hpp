// Angles brought into ±π/4, for the sine, cosine and tangent of math.hpp: accurately, however large they are. Lanes only.
#pragma once

#include "octomarch/ops/math_constants.hpp"
#include "octomarch/ops/math_parts.hpp"

namespace octomarch::ops {

/// An angle less a multiple of π/2: r + r_lo within ±π/4 (a little more), and the multiple in the lowest bits.
template <class T>
struct Reduced {
  T r;
  T r_lo;
  typename T::Bits quadrant;
};

/// Reduction after Payne and Hanek (1983) for finite |x| of any size: of the products of x with 2/π, only those words
/// that reach below 4 are looked at. Rare, so kept out of the way.
template <class T>
[[gnu::noinline]] Reduced<T> reduce_huge(const T& x) {
  using Real = typename T::Real;
  using Integer = typename T::Integer;
  using C = MathConstants<T>;
  using I = Ieee<Real>;
  constexpr Integer kMantissa = (Integer(1) << I::kMantissaBits) - 1;
  constexpr int kWordBits = TwoOverPi<T>::kWordBits;
  constexpr int kWindow = 9;
  constexpr int kStarts = (I::kBias - I::kMantissaBits - 2) / kWordBits + 1;
  constexpr Real kWordUnit = Real(1) / Real(1 << kWordBits);

  // |x| = m·2ᵉ with a whole m; word i of 2/π counts in units of 2^(−kWordBits·(i + 1)).
  const typename T::Bits bits = abs(x).bits();
  const T m = T::from_bits((bits & typename T::Bits(kMantissa)) | T(I::kUlpIsOne).bits());
  const T e = T::from_bits((bits >> I::kMantissaBits) | T(I::kUlpIsOne).bits()) -
              T(I::kUlpIsOne + Real(I::kBias + I::kMantissaBits));
  const T start = max(T(Real(0)), floor((e - T(Real(1.5))) * T(Real(1) / Real(kWordBits))));
  T window[kWindow];
  for (T& word : window) word = T(Real(0));
  for (int i = 0; i < kStarts; ++i) {
    const auto here = start == T(Real(i));
    for (int k = 0; k < kWindow; ++k) window[k] = select(here, T(TwoOverPi<T>::kWords.at[i + k]), window[k]);
  }

  // The products, largest first, each without the multiples of 4; what is summed stays within ±½ and exact enough.
  T unit = power_of_two(e - (start + T(Real(1))) * T(Real(kWordBits)));
  const T m_hi = upper_half(m);
  const T halves[] = {m_hi, m - m_hi};
  T whole = T(Real(0));
  Pair<T> rest = {T(Real(0)), T(Real(0))};
  for (const T& word : window) {
    for (const T& half : halves) {
      const T product = half * word * unit;
      const T within = product - floor(product * T(Real(0.25)) + T(Real(0.5))) * T(Real(4));
      const Pair<T> sum = exact_sum(rest.hi, within);
      const T n = nearest(sum.hi);
      whole = whole + n;
      rest = ordered_sum(sum.hi - n, rest.lo + sum.lo);
    }
    unit = unit * T(kWordUnit);
  }
  const Pair<T> r = exact_product(rest.hi, T(C::kHalfPiHi));
  const T r_lo = r.lo + (rest.hi * T(C::kHalfPiLo) + rest.lo * T(C::kHalfPiHi));
  return {with_sign_of(r.hi, x), with_sign_of(r_lo, x), (with_sign_of(whole, x) + T(I::kMagic)).bits()};
}

/// Nearest multiple of π/2: as a number, and added to kMagic, which holds it in the lowest bits.
template <class T>
struct Turns {
  T count;
  typename T::Bits bits;
};

template <class T>
[[gnu::always_inline]] inline Turns<T> nearest_turns(const T& x) {
  using I = Ieee<typename T::Real>;
  const T shifted = x * T(typename T::Real(0.6366197723675814)) + T(I::kMagic);
  return {shifted - T(I::kMagic), shifted.bits()};
}

template <class T>
[[gnu::always_inline]] inline auto beyond_turns(const T& x, typename T::Real turns) {
  using Real = typename T::Real;
  return (abs(x) > T(turns * Real(1.57))) & (abs(x) <= T(Ieee<Real>::kLargest));
}

template <class Mask, class T>
[[gnu::always_inline]] inline Reduced<T> select(const Mask& mask, const Reduced<T>& a, const Reduced<T>& b) {
  return {select(mask, a.r, b.r), select(mask, a.r_lo, b.r_lo),
          select(mask, T::from_bits(a.quadrant), T::from_bits(b.quadrant)).bits()};
}

/// Reduction with exact products for up to kFarTurns quarter turns; beyond, after Payne and Hanek.
template <class T>
[[gnu::noinline]] Reduced<T> reduce_far(const T& x) {
  using C = MathConstants<T>;
  const Turns<T> turns = nearest_turns(x);
  const Pair<T> most = exact_product(turns.count, T(C::kHalfPiHi));
  const Pair<T> more = exact_product(turns.count, T(C::kHalfPiLo));
  const Pair<T> first = exact_sum(x - most.hi, -most.lo);
  const Pair<T> second = exact_sum(first.hi, -more.hi);
  const T least = ((first.lo + second.lo) - more.lo) - turns.count * T(C::kHalfPiLeast);
  const Pair<T> sum = exact_sum(second.hi, least);
  const Reduced<T> result = {sum.hi, sum.lo, turns.bits};
  const auto huge = beyond_turns(x, C::kFarTurns);
  return huge.bits() == 0 ? result : select(huge, reduce_huge(x), result);
}

/// Reduction after Cody and Waite, with π/2 in four parts, for up to kTurns quarter turns; beyond, the one above.
template <class T>
[[gnu::always_inline]] inline Reduced<T> reduce(const T& x) {
  using C = MathConstants<T>;
  const Turns<T> turns = nearest_turns(x);
  const T first = x - turns.count * T(C::kHalfPi[0]);
  const Pair<T> second = ordered_sum(first, turns.count * T(-C::kHalfPi[1]));
  const Pair<T> third = ordered_sum(second.hi, turns.count * T(-C::kHalfPi[2]));
  const Reduced<T> result = {third.hi, (second.lo + third.lo) - turns.count * T(C::kHalfPi[3]), turns.bits};
  const auto far = beyond_turns(x, C::kTurns);
  return far.bits() == 0 ? result : select(far, reduce_far(x), result);
}

}  // namespace octomarch::ops
