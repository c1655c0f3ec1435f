// The kernels at one lane: the same templates, for comparison and for machines without any of the others.
#define OCTOMARCH_ISA scalar
#include "octomarch/kernels/table.hpp"
