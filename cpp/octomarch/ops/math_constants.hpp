// What the functions of math.hpp are computed with: polynomials' coefficients, and constants in parts. Lanes only.
//
// Polynomials are minimax fits (Remez, 220 bits) made for this file, of the function and over the range that the comment
// names, to the relative error that it names. Coefficients were rounded from the lowest, and the others fitted again.
// Other constants are rounded from 300 digits.
//
// All of it is a template over the lane type, so that each ISA has its own symbols.
#pragma once

#include <cstdint>

namespace octomarch::ops {

/// Constants and coefficients, lowest first. A pair _hi + _lo has twice the digits; _short has half of them.
template <class T, class Real = typename T::Real>
struct MathConstants;

template <class T>
struct MathConstants<T, float> {
  // ln 2 without the digits that a whole exponent needs in a product; 1/ln 2 and ln 2 with 12 digits.
  static constexpr float kLn2Hi = 0x1.62e4p-1F, kLn2Lo = 0x1.7f7d1cp-20F;
  static constexpr float kLog2eShort = 0x1.716p+0F, kLog2eRest = -0x1.7135a8p-13F;
  static constexpr float kLn2Short = 0x1.62ep-1F, kLn2Rest = 0x1.0bfbe8p-15F;
  // 2/ln 2 and 2/(3·ln 2).
  static constexpr float kAtanh1Hi = 0x1.715476p+1F, kAtanh1Lo = 0x1.4ae0cp-25F;
  static constexpr float kAtanh3Hi = 0x1.ec709ep-1F, kAtanh3Lo = -0x1.e2fe02p-28F;
  // (exp(r) − 1 − r)/r² on |r| ≤ ln 2/2, to 2⁻²⁸ of exp; (2ᶠ − 1 − f·ln 2)/f² on |f| ≤ ½, to 2⁻²⁸ of 2ᶠ.
  static constexpr float kExp[] = {0x1.fffffcp-2F, 0x1.55548cp-3F, 0x1.55585cp-5F, 0x1.123df2p-7F, 0x1.6ac43p-10F};
  static constexpr float kExp2[] = {0x1.ebfbdcp-3F, 0x1.c6af84p-5F, 0x1.3b2db4p-7F, 0x1.5f06acp-10F, 0x1.41a036p-13F};
  // (2·atanh(s)/s − 2)/s² over s², s ≤ 0.1717, to 2⁻³⁵; the same in base 2 without its first two terms, to 2⁻³⁶.
  static constexpr float kLog[] = {0x1.555554p-1F, 0x1.999c28p-2F, 0x1.23d32p-2F, 0x1.f15cecp-3F};
  static constexpr float kPow[] = {0x1.27770ep-1F, 0x1.a5bbf2p-2F, 0x1.59ef54p-2F};
  // (sin(r)/r − 1)/r² and (cos(r) − 1 + r²/2)/r⁴ over r², |r| ≤ π/4, to 2⁻²⁸ and 2⁻³³.
  static constexpr float kSin[] = {-0x1.555546p-3F, 0x1.11077cp-7F, -0x1.9955acp-13F};
  static constexpr float kCos[] = {0x1.55554ap-5F, -0x1.6c0c18p-10F, 0x1.99dfeap-16F};
  // π/2 in four parts, of which the first three times kTurns are exact; and kFarTurns for the sum Hi + Lo + Least.
  static constexpr float kTurns = 4096, kFarTurns = 0x1p16F;
  static constexpr float kHalfPi[] = {0x1.922p+0F, -0x1.2aep-18F, -0x1.deap-31F, 0x1.184698p-44F};
  // (atan(t)/t − 1)/t² over t², |t| ≤ tan(π/8), to 2⁻³⁰; (asin(s)/s − 1)/s² over s², |s| ≤ ½, to 2⁻³⁰.
  static constexpr float kAtan[] = {-0x1.55554ap-2F, 0x1.9991e6p-3F, -0x1.23ba04p-3F, 0x1.b22a2cp-4F, -0x1.f3035ep-5F};
  static constexpr float kAsin[] = {0x1.55554cp-3F, 0x1.3338aep-4F, 0x1.6ca77cp-5F,
                                    0x1.04cceep-5F, 0x1.d57352p-7F, 0x1.34ccc6p-5F};
  // π/4 without the digits that a factor up to 4 needs.
  static constexpr float kQuarterPiHi = 0x1.922p-1F, kQuarterPiLo = -0x1.2aeef4p-19F;
  static constexpr float kHalfPiHi = 0x1.921fb6p+0F, kHalfPiLo = -0x1.777a5cp-25F, kHalfPiLeast = -0x1.ee59dap-50F;
};

template <class T>
struct MathConstants<T, double> {
  static constexpr double kLn2Hi = 0x1.62e42fefa4p-1, kLn2Lo = -0x1.8432a1b0e2634p-43;
  static constexpr double kLog2eShort = 0x1.7154768p+0, kLog2eRest = -0x1.6a3e80f444178p-27;
  static constexpr double kLn2Short = 0x1.62e43p-1, kLn2Rest = -0x1.05c610ca86c39p-29;
  static constexpr double kAtanh1Hi = 0x1.71547652b82fep+1, kAtanh1Lo = 0x1.777d0ffda0d24p-55;
  static constexpr double kAtanh3Hi = 0x1.ec709dc3a03fdp-1, kAtanh3Lo = 0x1.d27f05548af0cp-55;
  // To 2⁻⁵⁶ and 2⁻⁵⁸.
  static constexpr double kExp[] = {0x1.000000000000ap-1,  0x1.55555555554fap-3,  0x1.55555555508b1p-5,
                                    0x1.1111111127b6fp-7,  0x1.6c16c1842404ap-10, 0x1.a01a012a6dd17p-13,
                                    0x1.a0199a1279e87p-16, 0x1.71df25299280ap-19, 0x1.28ad74575b3dep-22,
                                    0x1.ad7fc0a45a0cep-26};
  static constexpr double kExp2[] = {0x1.ebfbdff82c5a1p-3,  0x1.c6b08d704a045p-5,  0x1.3b2ab6fba076cp-7,
                                     0x1.5d87fe78c38e2p-10, 0x1.4309130dd3a7fp-13, 0x1.ffcbfbc75f8c9p-17,
                                     0x1.62bfc9c4a0dd5p-20, 0x1.b5265353412ecp-24, 0x1.e6181bad4283ep-28,
                                     0x1.e7c6e8e03cab0p-32};
  // To 2⁻⁵⁹ and 2⁻⁶⁹.
  static constexpr double kLog[] = {0x1.5555555555592p-1, 0x1.999999997fddap-2, 0x1.24924941ff17ep-2,
                                    0x1.c71c51f4793bcp-3, 0x1.746644c568fd0p-3, 0x1.39a100eec3bb9p-3,
                                    0x1.2f0de55f03698p-3};
  static constexpr double kPow[] = {0x1.2776c50ef9bfep-1, 0x1.a61762a7ae1b4p-2, 0x1.484b13d78c684p-2,
                                    0x1.0c9a84b73050bp-2, 0x1.c68f42cb18c6cp-3, 0x1.89f78a4afccb6p-3,
                                    0x1.5b2cd0f1c0247p-3, 0x1.3d28df0d3abf2p-3, 0x1.03f0082d79adfp-3};
  // To 2⁻⁵⁸ and 2⁻⁶⁴.
  static constexpr double kSin[] = {-0x1.5555555555549p-3, 0x1.111111110f89ep-7,   -0x1.a01a019c14706p-13,
                                    0x1.71de35793db8fp-19, -0x1.ae5e66e468ac0p-26, 0x1.5d931393235dfp-33};
  static constexpr double kCos[] = {0x1.555555555554cp-5,   -0x1.6c16c16c15212p-10, 0x1.a01a019cbd1f2p-16,
                                    -0x1.27e4f8107e487p-22, 0x1.1ee9ef7d28867p-29,  -0x1.8fb01aa1fd319p-37};
  static constexpr double kTurns = 0x1p25, kFarTurns = 0x1p45;
  static constexpr double kHalfPi[] = {0x1.921fb54p+0, 0x1.10b4612p-30, -0x1.676733ap-60, -0x1.d1fc8f8cbb5bfp-89};
  // To 2⁻⁵⁹ and 2⁻⁵⁹.
  static constexpr double kAtan[] = {-0x1.555555555553ep-2, 0x1.9999999995a3bp-3,  -0x1.24924922b6f40p-3,
                                     0x1.c71c70e944700p-4,  -0x1.745cf92c848f2p-4, 0x1.3b111dfbeedc1p-4,
                                     -0x1.10ebe903dce31p-4, 0x1.df11bc81c0673p-5,  -0x1.9cdc70b26f74ep-5,
                                     0x1.37eb54dab7a4dp-5,  -0x1.2593fc80a1d60p-6};
  static constexpr double kAsin[] = {
      0x1.5555555555576p-3, 0x1.333333332e234p-4,  0x1.6db6db720e285p-5, 0x1.f1c71a9499a22p-6, 0x1.6e8bdf115ebe3p-6,
      0x1.1c49ead2aa7fep-6, 0x1.ca2039e9fbcd7p-7,  0x1.757efe0ac633dp-7, 0x1.616612a51ef97p-7, 0x1.e343c238b69fbp-9,
      0x1.647eb8570fca9p-6, -0x1.59524b1740b9fp-6, 0x1.0bb71118f0180p-5};
  static constexpr double kQuarterPiHi = 0x1.921fb54443p-1, kQuarterPiLo = -0x1.73dcb3b399d74p-44;
  static constexpr double kHalfPiHi = 0x1.921fb54442d18p+0, kHalfPiLo = 0x1.1a62633145c07p-54;
  static constexpr double kHalfPiLeast = -0x1.f1976b7ed8fbcp-110;
};

/// 2/π in words of 24 bits, or for float of 12, as numbers: the product of one with half the digits of a number is exact.
template <class T>
struct TwoOverPi {
  using Real = typename T::Real;
  static constexpr int kWordBits = sizeof(Real) == 4 ? 12 : 24;
  static constexpr int kCount = 49;

