// The kernels for AVX2.
#define OCTOMARCH_ISA avx2
#define OCTOMARCH_ARCH xsimd::avx2
#include "octomarch/kernels/table.hpp"
