// What rays see that hit nothing: the sky's colour in their directions. Comes after compilation of the sky's expressions;
// radiance.hpp asks.
#pragma once

#include <optional>

#include "octomarch/kernels/dispatch.hpp"
#include "octomarch/render/point_expressions.hpp"

namespace octomarch {

template <class Real>
class SkyPass {
 public:
  /// `sky`: red, green, blue over the unit direction; must outlive this.
  SkyPass(const Expressions& sky, const kernels::KernelTable<Real>& kernels, std::size_t size);

  void clear() { ray_.clear(); }
  /// Notes that ray number `ray` looks along a unit direction.
  void add(std::size_t ray, Real dx, Real dy, Real dz);
  /// Finds the colours of all rays noted since clear().
  void run(const bool& cancelled, StageStats& stage);

  std::size_t count() const { return ray_.size(); }
  std::size_t ray(std::size_t i) const { return ray_[i]; }

  VectorBuffer<Real> color;  ///< ≥ 0

 private:
  const kernels::KernelTable<Real>& kernels_;
  VectorBuffer<Real> direction_;
  IndexList ray_;
  std::optional<PointExpressions<Real>> channels_;  ///< those that are not constant
};

}  // namespace octomarch