  struct Words {
    Real at[kCount];
  };

  static constexpr Words kWords = [] {
    constexpr std::uint32_t kBits[kCount] = {
        0xA2F983, 0x6E4E44, 0x1529FC, 0x2757D1, 0xF534DD, 0xC0DB62, 0x95993C, 0x439041, 0xFE5163, 0xABDEBB,
        0xC561B7, 0x246E3A, 0x424DD2, 0xE00649, 0x2EEA09, 0xD1921C, 0xFE1DEB, 0x1CB129, 0xA73EE8, 0x8235F5,
        0x2EBB44, 0x84E99C, 0x7026B4, 0x5F7E41, 0x3991D6, 0x398353, 0x39F49C, 0x845F8B, 0xBDF928, 0x3B1FF8,
        0x97FFDE, 0x05980F, 0xEF2F11, 0x8B5A0A, 0x6D1F6D, 0x367ECF, 0x27CB09, 0xB74F46, 0x3F669E, 0x5FEA2D,
        0x7527BA, 0xC7EBE5, 0xF17B3D, 0x0739F7, 0x8A5292, 0xEA6BFB, 0x5FB11F, 0x8D5D08, 0x560330};
    Words words = {};
    for (int i = 0; i < kCount; ++i) {
      const std::uint32_t half = kBits[i / 2] >> (i % 2 == 0 ? 12 : 0) & 0xFFF;
      words.at[i] = Real(sizeof(Real) == 4 ? half : kBits[i]);
    }
    return words;
  }();
};

}  // namespace octomarch::ops
