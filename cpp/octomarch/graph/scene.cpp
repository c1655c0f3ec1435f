// The one formula that pictures share whoever draws them: how rough a material's highlight is. Scene data come before
// it; the renderer and the scalar reference come after.
#include "octomarch/graph/scene.hpp"

#include <algorithm>

namespace octomarch {

double phong_exponent(double roughness) {
  const double alpha = roughness * roughness;
  return std::clamp(2.0 / (alpha * alpha) - 2.0, 1.0, 8192.0);
}

}  // namespace octomarch
