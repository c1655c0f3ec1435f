// Rays of a chain marched side by side, though each is in a cell of its own. Comes before cell_march.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "octomarch/render/chain_lanes.hpp"
#include "octomarch/render/rays.hpp"
#include "octomarch/render/way.hpp"

namespace octomarch {

/// Keeps its memory from march to march; one for each thread.
template <class Real>
class ChainMarch {
 public:
  using Rays = kernels::RayView<Real>;
  using State = kernels::MarchState<Real>;

  /// The octree must have a chain. `choice` must outlive this.
  explicit ChainMarch(CellChoice<Real>& choice) : lanes_(choice) {}

  /// Which are nobody's between marches.
  ChainLanes<Real>& lanes() { return lanes_; }

  /// Marches some rays until they have ended, or have taken their steps, or come to a place of which lanes have no part: their
  /// pause is kLeft. `taken`: the steps of each of `rays` so far. step(chain, block, live, parameters) is the kernel.
  template <class Step>
  void march(const Rays& rays, std::span<const Way> some, const kernels::MarchParameters<Real>& parameters,
             const State& state, std::int32_t* taken, Step&& step) {
    rays_ = &rays;
    to_come_ = some;
    state_ = &state;
    taken_ = taken;
    max_steps_ = parameters.max_steps;
    steps_ = 0;
    deadline_ = std::numeric_limits<std::int64_t>::max();
    lanes_.clear(~std::uint64_t{0});  // whoever was cancelled left some
    kernels::ChainBlock<Real>& block = lanes_.block();
    std::uint64_t live = enter(refill(~std::uint64_t{0}));
    while (live != 0 && !is_set(*parameters.cancelled)) {
      block.lanes = static_cast<std::size_t>(std::bit_width(live));
      const kernels::ChainStep stepped = step(lanes_.chain(), block, live, parameters);
      ++steps_;
      const std::uint64_t ended = live & ~(stepped.live | stepped.left);
      const std::uint64_t spent = steps_ < deadline_ ? 0 : find_spent(stepped.live | stepped.left);
      write_back(ended, kernels::Pause::kEnded);
      write_back(spent, kernels::Pause::kSpent);
      live = (stepped.live & ~spent) | enter((stepped.left & ~spent) | refill(ended | spent));
    }
  }

 private:
  static constexpr std::size_t kLanes = kernels::kLanes;

  /// Puts the next rays into lanes; returns those that got one.
  std::uint64_t refill(std::uint64_t lanes) {
    std::uint64_t filled = 0;
    for_each_lane(lanes, [&](std::size_t lane) {
      if (to_come_.empty()) return;
      load(lane, to_come_.front().element());
      to_come_ = to_come_.subspan(1);
      filled |= std::uint64_t{1} << lane;
    });
    return filled;
  }

  void load(std::size_t lane, std::size_t ray) {
    const auto value = [ray](const kernels::Column<Real>& column) { return RayColumns<Real>::at(column, ray); };
    kernels::ChainBlock<Real>& block = lanes_.block();
    const Real t = state_->t[ray];
    block.origin.x[lane] = value(rays_->ox);
    block.origin.y[lane] = value(rays_->oy);
    block.origin.z[lane] = value(rays_->oz);
    block.direction.x[lane] = value(rays_->dx);
    block.direction.y[lane] = value(rays_->dy);
    block.direction.z[lane] = value(rays_->dz);
    block.t_max[lane] = value(rays_->t_max);
    block.epsilon[lane] = value(rays_->epsilon);
    block.t[lane] = t;
    block.before[lane] = state_->before[ray];
    block.stride[lane] = state_->stride[ray];
    block.boldness[lane] = state_->boldness[ray];
    // as kernels compute it
    lanes_.place(lane, block.origin.x[lane] + t * block.direction.x[lane],
                 block.origin.y[lane] + t * block.direction.y[lane],
                 block.origin.z[lane] + t * block.direction.z[lane]);
    ray_[lane] = ray;
    start_[lane] = steps_ - taken_[ray];
    deadline_ = std::min(deadline_, start_[lane] + max_steps_);
  }

  void write_back(std::uint64_t lanes, kernels::Pause pause) {
    const kernels::ChainBlock<Real>& block = lanes_.block();
    for_each_lane(lanes, [&](std::size_t lane) {
      const std::size_t ray = ray_[lane];
      state_->t[ray] = block.t[lane];
      state_->radius[ray] = lanes_.field()[lane];
      state_->before[ray] = block.before[lane];
      state_->stride[ray] = block.stride[lane];
      state_->boldness[ray] = block.boldness[lane];
      state_->pause[ray] = static_cast<std::uint8_t>(pause);
      taken_[ray] = static_cast<std::int32_t>(steps_ - start_[lane]);
    });
    lanes_.clear(lanes);
  }

  /// Which of some lanes have spent their steps?
  std::uint64_t find_spent(std::uint64_t lanes) {
    std::uint64_t spent = 0;
    deadline_ = std::numeric_limits<std::int64_t>::max();
    for_each_lane(lanes, [&](std::size_t lane) {
      if (steps_ - start_[lane] >= max_steps_) {
        spent |= std::uint64_t{1} << lane;
      } else {
        deadline_ = std::min(deadline_, start_[lane] + max_steps_);
      }
    });
    return spent;
  }

  /// Lets rays go on where their next samples are; returns the lanes that do. Others take the lanes of those that cannot.
  std::uint64_t enter(std::uint64_t lanes) {
    std::uint64_t all = 0;
    while (lanes != 0) {
      const std::uint64_t entered = lanes_.enter(lanes);
      all |= entered;
      write_back(lanes & ~entered, kernels::Pause::kLeft);
      lanes = refill(lanes & ~entered);
    }
    return all;
  }

  ChainLanes<Real> lanes_;
  // of the rays that are marched:
  const Rays* rays_ = nullptr;
  const State* state_ = nullptr;
  std::int32_t* taken_ = nullptr;
  int max_steps_ = 0;
  std::span<const Way> to_come_;
  std::int64_t steps_ = 0;
  std::int64_t deadline_ = 0;  ///< value of steps_ when the next ray has spent its own
  // by lane:
  std::array<std::size_t, kLanes> ray_{};
  std::array<std::int64_t, kLanes> start_{};  ///< value of steps_ when its ray had taken none
};

}  // namespace octomarch
