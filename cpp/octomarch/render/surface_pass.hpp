// What happens at the points that a batch of rays has found: position, normal, ids. Shared by pictures (tile.hpp) and
// by ray queries (query.hpp); shading comes after it.
#pragma once

#include <optional>
#include <vector>

#include "octomarch/graph/scene.hpp"
#include "octomarch/kernels/dispatch.hpp"
#include "octomarch/render/field.hpp"
#include "octomarch/render/point_expressions.hpp"
#include "octomarch/render/rays.hpp"

namespace octomarch {

/// Surface points of a batch, gathered so that no lane is spent on rays that found nothing.
template <class Real>
class SurfacePass {
 public:
  /// `field` must outlive this.
  SurfacePass(Field<Real>& field, const kernels::KernelTable<Real>& kernels, std::size_t size);

  /// Collects the rays whose status is kHit or kStepLimit.
  void gather(const RayBatch<Real>& batch, const RayColumns<Real>& rays, std::size_t count);
  /// Unit normals.
  void find_normals(const Shading& shading, const bool& cancelled, StageStats& stage);
  /// Object ids, from the attribute program.
  void find_objects(const bool& cancelled, StageStats& stage);

  std::size_t count() const { return ray_.size(); }
  /// Index in the batch of surface point i.
  std::size_t ray(std::size_t i) const { return ray_[i]; }
  /// Did the march find surface point i, or only a candidate?
  Status status(std::size_t i) const { return static_cast<Status>(status_[i]); }
  std::int32_t object(std::size_t i) const { return static_cast<std::int32_t>(object_[i]); }
  /// Is any surface point only a candidate?
  bool has_candidates() const { return has_candidates_; }
  /// Is surface point i a candidate whose surface faces away? Then the ray sees none. Normals must be known.
  bool is_nothing(std::size_t i) const {
    if (status(i) != Status::kStepLimit) return false;
    return normal.x[i] * direction.x[i] + normal.y[i] * direction.y[i] + normal.z[i] * direction.z[i] >= Real(0);
  }
  kernels::SurfaceView<Real> view();
  Field<Real>& field() const { return field_; }

  VectorBuffer<Real> position, direction, normal, facing, origin;
  Buffer<Real> epsilon;

 private:
  const Program& program_;
  const kernels::KernelTable<Real>& kernels_;
  IndexList ray_;
  Buffer<std::uint8_t> status_;
  bool has_candidates_ = false;
  Buffer<Real> object_;
  Field<Real>& field_;
  std::vector<Real> offsets_;  ///< of samples around a point, where normals are no gradients
  std::optional<PointExpressions<Real>> attributes_;
};

}  // namespace octomarch
