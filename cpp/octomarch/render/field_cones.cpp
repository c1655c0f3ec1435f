// The prepass of a field's camera rays: cones about their blocks, from where they enter the solid's bounds. field.cpp marches
// the rays from where these end.
#include <algorithm>
#include <cmath>

#include "octomarch/base/parallel.hpp"
#include "octomarch/render/field.hpp"

namespace octomarch {

namespace {

template <class Real>
Real at(const kernels::Column<Real>& column, std::size_t i) {
  return RayColumns<Real>::at(column, i);
}

/// Rays that pass the solid's bounds by more than so many hit epsilons hit nothing.
constexpr double kRoomForHits = 4.0;

}  // namespace

template <class Real>
void Field<Real>::advance_together(const kernels::RayView<Real>& rays, const kernels::MarchParameters<Real>& parameters,
                                   RayBatch<Real>& batch, StageStats& stage) {
  if (!planes_.empty()) {
    meet_planes(rays, parameters, batch);
    if (rest_) rest_->advance_together(ending_at(batch.end, rays), parameters, batch, stage);
    return;
  }
  constexpr std::size_t kRays = Cones::kMost * kernels::kLanes;
  for (std::size_t first = 0; first < rays.count; first += kRays) {
    const std::size_t count = std::min(kRays, rays.count - first);
    march_cones(rays.from(first, count), parameters, stage);
    for (std::size_t i = 0; i < count; i += kernels::kLanes) {
      std::fill_n(batch.start.data() + first + i, kernels::kLanes, cones_.t[i / kernels::kLanes]);
      if (!has_bounds()) continue;
      const Real leave = cones_.t_max[i / kernels::kLanes];
      for (std::size_t ray = first + i; ray < first + i + kernels::kLanes; ++ray) {
        batch.end[ray] = std::min(leave, at(rays.t_max, ray));
      }
    }
  }
}

/// Marches a cone about each block of rays, of kLanes blocks at the most.
template <class Real>
void Field<Real>::march_cones(const Rays& rays, const Parameters& parameters, StageStats& stage) {
  const std::size_t count = rays.count / kernels::kLanes;
  stage.count += count;
  const kernels::ConeView<Real> cones{count,
                                      cones_.origin.view(),
                                      cones_.direction.view(),
                                      cones_.width.data(),
                                      cones_.spread.data(),
                                      cones_.epsilon.data(),
                                      cones_.t_max.data(),
                                      cones_.t.data()};
  Parameters from_start = parameters;
  from_start.t_min = rays.start.value;
  kernels_.fit_cones(rays, from_start, cones);
  std::uint64_t live = enter_bounds(parameters, count);
  for (int step = 0; live != 0 && step < parameters.max_steps && !is_set(*parameters.cancelled); ++step) {
    kernels_.cone_points(cones, points_.view());
    for (std::size_t i = 0; i < count; ++i) {  // those that have ended need no evaluation
      if ((live >> i & 1U) == 0) points_.x[i] = std::numeric_limits<Real>::quiet_NaN();
    }
    distance(points_.read(), count, *parameters.cancelled, values_.data(), stage);
    stage.work.evaluations += static_cast<std::uint64_t>(__builtin_popcountll(live));
    live = kernels_.step_cones(cones, parameters, values_.data(), live);
  }
}

/// Moves cones to where they enter the solid's bounds, and their ends to where they leave them; those that miss them end before
/// they begin. Returns which are left. Bounds are widened by how wide a cone is at their far end.
template <class Real>
std::uint64_t Field<Real>::enter_bounds(const Parameters& parameters, std::size_t count) {
  std::uint64_t live = ~std::uint64_t{0} >> (kernels::kLanes - count);
  if (!has_bounds()) return live;
  const Aabb box = bounds_on_grid();
  for (std::size_t i = 0; i < count; ++i) {
    const auto number = [i](const Buffer<Real>& row) { return static_cast<double>(row[i]); };
    const Vec3 o{number(cones_.origin.x), number(cones_.origin.y), number(cones_.origin.z)};
    const Vec3 d{number(cones_.direction.x), number(cones_.direction.y), number(cones_.direction.z)};
    const Vec3 farthest{std::max(std::fabs(box.lo.x - o.x), std::fabs(box.hi.x - o.x)),
                        std::max(std::fabs(box.lo.y - o.y), std::fabs(box.hi.y - o.y)),
                        std::max(std::fabs(box.lo.z - o.z), std::fabs(box.hi.z - o.z))};
    const double past = length(farthest) + number(cones_.width);
    const double epsilon = std::max(number(cones_.epsilon), static_cast<double>(parameters.epsilon_slope) * past);
    const double room = (number(cones_.width) + number(cones_.spread) * past) * 1.01 + kRoomForHits * epsilon;
    double enter = number(cones_.t);
    double leave = std::min(number(cones_.t_max), past);
    const auto clip = [&](double origin, double direction, double lo, double hi) {
      if (direction == 0.0) {
        if (origin < lo - room || origin > hi + room) leave = -kInfinity;
        return;
      }
      const double a = (lo - room - origin) / direction;
      const double b = (hi + room - origin) / direction;
      enter = std::max(enter, std::min(a, b));
      leave = std::min(leave, std::max(a, b));
    };
    clip(o.x, d.x, box.lo.x, box.hi.x);
    clip(o.y, d.y, box.lo.y, box.hi.y);
    clip(o.z, d.z, box.lo.z, box.hi.z);
    if (enter <= leave) {
      cones_.t[i] = static_cast<Real>(enter);
      cones_.t_max[i] = static_cast<Real>(leave);
    } else if (enter > leave) {  // not where they are NaN
      cones_.t_max[i] = Real(-1);
      live &= ~(std::uint64_t{1} << i);
    }
  }
  return live;
}

template void Field<float>::advance_together(const kernels::RayView<float>&, const kernels::MarchParameters<float>&,
                                             RayBatch<float>&, StageStats&);
template void Field<double>::advance_together(const kernels::RayView<double>&, const kernels::MarchParameters<double>&,
                                              RayBatch<double>&, StageStats&);

}  // namespace octomarch
