// The kernels for AArch64.
#define OCTOMARCH_ISA neon
#define OCTOMARCH_ARCH xsimd::neon64
#include "octomarch/kernels/table.hpp"
