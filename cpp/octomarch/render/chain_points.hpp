// The field at points of which few share a cell of an octree, each by a part of its own. chain_lanes.hpp comes before, field.hpp
// after.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "octomarch/base/parallel.hpp"
#include "octomarch/render/chain_lanes.hpp"

namespace octomarch {

/// Writes the field at some elements of `points` to those of `out`; run(chain, block) is the kernel. `left` gets those that lanes
/// have no part for. Stops where that is cancelled.
template <class Real, class Run>
void run_points_alone(ChainLanes<Real>& lanes, const kernels::Vectors<const Real>& points,
                      std::span<const std::uint32_t> some, const bool& cancelled, Real* out,
                      std::vector<std::uint32_t>& left, Run&& run) {
  constexpr std::size_t kLanes = kernels::kLanes;
  left.clear();
  lanes.clear(~std::uint64_t{0});  // whoever was cancelled left some
  for (; !some.empty() && !is_set(cancelled); some = some.subspan(std::min(some.size(), kLanes))) {
    const std::size_t count = std::min(some.size(), kLanes);
    for (std::size_t lane = 0; lane < count; ++lane) {
      lanes.place(lane, points.x[some[lane]], points.y[some[lane]], points.z[some[lane]]);
    }
    const std::uint64_t all = ~std::uint64_t{0} >> (kLanes - count);
    const std::uint64_t found = lanes.enter(all);
    for_each_lane(all & ~found, [&](std::size_t lane) { left.push_back(some[lane]); });
    if (found == 0) continue;
    lanes.block().lanes = static_cast<std::size_t>(std::bit_width(found));
    run(lanes.chain(), lanes.block());
    for_each_lane(found, [&](std::size_t lane) { out[some[lane]] = lanes.field()[lane]; });
    lanes.clear(found);
  }
}

}  // namespace octomarch
