// Rays in the memory of a worker, and how they are marched: the settings of a picture or a query as kernels take them.
// Comes before every stage that casts rays.
#pragma once

#include <cmath>
#include <limits>

#include "octomarch/graph/scene.hpp"
#include "octomarch/graph/site.hpp"
#include "octomarch/kernels/dispatch.hpp"
#include "octomarch/program/program.hpp"
#include "octomarch/render/buffer.hpp"

namespace octomarch {

/// Rays and what the march made of them, `size` at the most: whole blocks.
template <class Real>
struct RayBatch {
  explicit RayBatch(std::size_t size)
      : origin(size),
        direction(size),
        start(size),
        end(size),
        t(size),
        status(size),
        radius_(size),
        before_(size),
        stride_(size),
        boldness_(size),
        pause_(size) {}

  VectorBuffer<Real> origin;     ///< not used where all rays share one
  VectorBuffer<Real> direction;  ///< likewise
  Buffer<Real> start;            ///< likewise
  Buffer<Real> end;              ///< likewise
  Buffer<Real> t;
  Buffer<std::uint8_t> status;

  /// What a march works on; `steps` may be null.
  kernels::MarchState<Real> state(std::int32_t* steps) {
    return {t.data(), radius_.data(), before_.data(), stride_.data(), boldness_.data(), pause_.data(), steps};
  }

 private:
  Buffer<Real> radius_, before_, stride_, boldness_;
  Buffer<std::uint8_t> pause_;
};

/// Origin and direction columns of a batch, and the hit epsilon's two parts.
template <class Real>
struct RayColumns {
  kernels::Column<Real> ox, oy, oz;
  kernels::Column<Real> dx, dy, dz;
  kernels::Column<Real> epsilon;  ///< absolute
  Real epsilon_slope;

  static Real at(const kernels::Column<Real>& column, std::size_t i) {
    return column.values == nullptr ? column.value : column.values[i];
  }

  /// Rays that begin at t = `start`, and end at `t_max`.
  kernels::RayView<Real> view(const kernels::Column<Real>& start, const kernels::Column<Real>& t_max,
                              std::size_t count) const {
    return {ox, oy, oz, dx, dy, dz, start, t_max, epsilon, count};
  }
};

/// Columns of rays that each have an origin, a direction and an epsilon of their own, without a pixel's footprint.
template <class Real>
RayColumns<Real> own_columns(const VectorBuffer<Real>& origin, const VectorBuffer<Real>& direction,
                             const Buffer<Real>& epsilon) {
  const auto column = [](const Buffer<Real>& values) { return kernels::Column<Real>{values.data(), 0}; };
  return {column(origin.x),    column(origin.y),    column(origin.z), column(direction.x),
          column(direction.y), column(direction.z), column(epsilon),  kUlpFloor<Real>};
}

/// Absolute parts of the hit epsilons of rays. `pixel`: the part that their pixels have; `site`: of the program.
template <class Real>
void set_epsilons(const March& march, const Site& site, double pixel, const VectorBuffer<Real>& origin,
                  std::size_t count, Buffer<Real>& epsilon) {
  const double rounding = static_cast<double>(kUlpFloor<Real>) * site.inner_offset;
  const Real least = clamped<Real>(std::max({march.least_epsilon(), rounding, pixel}));
  for (std::size_t i = 0; i < count; ++i) {
    const Real farthest = std::max({std::fabs(origin.x[i]), std::fabs(origin.y[i]), std::fabs(origin.z[i])});
    epsilon[i] = std::max(least, kUlpFloor<Real> * farthest);
  }
}

/// What is known relative to `origin` in the world's numbers. Zeros keep their sign where they are the world's.
template <class Real>
Real from_far(double origin, Real value) {
  return origin == 0.0 ? value : static_cast<Real>(origin + static_cast<double>(value));
}

/// With a bias steps are not relaxed: what goes beyond the field is the opposite. Certified ones have it in their doubt.
inline kernels::Stepping stepping_of(const March& march) {
  using kernels::Stepping;
  if (march.method == Method::kFixed) return Stepping::kFixed;
  if (march.method == Method::kCertified) return Stepping::kCertified;
  if (march.bias != 0.0) return Stepping::kBiased;
  if (march.method == Method::kPlain) return Stepping::kPlain;
  return march.method == Method::kRelaxed ? Stepping::kRelaxed : Stepping::kEnhanced;
}

template <class Real>
kernels::MarchParameters<Real> march_parameters(const Program& program, const March& march, Real epsilon_slope,
                                                const bool& cancelled) {
  // certified steps are a little shorter than what roundings of the bound, of the direction and of sums can make of them
  constexpr double kShorter = 1.0 - 16.0 * static_cast<double>(std::numeric_limits<Real>::epsilon());
  const bool is_certified = march.method == Method::kCertified;
  const Doubt doubt = is_certified ? program.doubt<Real>() : Doubt{};
  return {static_cast<Real>((is_certified ? kShorter : 1.0) / program.lipschitz()),
          epsilon_slope,
          march.max_steps,
          march.finish,
          &cancelled,
          stepping_of(march),
          clamped<Real>(march.min_distance),
          clamped<Real>(march.bias),
          clamped<Real>(march.step),
          std::numeric_limits<Real>::infinity(),
          static_cast<Real>(doubt.offset + march.bias),
          static_cast<Real>(doubt.slope),
          static_cast<Real>(doubt.reach)};
}

/// The same for rays that leave a surface, and begin there.
template <class Real>
kernels::MarchParameters<Real> secondary_parameters(const Program& program, March march, Real epsilon_slope,
                                                    const bool& cancelled) {
  march.min_distance = 0.0;
  return march_parameters(program, march, epsilon_slope, cancelled);
}

/// The same for shadow rays, of which none are certified. Where steps are long, they are as long as lets shadows stay what they are. `k`: of soft ones, +∞
/// for hard ones.
template <class Real>
kernels::MarchParameters<Real> shadow_parameters(const Program& program, March march, Real k, Real epsilon_slope,
                                                 const bool& cancelled) {
  if (march.method == Method::kCertified) march.method = Method::kPlain;
  kernels::MarchParameters<Real> parameters = secondary_parameters(program, march, epsilon_slope, cancelled);
  using kernels::Stepping;
  if (parameters.stepping == Stepping::kRelaxed || parameters.stepping == Stepping::kEnhanced) {
    parameters.stepping = Stepping::kShadow;
  }
  parameters.k = k;
  return parameters;
}

}  // namespace octomarch
