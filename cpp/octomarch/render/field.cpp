#include "octomarch/render/field.hpp"

#include "octomarch/base/parallel.hpp"
#include "octomarch/render/chain_points.hpp"

namespace octomarch {

namespace {

/// Runs a march by a tape, and counts its instructions.
template <class Real, class Run>
void counted(const kernels::TapeView<Real>& tape, kernels::Counters& counters, Run&& run) {
  const std::uint64_t before = counters.lane_slots;
  run();
  counters.instructions += (counters.lane_slots - before) * tape.length;
}

/// An octree of a program's distance, or null.
template <class Real>
std::shared_ptr<Octree<Real>> octree_for(const Program& program, const March& march) {
  const std::optional<Aabb>& focus = program.focus();
  if (!march.prune || is_fixed(march.method) || program.is_solid() || !focus) return nullptr;
  return program.octrees().distance.get<Real>(program.distance(), counted_from(program.site().anchor, *focus));
}

}  // namespace

template <class Real>
SharedField<Real> share_field(const Program& program, const March& march, bool many) {
  SharedField<Real> shared{&program, many ? octree_for<Real>(program, march) : nullptr, nullptr, nullptr,
                           march.method == Method::kAuto};
  if (!shared.clips_to_bounds || march.bias != 0.0 || program.is_solid()) return shared;
  shared.split = program.planes_and_rest();
  if (shared.split == nullptr || !shared.split->rest) return shared;
  if (many) shared.rest_octree = octree_for<Real>(*shared.split->rest, march);
  return shared;
}

template <class Real>
Field<Real>::Field(const SharedField<Real>& shared, const kernels::KernelTable<Real>& kernels, std::size_t size)
    : program_(*shared.program),
      octree_(shared.octree.get()),
      clips_to_bounds_(shared.clips_to_bounds),
      kernels_(kernels),
      tape_(program_.distance(), TapeUse::kMarches, octree_),
      points_(kernels::padded_lanes(size)),
      values_(kernels::padded_lanes(size)),
      ends_(kernels::padded_lanes(size)),
      sampler_(tape_, kernels) {
  if (shared.octree) {
    choice_.emplace(*shared.octree, sampler_);
    groups_.emplace(*choice_);
    cell_march_.emplace(*choice_);
  }
  if (shared.split == nullptr) return;
  for (const Plane& plane : shared.split->planes) {
    for (const double number : plane) planes_.push_back(static_cast<Real>(number));
  }
  met_ = Buffer<Real>(kernels::padded_lanes(size));
  if (!shared.split->rest) return;
  rest_ = std::make_unique<Field>(
      SharedField<Real>{shared.split->rest.get(), shared.rest_octree, nullptr, nullptr, clips_to_bounds_}, kernels,
      size);
}

template <class Real>
std::shared_ptr<Octree<Real>> Field<Real>::octree_of(const Tape& tape, Octrees& octrees) const {
  if (octree_ == nullptr) return nullptr;
  return octrees.get<Real>(tape, counted_from(program_.site().anchor, *program_.focus()));
}

template <class Real>
template <class Function>
void Field<Real>::for_each_group(const kernels::Vectors<const Real>& points, std::size_t count, Few few,
                                 const bool& cancelled, LoadedTape<Real>& tape, StageStats& stage, Function&& f) {
  groups_->sort(count, few, cancelled, stage,
                [&](std::size_t i) { return std::array<Real, 3>{points.x[i], points.y[i], points.z[i]}; });
  if (groups_->places() > sorted_points_.x.size()) {
    const std::size_t size = kernels::padded_lanes(groups_->places() * 3 / 2);
    sorted_points_ = VectorBuffer<Real>(size);
    sorted_values_ = VectorBuffer<Real>(size);
  }
  groups_->for_each_place([&](std::size_t i, std::size_t place) {
    sorted_points_.x[place] = points.x[i];
    sorted_points_.y[place] = points.y[i];
    sorted_points_.z[place] = points.z[i];
  });
  for (const CellGroup<Real>& group : groups_->groups()) {
    if (is_set(cancelled)) return;
    f(tape.view(groups_->part(group)), group);
  }
}

template <class Real>
void Field<Real>::distance(const kernels::Vectors<const Real>& points, std::size_t count, const bool& cancelled,
                           Real* out, StageStats& stage) {
  if (!groups_) {
    count_run(tape_.view(), count, 1, stage.work);
    return kernels_.distance(tape_.view(), tape_.memory(), points, count, &cancelled, out);
  }
  distance_by_groups(points, count, cell_march_->lanes() != nullptr ? Few::kAlone : Few::kInGroups, cancelled, out,
                     stage);
  if (!groups_->alone().empty()) distance_alone(points, cancelled, out, stage);
}

template <class Real>
void Field<Real>::distance_by_groups(const kernels::Vectors<const Real>& points, std::size_t count, Few few,
                                     const bool& cancelled, Real* out, StageStats& stage) {
  Buffer<Real>& values = sorted_values_.x;
  for_each_group(points, count, few, cancelled, tape_, stage, [&](const auto& tape, const CellGroup<Real>& group) {
    count_run(tape, group.count, 1, stage.work);
    kernels_.distance(tape, tape_.memory(), sorted_points_.from(group.first), group.count, &cancelled,
                      values.data() + group.first);
  });
  std::fill_n(out, count, std::numeric_limits<Real>::quiet_NaN());
  groups_->for_each_place([&](std::size_t i, std::size_t place) { out[i] = values[place]; });
}

/// Of the points that are in no group.
template <class Real>
void Field<Real>::distance_alone(const kernels::Vectors<const Real>& points, const bool& cancelled, Real* out,
                                 StageStats& stage) {
  run_points_alone(*cell_march_->lanes(), points, groups_->alone(), cancelled, out, left_,
                   [&](const auto&... all) { kernels_.run_chain(all..., stage.work); });
  if (left_.empty()) return;
  VectorBuffer<Real> left(left_.size());
  Buffer<Real> values(left_.size());
  for (std::size_t k = 0; k < left_.size(); ++k) {
    left.x[k] = points.x[left_[k]];
    left.y[k] = points.y[left_[k]];
    left.z[k] = points.z[left_[k]];
  }
  distance_by_groups(left.read(), left_.size(), Few::kInGroups, cancelled, values.data(), stage);
  for (std::size_t k = 0; k < left_.size(); ++k) out[left_[k]] = values[k];
}

template <class Real>
void Field<Real>::gradient(const kernels::Vectors<const Real>& points, std::size_t count, const bool& cancelled,
                           const kernels::Vectors<Real>& out, StageStats& stage) {
  if (!gradient_) gradient_.emplace(program_.distance(), TapeUse::kGradients, octree_);
  if (!groups_) {
    count_run(gradient_->view(), count, 1, stage.work);
    return kernels_.gradient(gradient_->view(), gradient_->memory(), points, count, &cancelled, out);
  }
  for_each_group(points, count, Few::kInGroups, cancelled, *gradient_, stage,
                 [&](const auto& tape, const CellGroup<Real>& group) {
                   count_run(tape, group.count, 1, stage.work);
                   VectorBuffer<Real>& values = sorted_values_;
                   kernels_.gradient(
                       tape, gradient_->memory(), sorted_points_.from(group.first), group.count, &cancelled,
                       {values.x.data() + group.first, values.y.data() + group.first, values.z.data() + group.first});
                 });
  for (Real* row : {out.x, out.y, out.z}) std::fill_n(row, count, std::numeric_limits<Real>::quiet_NaN());
  groups_->for_each_place([&](std::size_t i, std::size_t place) {
    out.x[i] = sorted_values_.x[place];
    out.y[i] = sorted_values_.y[place];
    out.z[i] = sorted_values_.z[place];
  });
}

template <class Real>
void Field<Real>::sample_around(const kernels::Vectors<const Real>& points, std::size_t count,
                                const kernels::StencilView<Real>& stencil, const bool& cancelled,
                                const kernels::Vectors<Real>& out, StageStats& stage) {
  if (!groups_) {
    count_run(tape_.view(), count, stencil.count, stage.work);
    return kernels_.sample_around(tape_.view(), tape_.memory(), points, count, stencil, &cancelled, out);
  }
  for (Real* row : {out.x, out.y, out.z}) std::fill_n(row, count, Real(0));
  for (std::size_t k = 0; k < stencil.count && !is_set(cancelled); ++k) {
    const Real* const offset = stencil.offsets + 3 * k;
    for (std::size_t i = 0; i < count; ++i) {
      points_.x[i] = points.x[i] + stencil.step * offset[0];
      points_.y[i] = points.y[i] + stencil.step * offset[1];
      points_.z[i] = points.z[i] + stencil.step * offset[2];
    }
    distance(points_.read(), count, cancelled, values_.data(), stage);
    for (std::size_t i = 0; i < count; ++i) {
      out.x[i] += values_[i] * offset[0];
      out.y[i] += values_[i] * offset[1];
      out.z[i] += values_[i] * offset[2];
    }
  }
}

template <class Real>
template <class Run, class Step>
void Field<Real>::march_all(const Rays& rays, const Parameters& parameters, const State& state, StageStats& stage,
                            Run&& run, Step&& step) {
  if (!cell_march_) {
    const Region<Real>* const everywhere = nullptr;
    return run(tape_.view(), tape_.memory(), rays, parameters, everywhere, state);
  }
  cell_march_->march(
      rays, parameters, state, stage,
      [&](const TapePart& part, const Rays& of_cell, const Parameters& left, const Region<Real>& region,
          const State& its) { run(tape_.view(part), tape_.memory(), of_cell, left, &region, its); },
      step);
}

template <class Real>
void Field<Real>::march_states(const Rays& rays, const Parameters& parameters, const State& state, StageStats& stage) {
  march_all(
      rays, parameters, state, stage,
      [&](const kernels::TapeView<Real>& tape, const auto&... rest) {
        counted(tape, stage.work, [&] { kernels_.march(tape, rest..., stage.work); });
      },
      [&](const auto&... all) { return kernels_.step_chain(all..., stage.work); });
}

template <class Real>
void Field<Real>::march_limited(const Rays& rays, const Parameters& parameters, RayBatch<Real>& batch,
                                std::int32_t* steps, StageStats& stage) {
  const kernels::MarchState<Real> state = batch.state(steps);
  std::uint8_t* const status = batch.status.data();
  const bool is_fixed = parameters.stepping == kernels::Stepping::kFixed;
  kernels_.begin_march(rays, parameters, is_fixed ? Real(0) : kernels::kNothingBefore<Real>, state);
  march_states(rays, parameters, state, stage);
  kernels_.conclude(rays, parameters, state, status);
  if (!parameters.finish || parameters.stepping == kernels::Stepping::kCertified) return;
  if (is_fixed) {
    counted(tape_.view(), stage.work,
            [&] { kernels_.bisect(tape_.view(), tape_.memory(), rays, parameters, state, status, stage.work); });
  } else {
    follow_secants(rays, parameters, state, status, stage);
  }
}

template <class Real>
void Field<Real>::follow_secants(const kernels::RayView<Real>& rays, const kernels::MarchParameters<Real>& parameters,
                                 const kernels::MarchState<Real>& state, const std::uint8_t* status,
                                 StageStats& stage) {
  for (int round = 0; round < 2; ++round) {
    if (!kernels_.secants(rays, parameters, state, status, ends_.data(), points_.view(), stage.work)) return;
    distance(points_.read(), rays.count, *parameters.cancelled, values_.data(), stage);
    kernels_.follow_secants(rays, parameters, state, status, ends_.data(), values_.data());
  }
}

template <class Real>
void Field<Real>::cast_limited_shadows(const Rays& rays, const Parameters& parameters, RayBatch<Real>& batch,
                                       Real* visibility, StageStats& stage) {
  const kernels::MarchState<Real> state = batch.state(nullptr);
  kernels_.begin_march(rays, parameters, Real(1), state);
  march_all(
      rays, parameters, state, stage,
      [&](const kernels::TapeView<Real>& tape, const auto&... rest) {
        counted(tape, stage.work, [&] { kernels_.march_shadow(tape, rest..., stage.work); });
      },
      [&](const auto&... all) { return kernels_.step_chain_shadow(all..., stage.work); });
  kernels_.visibility(rays, parameters, state, visibility);
}

template SharedField<float> share_field(const Program&, const March&, bool);
template SharedField<double> share_field(const Program&, const March&, bool);
template class Field<float>;
template class Field<double>;

}  // namespace octomarch
