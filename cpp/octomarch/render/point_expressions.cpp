#include "octomarch/render/point_expressions.hpp"

#include <utility>

#include "octomarch/base/parallel.hpp"

namespace octomarch {

template <class Real>
PointExpressions<Real>::PointExpressions(const Tape& tape, std::vector<Real*> rows,
                                         std::shared_ptr<Octree<Real>> octree,
                                         const kernels::KernelTable<Real>& kernels)
    : kernels_(kernels),
      code_(tape),
      octree_(std::move(octree)),
      tape_(tape, TapeUse::kValues, octree_.get()),
      rows_(std::move(rows)),
      sampler_(tape_, kernels),
      values_(rows_.size()) {
  if (octree_) groups_.emplace(choice_.emplace(*octree_, sampler_));
}

template <class Real>
void PointExpressions<Real>::run(const kernels::Vectors<const Real>& points,
                                 const kernels::Vectors<const Real>& normals, std::size_t count, const bool& cancelled,
                                 StageStats& stage) {
  const ScopedTimer timer(stage.seconds);
  stage.count += count;
  stage.work.evaluations += count;
  if (groups_) return run_by_cells(points, normals, count, cancelled, stage);
  count_run(tape_.view(), count, 1, stage.work);
  const kernels::Vectors<const Real>* const read = code_.inputs == 6 ? &normals : nullptr;
  kernels_.expressions(tape_.view(), tape_.memory(), points, read, count, &cancelled, code_.results.data(),
                       rows_.size(), rows_.data());
}

template <class Real>
void PointExpressions<Real>::run_by_cells(const kernels::Vectors<const Real>& points,
                                          const kernels::Vectors<const Real>& normals, std::size_t count,
                                          const bool& cancelled, StageStats& stage) {
  sort(points, normals, count, cancelled, stage);
  std::vector<Real*> outs(rows_.size());
  for (const CellGroup<Real>& group : groups_->groups()) {
    if (is_set(cancelled)) return;
    const TapePart part = groups_->part(group);
    for (std::size_t k = 0; k < outs.size(); ++k) outs[k] = values_[k].data() + group.first;
    const kernels::Vectors<const Real> across = normals_.from(group.first);
    const kernels::Vectors<const Real>* const read = code_.inputs == 6 ? &across : nullptr;
    count_run(tape_.view(part), group.count, 1, stage.work);
    kernels_.expressions(tape_.view(part), tape_.memory(), points_.from(group.first), read, group.count, &cancelled,
                         part.results, outs.size(), outs.data());
  }
  for (std::size_t k = 0; k < rows_.size(); ++k) {
    groups_->for_each_place([&](std::size_t i, std::size_t place) { rows_[k][i] = values_[k][place]; });
  }
}

/// Puts points and normals into the order of their cells.
template <class Real>
void PointExpressions<Real>::sort(const kernels::Vectors<const Real>& points,
                                  const kernels::Vectors<const Real>& normals, std::size_t count, const bool& cancelled,
                                  StageStats& stage) {
  groups_->sort(count, Few::kInGroups, cancelled, stage,
                [&](std::size_t i) { return std::array<Real, 3>{points.x[i], points.y[i], points.z[i]}; });
  if (groups_->places() > points_.x.size()) {
    const std::size_t size = kernels::padded_lanes(groups_->places() * 3 / 2);
    points_ = VectorBuffer<Real>(size);
    normals_ = VectorBuffer<Real>(size);
    for (Buffer<Real>& row : values_) row = Buffer<Real>(size);
  }
  const auto move = [&](const kernels::Vectors<const Real>& from, VectorBuffer<Real>& to) {
    groups_->for_each_place([&](std::size_t i, std::size_t place) {
      to.x[place] = from.x[i];
      to.y[place] = from.y[i];
      to.z[place] = from.z[i];
    });
  };
  move(points, points_);
  if (code_.inputs == 6) move(normals, normals_);
}

template class PointExpressions<float>;
template class PointExpressions<double>;

}  // namespace octomarch
