#include "octomarch/render/surface_pass.hpp"

namespace octomarch {

namespace {

/// Where differences sample: pairs along the axes, or the corners of a tetrahedron (I. Quilez, "Normals for an SDF").
template <class Real>
std::vector<Real> stencil(Normals normals) {
  if (normals == Normals::kTetrahedron) return {1, -1, -1, -1, -1, 1, -1, 1, -1, 1, 1, 1};
  return {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
}

/// The 256 neighbours of a point in a lattice that lie within four of its cells, as parts of that reach, x in the outermost
/// loop: how many of them are inside, and where, tells the normal of a solid to a few degrees.
template <class Real>
std::vector<Real> neighbours() {
  constexpr int kReach = 4;
  std::vector<Real> offsets;
  for (int x = -kReach; x <= kReach; ++x) {
    for (int y = -kReach; y <= kReach; ++y) {
      for (int z = -kReach; z <= kReach; ++z) {
        const int square = x * x + y * y + z * z;
        if (square == 0 || square > kReach * kReach) continue;
        for (const int component : {x, y, z}) offsets.push_back(static_cast<Real>(component) / Real(kReach));
      }
    }
  }
  return offsets;
}

}  // namespace

template <class Real>
SurfacePass<Real>::SurfacePass(Field<Real>& field, const kernels::KernelTable<Real>& kernels, std::size_t size)
    : position(size),
      direction(size),
      normal(size),
      facing(size),
      origin(size),
      epsilon(size),
      program_(field.program()),
      kernels_(kernels),
      ray_(size),
      status_(size),
      object_(size),
      field_(field) {}

template <class Real>
void SurfacePass<Real>::gather(const RayBatch<Real>& batch, const RayColumns<Real>& rays, std::size_t count) {
  ray_.clear();
  has_candidates_ = false;
  for (std::size_t i = 0; i < count; ++i) {
    const auto status = static_cast<Status>(batch.status[i]);
    if (status != Status::kHit && status != Status::kStepLimit) continue;
    status_[ray_.size()] = batch.status[i];
    ray_.push(i);
    has_candidates_ |= status == Status::kStepLimit;
  }
  kernels_.surface_points(rays.view({}, {}, count), rays.epsilon_slope, batch.t.data(), ray_.data(), view());
}

template <class Real>
void SurfacePass<Real>::find_normals(const Shading& shading, const bool& cancelled, StageStats& stage) {
  const ScopedTimer timer(stage.seconds);
  stage.count += count();
  if (shading.normals == Normals::kExact && !program_.is_solid()) {
    stage.work.evaluations += count();
    field_.gradient(position.read(), count(), cancelled, normal.view(), stage);
  } else {
    if (offsets_.empty()) offsets_ = program_.is_solid() ? neighbours<Real>() : stencil<Real>(shading.normals);
    const kernels::StencilView<Real> around{offsets_.data(), offsets_.size() / 3, clamped<Real>(shading.normal_step),
                                            program_.is_solid()};
    stage.work.evaluations += count() * around.count;
    field_.sample_around(position.read(), count(), around, cancelled, normal.view(), stage);
  }
  stage.without += kernels_.normalize(view());
}

template <class Real>
void SurfacePass<Real>::find_objects(const bool& cancelled, StageStats& stage) {
  if (!attributes_) {
    const Tape& tape = program_.attributes().tape;
    attributes_.emplace(tape, std::vector<Real*>{object_.data()}, field_.octree_of(tape, program_.octrees().attributes),
                        kernels_);
  }
  attributes_->run(position.read(), normal.read(), count(), cancelled, stage);
}

template <class Real>
kernels::SurfaceView<Real> SurfacePass<Real>::view() {
  return {count(), position.view(), direction.view(), normal.view(), facing.view(), origin.view(), epsilon.data()};
}

template class SurfacePass<float>;
template class SurfacePass<double>;

}  // namespace octomarch
