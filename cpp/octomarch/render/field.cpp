#include "octomarch/render/field.hpp"

#include "octomarch/base/parallel.hpp"

namespace octomarch {

namespace {

template <class Real>
Real at(const kernels::Column<Real>& column, std::size_t i) {
  return RayColumns<Real>::at(column, i);
}

/// Runs a march by a tape, and counts its instructions.
template <class Real, class Run>
void counted(const kernels::TapeView<Real>& tape, kernels::Counters& counters, Run&& run) {
  const std::uint64_t before = counters.lane_slots;
  run();
  counters.instructions += (counters.lane_slots - before) * tape.length;
}

/// How many steps a ray makes in a cell, about.
constexpr double kStepsInCell = 3.0;

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
      tape_(program_.distance(), TapeUse::kMarches),
      points_(kernels::padded_lanes(size)),
      values_(kernels::padded_lanes(size)),
      ends_(kernels::padded_lanes(size)),
      sampler_(tape_, kernels) {
  if (shared.octree) {
    choice_.emplace(*shared.octree, sampler_);
    groups_.emplace(*choice_);
    sweep_.emplace(*choice_);
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
void Field<Real>::Gathered::reserve(std::size_t size) {
  if (size <= t.size()) return;
  const std::size_t padded = kernels::padded_lanes(size + size / 2);
  for (VectorBuffer<Real>* rows : {&points, &values, &origin, &direction}) *rows = VectorBuffer<Real>(padded);
  for (Buffer<Real>* row : {&t_max, &epsilon, &t, &radius, &before, &stride, &boldness}) *row = Buffer<Real>(padded);
  pause = Buffer<std::uint8_t>(padded);
  steps = Buffer<std::int32_t>(padded);
}

template <class Real>
template <class Function>
void Field<Real>::for_each_group(const kernels::Vectors<const Real>& points, std::size_t count, const bool& cancelled,
                                 LoadedTape<Real>& tape, StageStats& stage, Function&& f) {
  groups_->sort(count, cancelled, stage,
                [&](std::size_t i) { return std::array<Real, 3>{points.x[i], points.y[i], points.z[i]}; });
  gathered_.reserve(groups_->places());
  groups_->for_each_place([&](std::size_t i, std::size_t place) {
    gathered_.points.x[place] = points.x[i];
    gathered_.points.y[place] = points.y[i];
    gathered_.points.z[place] = points.z[i];
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
  Buffer<Real>& values = gathered_.values.x;
  for_each_group(points, count, cancelled, tape_, stage, [&](const auto& tape, const CellGroup<Real>& group) {
    count_run(tape, group.count, 1, stage.work);
    kernels_.distance(tape, tape_.memory(), gathered_.points.from(group.first), group.count, &cancelled,
                      values.data() + group.first);
  });
  std::fill_n(out, count, std::numeric_limits<Real>::quiet_NaN());
  groups_->for_each_place([&](std::size_t i, std::size_t place) { out[i] = values[place]; });
}

template <class Real>
void Field<Real>::gradient(const kernels::Vectors<const Real>& points, std::size_t count, const bool& cancelled,
                           const kernels::Vectors<Real>& out, StageStats& stage) {
  if (!gradient_) gradient_.emplace(program_.distance(), TapeUse::kGradients);
  if (!groups_) {
    count_run(gradient_->view(), count, 1, stage.work);
    return kernels_.gradient(gradient_->view(), gradient_->memory(), points, count, &cancelled, out);
  }
  for_each_group(points, count, cancelled, *gradient_, stage, [&](const auto& tape, const CellGroup<Real>& group) {
    count_run(tape, group.count, 1, stage.work);
    VectorBuffer<Real>& values = gathered_.values;
    kernels_.gradient(tape, gradient_->memory(), gathered_.points.from(group.first), group.count, &cancelled,
                      {values.x.data() + group.first, values.y.data() + group.first, values.z.data() + group.first});
  });
  for (Real* row : {out.x, out.y, out.z}) std::fill_n(row, count, std::numeric_limits<Real>::quiet_NaN());
  groups_->for_each_place([&](std::size_t i, std::size_t place) {
    out.x[i] = gathered_.values.x[place];
    out.y[i] = gathered_.values.y[place];
    out.z[i] = gathered_.values.z[place];
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
template <class Run>
void Field<Real>::march_all(const Rays& rays, const Parameters& parameters, const State& state, StageStats& stage,
                            Run&& run) {
  const Region<Real>* const everywhere = nullptr;
  if (groups_) return march_by_cells(rays, parameters, state, stage, run);
  run(tape_.view(), tape_.memory(), rays, parameters, everywhere, state);
}

/// Cell by cell, from front to back.
template <class Real>
template <class Run>
void Field<Real>::march_by_cells(const Rays& rays, const Parameters& parameters, const State& state, StageStats& stage,
                                 Run&& run) {
  choice_->begin(kStepsInCell, *parameters.cancelled, stage);
  taken_.assign(rays.count, 0);
  int along[3] = {};
  for (std::size_t i = 0; i < rays.count; ++i) {
    state.pause[i] = static_cast<std::uint8_t>(kernels::Pause::kEnded);
    if (!(state.t[i] <= at(rays.t_max, i))) continue;
    wait(rays, state, i);
    along[0] += at(rays.dx, i) < Real(0) ? -1 : 1;
    along[1] += at(rays.dy, i) < Real(0) ? -1 : 1;
    along[2] += at(rays.dz, i) < Real(0) ? -1 : 1;
  }
  const unsigned nearest = (along[0] < 0 ? 1U : 0U) | (along[1] < 0 ? 2U : 0U) | (along[2] < 0 ? 4U : 0U);
  sweep_->run(nearest, [&](const TapePart& part, const Region<Real>& region, const Waiting& waiting) {
    const Rays gathered = gather(rays, state, waiting);
    Parameters left = parameters;
    for (const Way way : waiting)
      left.max_steps = std::min(left.max_steps, parameters.max_steps - taken_[way.element()]);
    Gathered& g = gathered_;
    std::fill_n(g.steps.data(), waiting.size(), 0);
    run(tape_.view(part), tape_.memory(), gathered, left, &region,
        State{g.t.data(), g.radius.data(), g.before.data(), g.stride.data(), g.boldness.data(), g.pause.data(),
              g.steps.data()});
    take_back(rays, parameters.max_steps, state, waiting);
  });
  if (state.steps != nullptr) std::copy_n(taken_.data(), rays.count, state.steps);
}

/// Lets a ray wait in the cell of its next sample, the point as kernels compute it.
template <class Real>
void Field<Real>::wait(const Rays& rays, const State& state, std::size_t i) {
  const Real t = state.t[i];
  sweep_->add(i, at(rays.ox, i) + t * at(rays.dx, i), at(rays.oy, i) + t * at(rays.dy, i),
              at(rays.oz, i) + t * at(rays.dz, i));
}

/// Copies the rays of a cell side by side.
template <class Real>
kernels::RayView<Real> Field<Real>::gather(const Rays& rays, const State& state, const Waiting& waiting) {
  Gathered& g = gathered_;
  const std::size_t count = waiting.size();
  const std::size_t padded = kernels::padded_batches(count);
  g.reserve(padded);
  const auto copy = [&](const auto* values, auto* out) {
    for (std::size_t k = 0; k < count; ++k) out[k] = values[waiting[k].element()];
  };
  const auto column = [&](const kernels::Column<Real>& values, Buffer<Real>& out) {
    if (values.values == nullptr) return values;
    copy(values.values, out.data());
    return kernels::Column<Real>{out.data(), 0};
  };
  const Rays side_by_side{column(rays.ox, g.origin.x),
                          column(rays.oy, g.origin.y),
                          column(rays.oz, g.origin.z),
                          column(rays.dx, g.direction.x),
                          column(rays.dy, g.direction.y),
                          column(rays.dz, g.direction.z),
                          {},
                          column(rays.t_max, g.t_max),
                          column(rays.epsilon, g.epsilon),
                          count};
  copy(state.t, g.t.data());
  copy(state.before, g.before.data());
  copy(state.stride, g.stride.data());
  copy(state.boldness, g.boldness.data());
  std::fill(g.t.data() + count, g.t.data() + padded, std::numeric_limits<Real>::quiet_NaN());  // which never live
  return side_by_side;
}

/// Copies them back; those that have not ended, and have steps left, wait again.
template <class Real>
void Field<Real>::take_back(const Rays& rays, int max_steps, const State& state, const Waiting& waiting) {
  const Gathered& g = gathered_;
  for (std::size_t k = 0; k < waiting.size(); ++k) {
    const std::size_t i = waiting[k].element();
    state.t[i] = g.t[k];
    state.radius[i] = g.radius[k];
    state.before[i] = g.before[k];
    state.stride[i] = g.stride[k];
    state.boldness[i] = g.boldness[k];
    state.pause[i] = g.pause[k];
    taken_[i] += g.steps[k];
    if (static_cast<kernels::Pause>(g.pause[k]) == kernels::Pause::kEnded) continue;
    state.pause[i] = static_cast<std::uint8_t>(kernels::Pause::kSpent);
    if (taken_[i] < max_steps) wait(rays, state, i);
  }
}

template <class Real>
void Field<Real>::march_limited(const Rays& rays, const Parameters& parameters, RayBatch<Real>& batch,
                                std::int32_t* steps, StageStats& stage) {
  const kernels::MarchState<Real> state = batch.state(steps);
  std::uint8_t* const status = batch.status.data();
  const bool is_fixed = parameters.stepping == kernels::Stepping::kFixed;
  kernels_.begin_march(rays, parameters, is_fixed ? Real(0) : kernels::kNothingBefore<Real>, state);
  march_all(rays, parameters, state, stage, [&](const kernels::TapeView<Real>& tape, const auto&... rest) {
    counted(tape, stage.work, [&] { kernels_.march(tape, rest..., stage.work); });
  });
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
  march_all(rays, parameters, state, stage, [&](const kernels::TapeView<Real>& tape, const auto&... rest) {
    counted(tape, stage.work, [&] { kernels_.march_shadow(tape, rest..., stage.work); });
  });
  kernels_.visibility(rays, parameters, state, visibility);
}

template SharedField<float> share_field(const Program&, const March&, bool);
template SharedField<double> share_field(const Program&, const March&, bool);
template class Field<float>;
template class Field<double>;

}  // namespace octomarch
