// Distance, gradient and raycast over many points or rays, one after the other: the reference as callers outside see it,
// without GLM. The bindings come after it.
#pragma once

#include <cstdint>
#include <span>

#include "octomarch/graph/node.hpp"
#include "octomarch/graph/scene.hpp"
#include "octomarch/reference/compiled.hpp"
#include "octomarch/reference/poll.hpp"

namespace octomarch::reference {

/// Field values at `points` (n × 3), in T = float or double, counted from `anchor` first. Contract: `values` holds n.
template <class T>
void distance(const NodePtr& root, const Vec3& anchor, std::span<const double> points, std::span<T> values,
              const Poll& poll);

/// Gradients at `points` (n × 3). Contract: `gradients` holds n × 3.
template <class T>
void gradient(const NodePtr& root, const Vec3& anchor, std::span<const double> points, std::span<T> gradients,
              const Poll& poll);

/// Where the results of n rays go. t is in lengths of the given directions, +inf on a miss and for invalid rays; position,
/// normal and material are 0, 0 and −1 where there is no surface.
template <class T>
struct Hits {
  std::span<T> t;                       ///< n
  std::span<T> position;                ///< n × 3
  std::span<T> normal;                  ///< n × 3
  std::span<std::int32_t> material_id;  ///< n
  std::span<std::int32_t> steps;        ///< n
  std::span<std::uint8_t> status;       ///< n, values of Status
};

/// Rays from `origins` along `directions` (n × 3 each), to the smaller of march.max_distance and `t_max`, which counts
/// in lengths of the directions. `shading` says how normals are found.
template <class T>
void raycast(const NodePtr& root, std::span<const double> origins, std::span<const double> directions,
             const March& march, const Shading& shading, double t_max, const Compiled& compiled, const Hits<T>& hits,
             const Poll& poll);

}  // namespace octomarch::reference
