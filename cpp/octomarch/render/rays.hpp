// Rays in the memory of a worker, and how they are marched: the settings of a picture or a query as kernels take them.
// Comes before every stage that casts rays.
#pragma once

#include <cmath>

#include "octomarch/graph/scene.hpp"
#include "octomarch/kernels/dispatch.hpp"
#include "octomarch/program/program.hpp"
#include "octomarch/render/buffer.hpp"

namespace octomarch {

/// Rays and what the march made of them, `size` at the most.
template <class Real>
struct RayBatch {
  explicit RayBatch(std::size_t size)
      : origin(size), direction(size), t(size), unfinished(size), status(size), steps(size) {}

  VectorBuffer<Real> origin;     ///< not used where all rays share one
  VectorBuffer<Real> direction;  ///< likewise
  Buffer<Real> t;
  Buffer<Real> unfinished;
  Buffer<std::uint8_t> status;
  Buffer<std::int32_t> steps;
};

/// Origin and direction columns of a batch, and the hit epsilon's two parts.
template <class Real>
struct RayColumns {
  kernels::Column<Real> ox, oy, oz;
  kernels::Column<Real> dx, dy, dz;
  kernels::Column<Real> epsilon;  ///< absolute
  Real epsilon_slope;

  static Real at(const kernels::Column<Real>& column, std::size_t i) {
    return column.values == nullptr ? column.value : column.values[i];
  }

  kernels::RayView<Real> view(const kernels::Column<Real>& t_max, std::size_t count) const {
    return {ox, oy, oz, dx, dy, dz, t_max, epsilon, count};
  }
};

/// Columns of rays that each have an origin, a direction and an epsilon of their own, without a pixel's footprint.
template <class Real>
RayColumns<Real> own_columns(const VectorBuffer<Real>& origin, const VectorBuffer<Real>& direction,
                             const Buffer<Real>& epsilon) {
  const auto column = [](const Buffer<Real>& values) { return kernels::Column<Real>{values.data(), 0}; };
  return {column(origin.x),    column(origin.y),    column(origin.z), column(direction.x),
          column(direction.y), column(direction.z), column(epsilon),  kUlpFloor<Real>};
}

/// Absolute parts of the hit epsilons of rays that have no pixel.
template <class Real>
void set_epsilons(const March& march, const VectorBuffer<Real>& origin, std::size_t count, Buffer<Real>& epsilon) {
  const Real least = clamped<Real>(march.least_epsilon());
  for (std::size_t i = 0; i < count; ++i) {
    const Real farthest = std::max({std::fabs(origin.x[i]), std::fabs(origin.y[i]), std::fabs(origin.z[i])});
    epsilon[i] = std::max(least, kUlpFloor<Real> * farthest);
  }
}

template <class Real>
kernels::MarchParameters<Real> march_parameters(const Program& program, const March& march, Real epsilon_slope,
                                                const bool& cancelled) {
  const bool plain = march.min_distance == 0.0 && march.bias == 0.0;
  kernels::Stepping stepping = plain ? kernels::Stepping::kPlain : kernels::Stepping::kBiased;
  if (march.method == Method::kFixed) stepping = kernels::Stepping::kFixed;
  return {static_cast<Real>(1.0 / program.lipschitz()),
          epsilon_slope,
          march.max_steps,
          march.finish,
          &cancelled,
          stepping,
          clamped<Real>(march.min_distance),
          clamped<Real>(march.bias),
          clamped<Real>(march.step)};
}

/// The same for rays that leave a surface, and begin there.
template <class Real>
kernels::MarchParameters<Real> secondary_parameters(const Program& program, March march, Real epsilon_slope,
                                                    const bool& cancelled) {
  march.min_distance = 0.0;
  return march_parameters(program, march, epsilon_slope, cancelled);
}

}  // namespace octomarch
