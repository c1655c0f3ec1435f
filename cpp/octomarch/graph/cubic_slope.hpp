// How steep the cubic interpolant of samples is. The grid's measures come before it.
#pragma once

#include "octomarch/graph/grid.hpp"

namespace octomarch {

/// No less than the largest |∇|, and but for noise no more than a hundredth above it. O(values).
double cubic_slope(const GridSamples& samples);

}  // namespace octomarch
