// A box of points, as the numbers that kernels compare with. The octree makes them, kernels march inside of them.
#pragma once

#include <limits>

namespace octomarch {

/// All points with lo ≤ p ≤ hi; ends may be infinite.
template <class Real>
struct Region {
  Real lo[3];
  Real hi[3];
};

template <class Real>
inline constexpr Region<Real> kAllPoints = {
    {-std::numeric_limits<Real>::infinity(), -std::numeric_limits<Real>::infinity(),
     -std::numeric_limits<Real>::infinity()},
    {std::numeric_limits<Real>::infinity(), std::numeric_limits<Real>::infinity(),
     std::numeric_limits<Real>::infinity()}};

template <class Real>
bool contains(const Region<Real>& region, Real x, Real y, Real z) {
  return x >= region.lo[0] && x <= region.hi[0] && y >= region.lo[1] && y <= region.hi[1] && z >= region.lo[2] &&
         z <= region.hi[2];
}

}  // namespace octomarch
