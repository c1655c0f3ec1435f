// The kernels for baseline of every x86-64.
#define OCTOMARCH_ISA sse2
#define OCTOMARCH_ARCH xsimd::sse2
#include "octomarch/kernels/table.hpp"
