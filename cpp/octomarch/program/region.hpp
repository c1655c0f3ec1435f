// A box of points, as the numbers that kernels compare with. The octree makes them, kernels march inside of them.
#pragma once

namespace octomarch {

/// All points with lo ≤ p ≤ hi; ends may be infinite.
template <class Real>
struct Region {
  Real lo[3];
  Real hi[3];
};

}  // namespace octomarch
