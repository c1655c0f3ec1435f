#include "octomarch/render/surface_pass.hpp"

namespace octomarch {

template <class Real>
SurfacePass<Real>::SurfacePass(const Program& program, const kernels::KernelTable<Real>& kernels, std::size_t size)
    : position(size),
      direction(size),
      normal(size),
      facing(size),
      origin(size),
      epsilon(size),
      program_(program),
      kernels_(kernels),
      object_(size),
      registers_(march_memory<Real>(program.distance())) {
  ray_.reserve(size);
  status_.reserve(size);
}

template <class Real>
void SurfacePass<Real>::gather(const RayBatch<Real>& batch, const RayColumns<Real>& rays,
                               const kernels::Column<Real>& absolute_epsilon, std::size_t count) {
  ray_.clear();
  status_.clear();
  for (std::size_t i = 0; i < count; ++i) {
    const auto status = static_cast<Status>(batch.status[i]);
    if (status != Status::kHit && status != Status::kStepLimit) continue;
    const std::size_t k = ray_.size();
    ray_.push_back(i);
    status_.push_back(status);
    const Real t = batch.t[i];
    direction.x[k] = RayColumns<Real>::at(rays.dx, i);
    direction.y[k] = RayColumns<Real>::at(rays.dy, i);
    direction.z[k] = RayColumns<Real>::at(rays.dz, i);
    position.x[k] = RayColumns<Real>::at(rays.ox, i) + t * direction.x[k];
    position.y[k] = RayColumns<Real>::at(rays.oy, i) + t * direction.y[k];
    position.z[k] = RayColumns<Real>::at(rays.oz, i) + t * direction.z[k];
    epsilon[k] = std::max(RayColumns<Real>::at(absolute_epsilon, i), rays.epsilon_slope * t);
  }
}

template <class Real>
std::uint64_t SurfacePass<Real>::find_normals(const Shading& shading, const bool& cancelled) {
  const kernels::TapeView<Real> tape = octomarch::view<Real>(program_.distance());
  std::uint64_t evaluations = count();
  if (shading.normals == Normals::kExact) {
    if (gradient_registers_.size() == 0) gradient_registers_ = register_file<Real>(program_.distance(), 4);
    kernels_.gradient(tape, gradient_registers_.data(), position.read(), count(), &cancelled, normal.view());
  } else {
    evaluations *= 6;
    kernels_.central_difference(tape, registers(), position.read(), count(), clamped<Real>(shading.normal_step),
                                &cancelled, normal.view());
  }
  kernels_.normalize(view());
  return evaluations;
}

template <class Real>
std::uint64_t SurfacePass<Real>::find_objects(const bool& cancelled) {
  const Tape& tape = program_.attributes().tape;
  if (attribute_registers_.size() == 0) attribute_registers_ = register_file<Real>(tape, 1);
  kernels_.distance(octomarch::view<Real>(tape), attribute_registers_.data(), position.read(), count(), &cancelled,
                    object_.data());
  return count();
}

template <class Real>
kernels::SurfaceView<Real> SurfacePass<Real>::view() {
  return {count(), position.view(), direction.view(), normal.view(), facing.view(), origin.view(), epsilon.data()};
}

template class SurfacePass<float>;
template class SurfacePass<double>;

}  // namespace octomarch
