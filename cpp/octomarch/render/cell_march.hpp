// Rays marched cell by cell of an octree: copied side by side for each cell, and back. cell_sweep.hpp comes before, field.hpp after.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "octomarch/kernels/api.hpp"
#include "octomarch/render/buffer.hpp"
#include "octomarch/render/cell_sweep.hpp"
#include "octomarch/render/chain_march.hpp"
#include "octomarch/render/rays.hpp"

namespace octomarch {

/// Keeps its memory from march to march; one for each thread.
template <class Real>
class CellMarch {
 public:
  using Rays = kernels::RayView<Real>;
  using Parameters = kernels::MarchParameters<Real>;
  using State = kernels::MarchState<Real>;

  /// `choice` must outlive this.
  explicit CellMarch(CellChoice<Real>& choice) : choice_(choice), sweep_(choice) {
    if (choice.octree().chain() != nullptr) alone_.emplace(choice);
  }

  /// Marches rays until all have ended or spent their steps, or the march is cancelled. run(part, rays, parameters, region, state)
  /// marches those of one cell until they leave its region, step(chain, block, live, parameters) is the kernel for rays of many.
  /// Counts cells for `stage`.
  template <class Run, class Step>
  void march(const Rays& rays, const Parameters& parameters, const State& state, StageStats& stage, Run&& run,
             Step&& step) {
    choice_.begin(kStayOfRay, *parameters.cancelled, stage);
    taken_.assign(rays.count, 0);
    const unsigned nearest = start(rays, state);
    const auto march_cell = [&](const TapePart& part, const Region<Real>& region, std::span<const Way> waiting) {
      const Rays gathered = gather(rays, state, waiting);
      Parameters left = parameters;
      for (const Way way : waiting) {
        left.max_steps = std::min(left.max_steps, parameters.max_steps - taken_[way.element()]);
      }
      run(part, gathered, left, region, gathered_state());
      take_back(rays, parameters.max_steps, state, waiting);
    };
    const auto march_alone = [&](std::span<const Way> waiting) {
      const std::size_t packets = kernels::packets_of(waiting.size());
      stage.work.packets += packets;
      stage.work.refills += packets - std::min(packets, kernels::kPackets);
      alone_->march(rays, waiting, parameters, state, taken_.data(), step);
      for (const Way way : waiting) {
        const std::size_t i = way.element();
        if (static_cast<kernels::Pause>(state.pause[i]) != kernels::Pause::kLeft) continue;
        state.pause[i] = static_cast<std::uint8_t>(kernels::Pause::kSpent);
        wait(rays, state, i);
      }
    };
    sweep_.run(nearest, march_cell, march_alone);
    if (state.steps != nullptr) std::copy_n(taken_.data(), rays.count, state.steps);
  }

  /// For whoever wants to run parts of the tape's chain between marches; null where it has none.
  ChainLanes<Real>* lanes() { return alone_ ? &alone_->lanes() : nullptr; }

 private:
  static Real at(const kernels::Column<Real>& column, std::size_t i) { return RayColumns<Real>::at(column, i); }

  /// Lets all wait that have not ended. Returns the octant that most come from.
  unsigned start(const Rays& rays, const State& state) {
    const kernels::Column<Real>* const directions[3] = {&rays.dx, &rays.dy, &rays.dz};
    std::ptrdiff_t along[3] = {};
    for (std::size_t i = 0; i < rays.count; ++i) {
      state.pause[i] = static_cast<std::uint8_t>(kernels::Pause::kEnded);
      if (!(state.t[i] <= at(rays.t_max, i))) continue;
      wait(rays, state, i);
      for (unsigned axis = 0; axis < 3; ++axis) along[axis] += at(*directions[axis], i) < Real(0) ? -1 : 1;
    }
    return (along[0] < 0 ? 1U : 0U) | (along[1] < 0 ? 2U : 0U) | (along[2] < 0 ? 4U : 0U);
  }

