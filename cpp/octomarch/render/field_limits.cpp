// Where a field's rays are limited before they are marched: by the planes that its shape is united with, and by the bounds of what
// is left. field.cpp marches between.
#include <algorithm>
#include <cmath>

#include "octomarch/render/field.hpp"

namespace octomarch {

template <class Real>
void Field<Real>::march(const Rays& rays, const Parameters& parameters, RayBatch<Real>& batch, std::int32_t* steps,
                        StageStats& stage, bool advanced) {
  if (!planes_.empty()) {
    if (!advanced) meet_planes(rays, parameters, batch);
    if (rest_) rest_->march(ending_at(batch.end, rays), parameters, batch, steps, stage, advanced);
    if (!rest_) march_nothing(rays, parameters, batch, steps);
    return kernels_.take_planes(rays, parameters, met_.data(), batch.state(nullptr), batch.status.data());
  }
  if (!advanced) return march_limited(clipped(rays, Real(0), parameters, batch), parameters, batch, steps, stage);
  Rays limited = has_bounds() ? ending_at(batch.end, rays) : rays;
  limited.start = {batch.start.data(), 0};
  march_limited(limited, parameters, batch, steps, stage);
}

template <class Real>
void Field<Real>::cast_shadows(const Rays& rays, const Parameters& parameters, RayBatch<Real>& batch, Real* visibility,
                               StageStats& stage) {
  if (planes_.empty()) {
    // r ≥ t/k dims nothing
    return cast_limited_shadows(clipped(rays, Real(1) / parameters.k, parameters, batch), parameters, batch, visibility,
                                stage);
  }
  if (rest_) rest_->cast_shadows(rays, parameters, batch, visibility, stage);
  if (!rest_) std::fill_n(visibility, kernels::padded_lanes(rays.count), Real(1));
  kernels_.dim_by_planes(planes(), rays, parameters, visibility);
}

/// All rays end where they begin.
template <class Real>
void Field<Real>::march_nothing(Rays rays, const Parameters& parameters, RayBatch<Real>& batch, std::int32_t* steps) {
  const State state = batch.state(steps);
  rays.t_max = {nullptr, Real(-1)};
  kernels_.begin_march(rays, parameters, kernels::kNothingBefore<Real>, state);
  std::fill_n(state.pause, kernels::padded_lanes(rays.count), static_cast<std::uint8_t>(kernels::Pause::kEnded));
  kernels_.conclude(rays, parameters, state, batch.status.data());
}

/// Finds where rays meet the first plane, and ends them there.
template <class Real>
void Field<Real>::meet_planes(const Rays& rays, const Parameters& parameters, RayBatch<Real>& batch) {
  kernels_.meet_planes(planes(), rays, parameters, met_.data(), batch.end.data());
}

template <class Real>
kernels::RayView<Real> Field<Real>::ending_at(const Buffer<Real>& end, Rays rays) {
  rays.t_max = {end.data(), 0};
  return rays;
}

/// Rays as far as they are within the bounds, widened by so much for each unit of t.
template <class Real>
kernels::RayView<Real> Field<Real>::clipped(Rays rays, Real widening, const Parameters& parameters,
                                            RayBatch<Real>& batch) const {
  if (!has_bounds()) return rays;
  const Aabb box = bounds_on_grid();
  const Region<Real> region{{static_cast<Real>(box.lo.x), static_cast<Real>(box.lo.y), static_cast<Real>(box.lo.z)},
                            {static_cast<Real>(box.hi.x), static_cast<Real>(box.hi.y), static_cast<Real>(box.hi.z)}};
  kernels_.clip_rays(region, widening, parameters.epsilon_slope, rays, batch.start.data(), batch.end.data());
  rays.start = {batch.start.data(), 0};
  return ending_at(batch.end, rays);
}

/// The bounds, a little wider: roundings of a far scene's make no difference on a grid of about 2⁻⁸ radii.
template <class Real>
Aabb Field<Real>::bounds_on_grid() const {
  constexpr double kGridBits = 8.0;
  const Site& site = program_.site();
  const double grid = std::exp2(std::floor(std::log2(site.radius)) - kGridBits);
  const auto below = [grid](double a) { return (std::round(a / grid) - 1.0) * grid; };
  const auto above = [grid](double a) { return (std::round(a / grid) + 1.0) * grid; };
  const Aabb& box = site.bounds;
  return {{below(box.lo.x), below(box.lo.y), below(box.lo.z)}, {above(box.hi.x), above(box.hi.y), above(box.hi.z)}};
}

#define OCTOMARCH_LIMITS_OF(Real)                                                                                      \
  template void Field<Real>::march(const Rays&, const Parameters&, RayBatch<Real>&, std::int32_t*, StageStats&, bool); \
  template void Field<Real>::cast_shadows(const Rays&, const Parameters&, RayBatch<Real>&, Real*, StageStats&);        \
  template void Field<Real>::march_nothing(Rays, const Parameters&, RayBatch<Real>&, std::int32_t*);                   \
  template void Field<Real>::meet_planes(const Rays&, const Parameters&, RayBatch<Real>&);                             \
  template kernels::RayView<Real> Field<Real>::ending_at(const Buffer<Real>&, Rays);                                   \
  template Aabb Field<Real>::bounds_on_grid() const;
OCTOMARCH_LIMITS_OF(float)
OCTOMARCH_LIMITS_OF(double)
#undef OCTOMARCH_LIMITS_OF

}  // namespace octomarch
