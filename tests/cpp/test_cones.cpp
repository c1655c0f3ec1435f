// Cones about camera rays hold them, by every instruction set with the same bits.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "parts.hpp"
#include <doctest/doctest.h>

#include "octomarch/kernels/dispatch.hpp"
#include "octomarch/render/buffer.hpp"

namespace octomarch {
namespace {

constexpr std::size_t kBlocks = 3;
constexpr std::size_t kRays = kBlocks * kernels::kLanes;

template <class Real>
struct SomeRays {
  VectorBuffer<Real> origin{kRays}, direction{kRays};
  Buffer<Real> epsilon{kRays}, t_max{kRays};

  kernels::RayView<Real> view() const {
    const auto column = [](const Buffer<Real>& row) { return kernels::Column<Real>{row.data(), 0}; };
    return {column(origin.x),
            column(origin.y),
            column(origin.z),
            column(direction.x),
            column(direction.y),
            column(direction.z),
            {},
            column(t_max),
            column(epsilon),
            kRays};
  }
};

/// Of pixels side by side, blocks in a row; every so many is NaN, as outside of the picture.
template <class Real>
SomeRays<Real> rays_of_camera(bool share_origin, double disorder, std::size_t none_every) {
  Random random(11);  // NOLINT(bugprone-random-generator-seed): the same numbers each time
  const auto shake = [&] { return uniform(random, -disorder, disorder); };
  SomeRays<Real> rays;
  for (std::size_t i = 0; i < kRays; ++i) {
    const std::size_t block = i / kernels::kLanes;
    const std::size_t lane = i % kernels::kLanes;
    const auto x = static_cast<double>(block * kernels::kBlockEdge + kernels::lane_column(lane));
    const auto y = static_cast<double>(kernels::lane_row(lane));
    const std::array<double, 3> at{0.01 * x - 0.3 + shake(), 0.02 * y + 0.1 + shake(), 1.0 + shake()};
    const double length = share_origin ? std::hypot(at[0], at[1], at[2]) : 1.0;
    VectorBuffer<Real>& spread = share_origin ? rays.direction : rays.origin;
    VectorBuffer<Real>& same = share_origin ? rays.origin : rays.direction;
    spread.x[i] = static_cast<Real>(at[0] / length);
    spread.y[i] = static_cast<Real>(at[1] / length);
    spread.z[i] = static_cast<Real>(at[2] / length);
    same.x[i] = Real(0.6);
    same.z[i] = Real(-0.8);
    rays.epsilon[i] = static_cast<Real>(1e-3 + shake() * shake());
    rays.t_max[i] = static_cast<Real>(50.0 + shake());
    if (none_every > 0 && i % none_every < none_every / 2) {
      spread.x[i] = std::numeric_limits<Real>::quiet_NaN();
    }
  }
  return rays;
}

template <class Real>
struct SomeCones {
  explicit SomeCones(std::size_t of_block)
      : edge(kernels::kBlockEdge / static_cast<std::size_t>(std::lround(std::sqrt(of_block)))),
        count(kBlocks * of_block) {}

  std::size_t edge;
  std::size_t count;
  VectorBuffer<Real> origin{kRays}, direction{kRays};
  Buffer<Real> width{kRays}, spread{kRays}, epsilon{kRays}, t_max{kRays};