  /// Lets a ray wait in the cell of its next sample, the point as kernels compute it.
  void wait(const Rays& rays, const State& state, std::size_t i) {
    const Real t = state.t[i];
    sweep_.add(i, at(rays.ox, i) + t * at(rays.dx, i), at(rays.oy, i) + t * at(rays.dy, i),
               at(rays.oz, i) + t * at(rays.dz, i));
  }

  Rays gather(const Rays& rays, const State& state, std::span<const Way> waiting) {
    const std::size_t count = waiting.size();
    const std::size_t padded = kernels::padded_batches(count);
    reserve(padded);
    const auto copy = [&](const Real* values, Buffer<Real>& out) {
      for (std::size_t k = 0; k < count; ++k) out[k] = values[waiting[k].element()];
    };
    const auto column = [&](const kernels::Column<Real>& values, Buffer<Real>& out) {
      if (values.values == nullptr) return values;
      copy(values.values, out);
      return kernels::Column<Real>{out.data(), 0};
    };
    const Rays gathered{column(rays.ox, origin_.x),
                        column(rays.oy, origin_.y),
                        column(rays.oz, origin_.z),
                        column(rays.dx, direction_.x),
                        column(rays.dy, direction_.y),
                        column(rays.dz, direction_.z),
                        {},
                        column(rays.t_max, t_max_),
                        column(rays.epsilon, epsilon_),
                        count};
    copy(state.t, t_);
    copy(state.before, before_);
    copy(state.stride, stride_);
    copy(state.boldness, boldness_);
    std::fill_n(steps_.data(), count, 0);
    // what lies behind them never lives
    std::fill(t_.data() + count, t_.data() + padded, std::numeric_limits<Real>::quiet_NaN());
    return gathered;
  }

  State gathered_state() {
    return {t_.data(), radius_.data(), before_.data(), stride_.data(), boldness_.data(), pause_.data(), steps_.data()};
  }

  /// Copies the rays of a cell back; those that have not ended, and have steps left, wait again.
  void take_back(const Rays& rays, int max_steps, const State& state, std::span<const Way> waiting) {
    for (std::size_t k = 0; k < waiting.size(); ++k) {
      const std::size_t i = waiting[k].element();
      state.t[i] = t_[k];
      state.radius[i] = radius_[k];
      state.before[i] = before_[k];
      state.stride[i] = stride_[k];
      state.boldness[i] = boldness_[k];
      state.pause[i] = pause_[k];
      taken_[i] += steps_[k];
      if (static_cast<kernels::Pause>(pause_[k]) == kernels::Pause::kEnded) continue;
      state.pause[i] = static_cast<std::uint8_t>(kernels::Pause::kSpent);
      if (taken_[i] < max_steps) wait(rays, state, i);
    }
  }

  void reserve(std::size_t size) {
    if (size <= t_.size()) return;
    const std::size_t padded = kernels::padded_lanes(size + size / 2);
    for (VectorBuffer<Real>* rows : {&origin_, &direction_}) *rows = VectorBuffer<Real>(padded);
    for (Buffer<Real>* row : {&t_max_, &epsilon_, &t_, &radius_, &before_, &stride_, &boldness_}) {
      *row = Buffer<Real>(padded);
    }
    pause_ = Buffer<std::uint8_t>(padded);
    steps_ = Buffer<std::int32_t>(padded);
  }

  CellChoice<Real>& choice_;
  CellSweep<Real> sweep_;
  std::optional<ChainMarch<Real>> alone_;  ///< where the tape has one
  std::vector<std::int32_t> taken_;        ///< steps of each ray so far
  // of the rays of one cell:
  VectorBuffer<Real> origin_, direction_;
  Buffer<Real> t_max_, epsilon_, t_, radius_, before_, stride_, boldness_;
  Buffer<std::uint8_t> pause_;
  Buffer<std::int32_t> steps_;
};

}  // namespace octomarch
