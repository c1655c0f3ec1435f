#include "octomarch/render/material_pass.hpp"

namespace octomarch {

template <class Real>
MaterialPass<Real>::MaterialPass(const Program& program, const kernels::KernelTable<Real>& kernels, std::size_t size)
    : program_(program),
      kernels_(kernels),
      albedo_(size),
      roughness_(size),
      specular_(size),
      metallic_(size),
      reflectivity_(size),
      exponent_(size) {
  const Expressions& surface = program.surface();
  const std::vector<Real*> rows = slot_rows();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Expressions::Slot& slot = surface.slots[i];
    if (slot.is_constant) std::fill_n(rows[i], size, clamped<Real>(slot.value));
  }
  const Expressions::Slot& reflectivity = surface.slots.back();
  reflects_ = !reflectivity.is_constant || reflectivity.value > 0.0;
  if (surface.is_constant()) kernels_.clamp_materials(view(), size);
}

template <class Real>
std::vector<Real*> MaterialPass<Real>::slot_rows() {
  return {albedo_.x.data(), albedo_.y.data(), albedo_.z.data(),    roughness_.data(),
          specular_.data(), metallic_.data(), reflectivity_.data()};
}

template <class Real>
void MaterialPass<Real>::run(const SurfacePass<Real>& surface, const bool& cancelled, StageStats& stage) {
  run(surface.field(), surface.position.read(), surface.normal.read(), surface.count(), cancelled, stage);
}

template <class Real>
void MaterialPass<Real>::run(const Field<Real>& field, const kernels::Vectors<const Real>& points,
                             const kernels::Vectors<const Real>& normals, std::size_t count, const bool& cancelled,
                             StageStats& stage) {
  const Expressions& slots = program_.surface();
  if (slots.is_constant()) return;
  if (!slots_) {
    slots_.emplace(slots.tape, varying_rows(slots, slot_rows()),
                   field.octree_of(slots.tape, program_.octrees().surface), kernels_);
  }
  slots_->run(points, normals, count, cancelled, stage);
  kernels_.clamp_materials(view(), count);
}

template <class Real>
kernels::MaterialView<Real> MaterialPass<Real>::view() {
  return {albedo_.view(),   roughness_.data(),    specular_.data(),
          metallic_.data(), reflectivity_.data(), exponent_.data()};
}

template class MaterialPass<float>;
template class MaterialPass<double>;

}  // namespace octomarch
