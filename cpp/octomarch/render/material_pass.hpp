// What surface points are made of: the slots of their material, from the program's third tape where they differ from point
// to point. Comes after surface_pass.hpp; illumination.hpp and radiance.hpp read it.
#pragma once

#include <optional>
#include <vector>

#include "octomarch/render/point_expressions.hpp"
#include "octomarch/render/surface_pass.hpp"

namespace octomarch {

template <class Real>
class MaterialPass {
 public:
  MaterialPass(const Program& program, const kernels::KernelTable<Real>& kernels, std::size_t size);
  MaterialPass(const MaterialPass&) = delete;

  /// Finds the slots of every point of `surface`, whose normals are known. Where everything is
  /// of one material there are none.
  void run(const SurfacePass<Real>& surface, const bool& cancelled, StageStats& stage);
  /// The same at `count` points with unit normals; `field` tells how far the program is looked at.
  void run(const Field<Real>& field, const kernels::Vectors<const Real>& points,
           const kernels::Vectors<const Real>& normals, std::size_t count, const bool& cancelled, StageStats& stage);

  kernels::MaterialView<Real> view();
  const VectorBuffer<Real>& albedo() const { return albedo_; }
  /// Can any point be a mirror, even in part?
  bool reflects() const { return reflects_; }

 private:
  std::vector<Real*> slot_rows();

  const Program& program_;
  const kernels::KernelTable<Real>& kernels_;
  VectorBuffer<Real> albedo_;
  Buffer<Real> roughness_, specular_, metallic_, reflectivity_, exponent_;
  bool reflects_ = false;
  std::optional<PointExpressions<Real>> slots_;  ///< those that are not constant; made when first needed
};

}  // namespace octomarch
