// The kernels for AVX-512 F, CD, DQ, BW, VL.
#define OCTOMARCH_ISA avx512
#define OCTOMARCH_ARCH xsimd::avx512bw
#include "octomarch/kernels/table.hpp"
