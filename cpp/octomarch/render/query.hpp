// Questions about a program at given points and along given rays, over arrays of any length and all cores. Comes after
// kernels and surface_pass.hpp; the bindings hand it numpy's memory.
#pragma once

#include <cstdint>

#include "octomarch/base/parallel.hpp"
#include "octomarch/graph/scene.hpp"
#include "octomarch/kernels/dispatch.hpp"
#include "octomarch/program/program.hpp"

namespace octomarch {

/// How a query runs.
struct Execution {
  const kernels::Isa* isa;
  unsigned threads;  ///< 0 = all cores
  Listener listener;
};

/// Signed distances at `count` points (x y z, x y z, …); NaN at NaN points.
template <class Real>
void query_distance(const Program& program, const double* points, std::size_t count, Real* out, const Execution& how);

/// Exact gradients (count × 3), not normalised; NaN at NaN points.
template <class Real>
void query_gradient(const Program& program, const double* points, std::size_t count, Real* out, const Execution& how);

/// What is at points whose unit normals are given (both x y z, x y z, …): the slots of Material, as shading clamps them
/// (count × Material::kSlots).
template <class Real>
void query_material(const Program& program, const double* points, const double* normals, std::size_t count, Real* out,
                    const Execution& how);

/// Arrays to fill, `count` long (vectors: × 3); null for one that is not wanted. `t` is always filled.
template <class Real>
struct Hits {
  Real* t;
  Real* position = nullptr;
  Real* normal = nullptr;
  std::int32_t* object_id = nullptr;
  std::int32_t* material_id = nullptr;
  std::int32_t* steps = nullptr;
  std::uint8_t* status = nullptr;
};

/// First hits along rays. Directions need not be unit: they are normalised in double, and t and `t_max` count in their
/// length; `march`'s distances and epsilon are in scene units. `shading` says how normals are found.
template <class Real>
void query_rays(const Program& program, const double* origins, const double* directions, std::size_t count,
                const March& march, const Shading& shading, double t_max, const Hits<Real>& out, const Execution& how);

}  // namespace octomarch
