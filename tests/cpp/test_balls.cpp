// Rays find where they first come near to the balls of a tree, by every instruction set and in any company with the same bits.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <vector>

#include "ball_trees.hpp"
#include "clouds.hpp"
#include <doctest/doctest.h>

namespace octomarch {
namespace {

constexpr std::size_t kBlocks = 6;
constexpr std::size_t kRays = kBlocks * kernels::kLanes;

template <class Real>
struct Rays {
  VectorBuffer<Real> origin{kRays}, direction{kRays};
  Buffer<Real> epsilon{kRays}, t_max{kRays};

  void set(std::size_t i, const Vec3& from, const Vec3& toward) {
    const double per_length = 1.0 / length(toward);
    origin.x[i] = static_cast<Real>(from.x);
    origin.y[i] = static_cast<Real>(from.y);
    origin.z[i] = static_cast<Real>(from.z);
    direction.x[i] = static_cast<Real>(toward.x * per_length);
    direction.y[i] = static_cast<Real>(toward.y * per_length);
    direction.z[i] = static_cast<Real>(toward.z * per_length);
  }
  Vec3 at(std::size_t i, double t) const {
    return Vec3{origin.x[i], origin.y[i], origin.z[i]} + Vec3{direction.x[i], direction.y[i], direction.z[i]} * t;
  }
  kernels::RayView<Real> view(Real start) const {
    const auto column = [](const Buffer<Real>& row) { return kernels::Column<Real>{row.data(), 0}; };
    return {column(origin.x),    column(origin.y), column(origin.z), column(direction.x), column(direction.y),
            column(direction.z), {nullptr, start}, column(t_max),    column(epsilon),     kRays};
  }
};

enum class Camera { kPinhole, kParallel, kInside, kAnywhere };

template <class Real>
Rays<Real> rays_of(Camera camera, std::size_t none_every) {
  Random random(8);  // NOLINT(bugprone-random-generator-seed): the same numbers each time
  Rays<Real> rays;
  for (std::size_t i = 0; i < kRays; ++i) {
    const std::size_t lane = i % kernels::kLanes;
    const std::size_t column = i / kernels::kLanes * kernels::kBlockEdge + kernels::lane_column(lane);
    const double x = 0.05 * static_cast<double>(column) - 1.2;
    const double y = 0.05 * static_cast<double>(kernels::lane_row(lane)) - 0.2;
    const auto any = [&random] { return Vec3{uniform(random, -3, 3), uniform(random, -3, 3), uniform(random, -3, 3)}; };
    switch (camera) {
      case Camera::kPinhole: rays.set(i, {0.5, 0.25, 8}, Vec3{x, y, -8}); break;
      case Camera::kParallel: rays.set(i, {2 * x, 2 * y, 8}, {0.1, 0.2, -1}); break;
      case Camera::kInside: rays.set(i, {0.1, 0.2, 0.3}, {x, 1, y}); break;
      case Camera::kAnywhere: rays.set(i, any(), any()); break;
    }
    rays.epsilon[i] = static_cast<Real>(uniform(random, 1e-5, 1e-3));
    rays.t_max[i] = Real(30);
    if (none_every > 0 && i % none_every < none_every / 2) rays.direction.y[i] = std::numeric_limits<Real>::quiet_NaN();
  }
  return rays;
}

template <class Real>
struct Entered {
  Buffer<Real> start{kRays}, end{kRays};
};

template <class Real>
Entered<Real> enter(const kernels::Isa& isa, const BallTree<Real>& tree, const Rays<Real>& rays, Real start) {
  VectorBuffer<Real> origin(kernels::kLanes), direction(kernels::kLanes);
  Buffer<Real> width(kernels::kLanes), spread(kernels::kLanes), epsilon(kernels::kLanes), t_max(kernels::kLanes);
  const kernels::ConeView<Real> cones{origin.view(), direction.view(), width.data(),
                                      spread.data(), epsilon.data(),   t_max.data()};
  isa.table<Real>().fit_cones(rays.view(start), cones);
  const kernels::BallsView<Real> view{tree.nodes().data(), tree.leaves().data(), tree.blend(), tree.trusted_epsilon()};
  Entered<Real> entered;
  std::fill_n(entered.end.data(), kRays, Real(30));
  for (std::size_t block = 0; block < kBlocks; ++block) {
    const std::size_t first = block * kernels::kLanes;
    isa.table<Real>().enter_balls(view, rays.view(start), block, cones, Real(1e-4), entered.start.data() + first,
                                  entered.end.data() + first);
  }
  return entered;
}

template <class Real>
void check_starts(const Program& program, const Rays<Real>& rays, const Entered<Real>& entered, Real start) {
  Random random(3);  // NOLINT(bugprone-random-generator-seed): the same numbers each time
  std::vector<Vec3> points;
  std::vector<double> epsilons;
  std::size_t met = 0;
  for (std::size_t i = 0; i < kRays; ++i) {
    if (std::isnan(rays.direction.y[i])) {
      CHECK(entered.start[i] == start);
      CHECK(entered.end[i] == Real(-1));
      continue;
    }
    const bool meets = entered.end[i] >= Real(0);
    met += meets ? 1U : 0U;
    CHECK(entered.start[i] >= start);
    if (!meets) CHECK(entered.start[i] == start);
    const auto from = static_cast<double>(start);
    const double free = meets ? static_cast<double>(entered.start[i]) : 30.0;
    for (int sample = 0; sample < 60 && free > from; ++sample) {
      const double t = sample == 0 ? free * (1 - 1e-6) : uniform(random, from, free);
      points.push_back(rays.at(i, t));
      epsilons.push_back(std::max(static_cast<double>(rays.epsilon[i]), 1e-4 * t));
    }
  }
  const std::vector<double> fields = fields_at<double>(program, points);
  for (std::size_t i = 0; i < points.size(); ++i) CHECK(fields[i] > epsilons[i]);
  CHECK(points.size() > 1000);
  CHECK(met > 10);
}

TEST_CASE_TEMPLATE("before a ray is within reach of balls there is no hit", Real, float, double) {
  for (const double k : {0.0, 0.02, 0.06}) {
    const std::shared_ptr<const Program> program = cloud(180, ball, k);
    const std::optional<BallTree<Real>> tree = tree_of<Real>(*program);
    REQUIRE(tree);
    for (const Camera camera : {Camera::kPinhole, Camera::kParallel, Camera::kInside, Camera::kAnywhere}) {
      for (const std::size_t none_every : {std::size_t{0}, std::size_t{3}}) {
        for (const Real start : {Real(0), Real(2.5)}) {
          CAPTURE(k);
          CAPTURE(static_cast<int>(camera));
          const Rays<Real> rays = rays_of<Real>(camera, none_every);
          check_starts(*program, rays, enter(kernels::available_isas().back(), *tree, rays, start), start);
        }
      }
    }
  }
}

template <class Real>
void check_same(const Buffer<Real>& a, const Buffer<Real>& b) {
  for (std::size_t i = 0; i < kRays; ++i) {
    CHECK(a[i] == b[i]);
    CHECK(std::signbit(a[i]) == std::signbit(b[i]));
  }
}

TEST_CASE("rays that begin within reach begin where they are, however many balls hold them") {
  std::vector<NodePtr> balls;
  for (int i = 0; i < 5000; ++i) balls.push_back(translate(sphere(1.0 + 1e-4 * i), {1e-5 * i, 0, 0}));
  const std::shared_ptr<const Program> program = compile(combine(NodeKind::kUnion, std::move(balls), 0.0));
  const std::optional<BallTree<float>> tree = tree_of<float>(*program);
  REQUIRE(tree);
  for (const float start : {0.0F, 0.25F}) {
    const Entered<float> entered =
        enter(kernels::available_isas().back(), *tree, rays_of<float>(Camera::kInside, 0), start);
    for (std::size_t i = 0; i < kRays; ++i) CHECK(entered.start[i] == start);
  }
}

TEST_CASE_TEMPLATE("every instruction set finds the same bits, in any company", Real, float, double) {
  const std::optional<BallTree<Real>> tree = tree_of<Real>(*cloud(1000));
  REQUIRE(tree);
  for (const Camera camera : {Camera::kPinhole, Camera::kParallel, Camera::kInside, Camera::kAnywhere}) {
    CAPTURE(static_cast<int>(camera));
    const Rays<Real> rays = rays_of<Real>(camera, 5);
    std::vector<std::size_t> order(kRays);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::shuffle(order, Random(1));  // NOLINT(bugprone-random-generator-seed): the same each time
    Rays<Real> mixed;
    for (std::size_t i = 0; i < kRays; ++i) {
      for (auto row : {&VectorBuffer<Real>::x, &VectorBuffer<Real>::y, &VectorBuffer<Real>::z}) {
        (mixed.origin.*row)[i] = (rays.origin.*row)[order[i]];
        (mixed.direction.*row)[i] = (rays.direction.*row)[order[i]];
      }
      mixed.epsilon[i] = rays.epsilon[order[i]];
      mixed.t_max[i] = rays.t_max[order[i]];
    }
    const Entered<Real> expected = enter(kernels::available_isas().front(), *tree, rays, Real(0));
    for (const kernels::Isa& isa : kernels::available_isas()) {
      CAPTURE(isa.name);
      const Entered<Real> entered = enter(isa, *tree, rays, Real(0));
      check_same(entered.start, expected.start);
      check_same(entered.end, expected.end);
      const Entered<Real> of_mixed = enter(isa, *tree, mixed, Real(0));
      for (std::size_t i = 0; i < kRays; ++i) {
        CHECK(of_mixed.start[i] == expected.start[order[i]]);
        CHECK(of_mixed.end[i] == expected.end[order[i]]);
      }
    }
  }
}

}  // namespace
}  // namespace octomarch
