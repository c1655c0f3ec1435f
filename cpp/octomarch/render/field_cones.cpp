// The prepass of a field's camera rays: cones about their blocks, from where they enter the solid's bounds, and from the ends of
// these on cones about fewer of them. field.cpp marches the rays from where the last end.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "octomarch/render/field.hpp"

namespace octomarch {

namespace {

template <class Real>
Real at(const kernels::Column<Real>& column, std::size_t i) {
  return RayColumns<Real>::at(column, i);
}

/// Rays that pass the solid's bounds by more than so many hit epsilons hit nothing.
constexpr double kRoomForHits = 4.0;

/// Of a block's smallest cones those about each lane.
constexpr auto kConesAbout = [] {
  std::array<std::uint8_t, kernels::kLanes> cones{};
  for (std::size_t lane = 0; lane < cones.size(); ++lane) {
    cones[lane] = static_cast<std::uint8_t>(kernels::smallest_cone_about(lane));
  }
  return cones;
}();

/// Of so many instructions an evaluation costs so much more than a cone by itself that small ones are worth it.
constexpr std::size_t kLongEnoughForSmallCones = 48;

}  // namespace

template <class Real>
Field<Real>::Cones::Cones(std::size_t size)
    : origin(size),
      direction(size),
      width(size),
      spread(size),
      epsilon(size),
      t_max(size),
      t(size),
      radius(size),
      boldness(size),
      pause(size) {}

template <class Real>
Field<Real>::ConesOfTile::ConesOfTile(std::size_t rays, const Tape& tape)
    : of_blocks(kernels::padded_lanes(rays / kernels::kLanes)) {
  if (tape.code.size() < kLongEnoughForSmallCones) return;
  small.emplace(kernels::padded_lanes(rays / kernels::kLanes * kernels::kSmallCones));
  smallest.emplace(kernels::padded_lanes(rays / kernels::kLanes * kernels::kSmallestCones));
}

template <class Real>
void Field<Real>::advance_together(const Rays& rays, const Parameters& parameters, RayBatch<Real>& batch,
                                   StageStats& stage) {
  if (!planes_.empty()) {
    meet_planes(rays, parameters, batch);
    if (rest_) rest_->advance_together(ending_at(batch.end, rays), parameters, batch, stage);
    return;
  }
  if (!cones_) cones_.emplace(batch.t.size(), program_.distance());
  Cones& blocks = cones_->of_blocks;
  const std::size_t count = rays.count / kernels::kLanes;
  kernels_.fit_cones(rays, blocks.view());
  std::fill_n(blocks.t.data(), count, rays.start.value);
  if (has_bounds()) enter_bounds(blocks, count, parameters);
  const bool may_have_balls =
      parameters.stepping == kernels::Stepping::kEnhanced && parameters.epsilon_slope < kernels::kSteepestOfBalls<Real>;
  const BallTree<Real>* const balls = may_have_balls ? program_.template balls<Real>(*parameters.cancelled) : nullptr;
  if (balls == nullptr) march_cones(rays, blocks, count, parameters, stage);
  if (has_bounds()) {
    for (std::size_t block = 0; block < count; ++block) {
      const Real leave = blocks.t_max[block];
      for (std::size_t i = block * kernels::kLanes; i < (block + 1) * kernels::kLanes; ++i) {
        batch.end[i] = std::min(leave, at(rays.t_max, i));
      }
    }
  }
  if (balls != nullptr) {
    stage.count += count;
    return enter_balls(*balls, rays, count, parameters, batch);
  }
  if (cones_->small) march_small_cones(rays, count, parameters, stage);
  const auto number_or = [](Real t, Real other) { return t == t ? t : other; };
  for (std::size_t block = 0; block < count; ++block) {
    Real* const start = batch.start.data() + block * kernels::kLanes;
    const Real together = number_or(blocks.t[block], rays.start.value);
    if (!cones_->small) {
      std::fill_n(start, kernels::kLanes, together);
      continue;
    }
    const Real* const t = cones_->smallest->t.data() + block * kernels::kSmallestCones;
    for (std::size_t lane = 0; lane < kernels::kLanes; ++lane) start[lane] = number_or(t[kConesAbout[lane]], together);
  }
}

/// Instead of cones.
template <class Real>
void Field<Real>::enter_balls(const BallTree<Real>& balls, const Rays& rays, std::size_t blocks,
                              const Parameters& parameters, RayBatch<Real>& batch) {
  const kernels::BallsView<Real> view{balls.nodes().data(), balls.leaves().data(), balls.blend(),
                                      balls.trusted_epsilon()};
  for (std::size_t block = 0; block < blocks; ++block) {
    Real* const start = batch.start.data() + block * kernels::kLanes;
    Real* const end = batch.end.data() + block * kernels::kLanes;
    if (cones_->of_blocks.t_max[block] < Real(0)) {  // it passes the bounds by
      std::fill_n(start, kernels::kLanes, rays.start.value);
      continue;
    }
    kernels_.enter_balls(view, rays, block, cones_->of_blocks.view(), parameters.epsilon_slope, start, end);
  }
}

/// From the ends of the cones about blocks on.
template <class Real>
void Field<Real>::march_small_cones(const Rays& rays, std::size_t blocks, const Parameters& parameters,
                                    StageStats& stage) {
  auto& [of_blocks, small, smallest] = *cones_;
  for (std::size_t block = 0; block < blocks; ++block) {
    if (of_blocks.t[block] > of_blocks.t_max[block]) {  // it has ended where none of its rays lives
      std::fill_n(small->t_max.data() + block * kernels::kSmallCones, kernels::kSmallCones, Real(-1));
      std::fill_n(smallest->t_max.data() + block * kernels::kSmallestCones, kernels::kSmallestCones, Real(-1));
    } else {
      kernels_.fit_small_cones(rays, block, small->view(), smallest->view());
    }
  }
  const std::size_t small_count = blocks * kernels::kSmallCones;
  for (std::size_t i = 0; i < small_count; ++i) small->begin_within(of_blocks, i / kernels::kSmallCones, i);
  march_cones(rays, *small, small_count, parameters, stage);
  const std::size_t smallest_count = blocks * kernels::kSmallestCones;
  for (std::size_t i = 0; i < smallest_count; ++i) {
    const std::size_t block = i / kernels::kSmallestCones;
    smallest->begin_within(*small, block * kernels::kSmallCones + i % kernels::kSmallCones, i);
  }
  march_cones(rays, *smallest, smallest_count, parameters, stage);
}

/// Marches cones about some rays from their t, each until it comes near to something or past its t_max. Of those that are no
/// numbers, since some of their rays are none, t is none either.
template <class Real>
void Field<Real>::march_cones(const Rays& rays, Cones& cones, std::size_t count, Parameters parameters,
                              StageStats& stage) {
  stage.count += count;
  const auto axis = [](const kernels::Column<Real>& of_rays, const Buffer<Real>& of_cones) {
    return of_rays.values == nullptr ? of_rays : kernels::Column<Real>{of_cones.data(), 0};
  };
  const Rays axes{axis(rays.ox, cones.origin.x),
                  axis(rays.oy, cones.origin.y),
                  axis(rays.oz, cones.origin.z),
                  axis(rays.dx, cones.direction.x),
                  axis(rays.dy, cones.direction.y),
                  axis(rays.dz, cones.direction.z),
                  {},
                  {cones.t_max.data(), 0},
                  {cones.epsilon.data(), 0},
                  count};
  for (std::size_t i = 0; i < count; ++i) {
    const Real sum = cones.origin.x[i] + cones.origin.y[i] + cones.origin.z[i] + cones.direction.x[i] +
                     cones.direction.y[i] + cones.direction.z[i];
    cones.t[i] += sum * Real(0);
  }
  std::fill(cones.t.data() + count, cones.t.data() + kernels::padded_lanes(count),
            std::numeric_limits<Real>::quiet_NaN());
  parameters.stepping = kernels::Stepping::kCone;
  parameters.finish = false;
  march_states(axes, parameters, cones.state(), stage);
}

/// Moves cones to where they enter the solid's bounds, and their ends to where they leave them, or before they begin where they
/// miss them. Bounds are widened by how wide a cone is at their far end.
template <class Real>
void Field<Real>::enter_bounds(Cones& cones, std::size_t count, const Parameters& parameters) const {
  const Aabb box = bounds_on_grid();
  for (std::size_t i = 0; i < count; ++i) {
    const auto number = [i](const Buffer<Real>& row) { return static_cast<double>(row[i]); };
    const Vec3 o{number(cones.origin.x), number(cones.origin.y), number(cones.origin.z)};
    const Vec3 d{number(cones.direction.x), number(cones.direction.y), number(cones.direction.z)};
    const Vec3 farthest{std::max(std::fabs(box.lo.x - o.x), std::fabs(box.hi.x - o.x)),
                        std::max(std::fabs(box.lo.y - o.y), std::fabs(box.hi.y - o.y)),
                        std::max(std::fabs(box.lo.z - o.z), std::fabs(box.hi.z - o.z))};
    const double past = length(farthest) + number(cones.width);
    const double epsilon = std::max(number(cones.epsilon), static_cast<double>(parameters.epsilon_slope) * past);
    const double room = (number(cones.width) + number(cones.spread) * past) * 1.01 + kRoomForHits * epsilon;
    double enter = number(cones.t);
    double leave = std::min(number(cones.t_max), past);
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
      cones.t[i] = static_cast<Real>(enter);
      cones.t_max[i] = static_cast<Real>(leave);
    } else if (enter > leave) {  // not where they are NaN
      cones.t_max[i] = Real(-1);
    }
  }
}

#define OCTOMARCH_CONES_OF(Real)            \
  template struct Field<Real>::ConesOfTile; \
  template void Field<Real>::advance_together(const Rays&, const Parameters&, RayBatch<Real>&, StageStats&);
OCTOMARCH_CONES_OF(float)
OCTOMARCH_CONES_OF(double)
#undef OCTOMARCH_CONES_OF

}  // namespace octomarch
