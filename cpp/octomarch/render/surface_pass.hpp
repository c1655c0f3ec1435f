// What happens at the points that a batch of rays has found: position, normal, ids. Shared by pictures (tile.hpp) and
// by ray queries (query.hpp); shading comes after it.
#pragma once

#include <vector>

#include "octomarch/graph/scene.hpp"
#include "octomarch/kernels/dispatch.hpp"
#include "octomarch/render/buffer.hpp"

namespace octomarch {

/// Rays and what the march made of them, `size` at the most; one of these per worker.
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
  Real epsilon_slope;

  static Real at(const kernels::Column<Real>& column, std::size_t i) {
    return column.values == nullptr ? column.value : column.values[i];
  }
};

/// Surface points of a batch, gathered so that no lane is spent on rays that found nothing.
template <class Real>
class SurfacePass {
 public:
  SurfacePass(const Program& program, const kernels::KernelTable<Real>& kernels, std::size_t size);

  /// Collects the rays whose status is kHit or kStepLimit. `epsilon`: absolute hit epsilon of each ray.
  void gather(const RayBatch<Real>& batch, const RayColumns<Real>& rays, const kernels::Column<Real>& epsilon,
              std::size_t count);
  /// Unit normals; returns evaluations made.
  std::uint64_t find_normals(const Shading& shading, const bool& cancelled);
  /// Object ids, from the attribute program; returns evaluations made.
  std::uint64_t find_objects(const bool& cancelled);

  std::size_t count() const { return ray_.size(); }
  /// Index in the batch of surface point i.
  std::size_t ray(std::size_t i) const { return ray_[i]; }
  /// Did the march find surface point i, or only a candidate?
  Status status(std::size_t i) const { return status_[i]; }
  std::int32_t object(std::size_t i) const { return static_cast<std::int32_t>(object_[i]); }
  kernels::SurfaceView<Real> view();
  Real* registers() { return registers_.data(); }

  VectorBuffer<Real> position, direction, normal, facing, origin;
  Buffer<Real> epsilon;

 private:
  const Program& program_;
  const kernels::KernelTable<Real>& kernels_;
  std::vector<std::size_t> ray_;
  std::vector<Status> status_;
  Buffer<Real> object_;
  Buffer<Real> registers_;
  Buffer<Real> gradient_registers_;
  Buffer<Real> attribute_registers_;
};

}  // namespace octomarch