  kernels::ConeView<Real> view() {
    return {origin.view(), direction.view(), width.data(), spread.data(), epsilon.data(), t_max.data()};
  }
  std::vector<Real> numbers() const {
    std::vector<Real> all;
    for (const Buffer<Real>* row : {&origin.x, &origin.y, &origin.z, &direction.x, &direction.y, &direction.z, &width,
                                    &spread, &epsilon, &t_max}) {
      all.insert(all.end(), row->data(), row->data() + count);
    }
    return all;
  }
};

template <class Real>
struct Fitted {
  SomeCones<Real> blocks{1}, small{kernels::kSmallCones}, smallest{kernels::kSmallestCones};
};

template <class Real>
Fitted<Real> fit(const kernels::Isa& isa, const SomeRays<Real>& rays) {
  Fitted<Real> fitted;
  isa.table<Real>().fit_cones(rays.view(), fitted.blocks.view());
  for (std::size_t block = 0; block < kBlocks; ++block) {
    isa.table<Real>().fit_small_cones(rays.view(), block, fitted.small.view(), fitted.smallest.view());
  }
  return fitted;
}

/// The cone about a ray by the rows and columns of its pixel.
template <class Real>
std::size_t cone_about(const SomeCones<Real>& cones, std::size_t ray) {
  const std::size_t block = ray / kernels::kLanes;
  const std::size_t column = kernels::lane_column(ray % kernels::kLanes);
  const std::size_t row = kernels::lane_row(ray % kernels::kLanes);
  if (cones.edge == 8) return block;
  const std::size_t quarter = row / 4 * 2 + column / 4;
  if (cones.edge == 4) return block * 4 + quarter;
  return block * 16 + (row / 2 % 2 * 2 + column / 2 % 2) * 4 + quarter;
}

template <class Real>
double apart(const VectorBuffer<Real>& a, std::size_t i, const VectorBuffer<Real>& b, std::size_t j) {
  const auto off = [&](const Buffer<Real>& of_a, const Buffer<Real>& of_b) {
    return static_cast<double>(of_a[i]) - static_cast<double>(of_b[j]);
  };
  return std::hypot(off(a.x, b.x), off(a.y, b.y), off(a.z, b.z));
}

template <class Real>
void check_that_rays_are_held(const SomeRays<Real>& rays, const SomeCones<Real>& cones) {
  const double rounding = 8.0 * static_cast<double>(std::numeric_limits<Real>::epsilon());
  for (std::size_t ray = 0; ray < kRays; ++ray) {
    if (std::isnan(rays.origin.x[ray]) || std::isnan(rays.direction.x[ray])) continue;
    const std::size_t cone = cone_about(cones, ray);
    CHECK(apart(rays.origin, ray, cones.origin, cone) <= static_cast<double>(cones.width[cone]) + rounding);
    CHECK(apart(rays.direction, ray, cones.direction, cone) <= static_cast<double>(cones.spread[cone]) + rounding);
    CHECK(rays.epsilon[ray] <= cones.epsilon[cone]);
    CHECK(rays.t_max[ray] <= cones.t_max[cone]);
  }
}

TEST_CASE_TEMPLATE("cones hold their rays", Real, float, double) {
  for (const bool share_origin : {true, false}) {
    for (const double disorder : {0.0, 0.05}) {
      for (const std::size_t none_every : {std::size_t{0}, std::size_t{2}, std::size_t{3}, kernels::kLanes}) {
        CAPTURE(share_origin);
        CAPTURE(disorder);
        CAPTURE(none_every);
        const SomeRays<Real> rays = rays_of_camera<Real>(share_origin, disorder, none_every);
        const Fitted<Real> fitted = fit<Real>(kernels::available_isas().back(), rays);
        check_that_rays_are_held(rays, fitted.blocks);
        check_that_rays_are_held(rays, fitted.small);
        check_that_rays_are_held(rays, fitted.smallest);
        for (const kernels::Isa& isa : kernels::available_isas()) {
          const Fitted<Real> other = fit<Real>(isa, rays);
          for (auto cones : {&Fitted<Real>::small, &Fitted<Real>::smallest, &Fitted<Real>::blocks}) {
            const std::vector<Real> expected = (fitted.*cones).numbers();
            const std::vector<Real> found = (other.*cones).numbers();
            CHECK(std::equal(found.begin(), found.end(), expected.begin(),
                             [](Real a, Real b) { return a == b || (std::isnan(a) && std::isnan(b)); }));
          }
        }
      }
    }
  }
}

TEST_CASE_TEMPLATE("cones are as narrow as their pixels", Real, float, double) {
  const SomeRays<Real> rays = rays_of_camera<Real>(false, 0.0, 0);
  const Fitted<Real> fitted = fit<Real>(kernels::available_isas().front(), rays);
  for (const SomeCones<Real>* cones : {&fitted.blocks, &fitted.small, &fitted.smallest}) {
    const double half_diagonal = 0.5 * std::hypot(0.01, 0.02) * static_cast<double>(cones->edge - 1);
    for (std::size_t i = 0; i < cones->count; ++i) {
      CHECK(static_cast<double>(cones->width[i]) == doctest::Approx(half_diagonal).epsilon(1e-4));
      CHECK(cones->spread[i] == Real(0));
    }
  }
}

TEST_CASE_TEMPLATE("a cone of no rays is NaN, one of one has no width", Real, float, double) {
  SomeRays<Real> rays = rays_of_camera<Real>(true, 0.0, 0);
  constexpr std::size_t kOne = kernels::kLanes + 5;
  for (std::size_t i = 0; i < kRays; ++i) {
    if (i != kOne) rays.direction.y[i] = std::numeric_limits<Real>::quiet_NaN();
  }
  for (const kernels::Isa& isa : kernels::available_isas()) {
    const Fitted<Real> fitted = fit<Real>(isa, rays);
    for (const SomeCones<Real>* cones : {&fitted.blocks, &fitted.small, &fitted.smallest}) {
      for (std::size_t i = 0; i < cones->count; ++i) {
        if (i != cone_about(*cones, kOne)) CHECK(std::isnan(cones->direction.y[i]));
      }
      const std::size_t about = cone_about(*cones, kOne);
      CHECK(cones->direction.y[about] == rays.direction.y[kOne]);
      CHECK(cones->epsilon[about] >= rays.epsilon[kOne]);
    }
  }
}

}  // namespace
}  // namespace octomarch
