// Crowds of balls: their trees hold all places where the field is little, and rays find the first of these, by every instruction set
// and in any company with the same bits.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <vector>

#include "clouds.hpp"
#include <doctest/doctest.h>

#include "octomarch/kernels/dispatch.hpp"
#include "octomarch/program/ball_tree.hpp"
#include "octomarch/render/buffer.hpp"

namespace octomarch {
namespace {

constexpr bool kNotCancelled = false;

template <class Real>
std::optional<BallTree<Real>> tree_of(const Program& program) {
  return BallTree<Real>::of(program.distance(), kNotCancelled);
}

/// No ball, but one about it is little larger. Turned anyhow, often by quarters.
NodePtr chunk(double radius, Random& random) {
  const std::array<double, 4> kTurns = {90.0, 180.0, 33.0, uniform(random, -180, 180)};
  const Vec3 axis = random() % 2 == 0 ? Vec3{0, 0, 1} : Vec3{uniform(random, 0.1, 1), uniform(random, -1, 1), 0.5};
  const std::array<NodePtr, 4> kinds = {box({radius, 1.1 * radius, 1.2 * radius}),
                                        cylinder(0.8 * radius, 0.9 * radius, {0, 1, 0}),
                                        torus(0.55 * radius, 0.35 * radius, {0, 1, 0}),
                                        capsule({-0.2 * radius, 0, 0}, {0.2 * radius, 0.1 * radius, 0}, 0.7 * radius)};
  return rotate(kinds[random() % kinds.size()], kTurns[random() % kTurns.size()], axis);
}

/// Balls of many sizes, on each other, beside each other and far away, every so many being something else.
std::shared_ptr<const Program> crowd(std::size_t count, double k, unsigned seed, std::size_t odd_every) {
  Random random(seed);
  std::vector<NodePtr> balls;
  Vec3 last{};
  double last_radius = 0.3;
  while (balls.size() < count) {
    Vec3 center{uniform(random, -3, 3), uniform(random, -3, 3), uniform(random, -3, 3)};
    double radius = std::pow(10.0, uniform(random, -2.5, -0.3));
    switch (random() % 5) {
      case 0: {  // a gap of up to 3k to the one before
        const double gap = uniform(random, -0.5, 3.0) * k;
        center = last + Vec3{radius + last_radius + gap, 0, 0};
        break;
      }
      case 1: center = last; break;
      case 2: radius = last_radius; break;
      default: break;
    }
    const bool is_odd = odd_every > 0 && balls.size() % odd_every == 1;
    balls.push_back(translate(is_odd ? chunk(radius, random) : sphere(radius), center));
    last = center;
    last_radius = radius;
  }
  return compile(combine(NodeKind::kUnion, std::move(balls), k));
}

template <class Real>
std::vector<double> fields_at(const Program& program, const std::vector<Vec3>& points) {
  const std::size_t size = kernels::padded_lanes(points.size());
  VectorBuffer<Real> places(size);
  for (std::size_t i = 0; i < points.size(); ++i) {
    places.x[i] = static_cast<Real>(points[i].x);
    places.y[i] = static_cast<Real>(points[i].y);
    places.z[i] = static_cast<Real>(points[i].z);
  }
  const Tape& tape = program.distance();
  const kernels::TapeView<Real> view{tape.code.data(), tape.code.size(), constants_of<Real>(tape),
                                     tape.registers,   tape.result(),    nullptr};
  Buffer<Real> memory(tape.registers * kernels::kLanes);
  Buffer<Real> values(size);
  kernels::available_isas().back().table<Real>().distance(view, memory.data(), places.read(), points.size(),
                                                          &kNotCancelled, values.data());
  return {values.data(), values.data() + points.size()};
}

/// How far a point is from the nearest of a tree's balls.
template <class Real>
double distance_to(const BallTree<Real>& tree, const Vec3& point) {
  double least = kInfinity;
  for (const BallLeaf<Real>& leaf : tree.leaves()) {
    for (std::size_t i = 0; i < kBallsOfLeaf; ++i) {
      const Vec3 way = point - Vec3{leaf.x[i], leaf.y[i], leaf.z[i]};
      least = std::min(least, length(way) - static_cast<double>(leaf.radius[i]));
    }
  }
  return least;
}

/// Around balls, mostly near their surfaces, and between them and others.
std::vector<Vec3> points_about(const BallTree<double>& tree, std::size_t count, double k, Random& random) {
  std::vector<Vec3> points;
  const auto ball = [&](double& radius) {
    for (;;) {
      const BallLeaf<double>& leaf = tree.leaves()[random() % tree.leaves().size()];
      const std::size_t i = random() % kBallsOfLeaf;
      radius = leaf.radius[i];
      if (std::isfinite(radius)) return Vec3{leaf.x[i], leaf.y[i], leaf.z[i]};
    }
  };
  while (points.size() < count) {
    double radius = 0.0;
    const Vec3 center = ball(radius);
    Vec3 way{uniform(random, -1, 1), uniform(random, -1, 1), uniform(random, -1, 1)};
    if (random() % 2 == 0) way = Vec3{1, uniform(random, -0.3, 0.3), uniform(random, -0.3, 0.3)};
    const double shrunk = random() % 4 == 0 ? uniform(random, 0.5, 1.0) : 1.0;
    points.push_back(center + way * ((shrunk * radius + uniform(random, -0.5, 1.5) * k) / length(way)));
  }
  return points;
}

TEST_CASE("where the field of a crowd is little, there is a ball of its tree") {
  Random random(5);  // NOLINT(bugprone-random-generator-seed): the same numbers each time
  std::size_t trees = 0;
  std::size_t near = 0;
  for (unsigned seed = 0; seed < 18; ++seed) {
    for (const double k : {0.0, 0.003, 0.02, 0.06}) {
      const std::shared_ptr<const Program> program = crowd(150, k, seed, std::array{0U, 2U, 5U}[seed % 3]);
      const std::optional<BallTree<double>> tree = tree_of<double>(*program);
      if (!tree) continue;  // more is around balls than in them
      ++trees;
      const std::vector<Vec3> points = points_about(*tree, 4000, std::max(k, 0.01), random);
      const std::vector<double> fields = fields_at<double>(*program, points);
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (fields[i] > 4.0 * k + 0.01) continue;
        // the least epsilon at which the field counts as a surface there
        const double epsilon = std::max(fields[i], 0.0);
        const double more = epsilon > tree->trusted_epsilon() ? tree->blend() : 0.0;
        CHECK(distance_to(*tree, points[i]) <= epsilon + more + 1e-12);
        ++near;
      }
    }
  }
  CHECK(trees > 40);
  CHECK(near > 40'000);
}

TEST_CASE("balls that are alone are no larger than they are, and others by as much as blends may take") {
  const auto radii = [](const Program& program) {
    std::vector<double> all;
    const std::optional<BallTree<double>> tree = tree_of<double>(program);
    REQUIRE(tree);
    for (const BallLeaf<double>& leaf : tree->leaves()) all.insert(all.end(), leaf.radius, leaf.radius + kBallsOfLeaf);
    std::erase(all, -kInfinity);
    return all;
  };
  const auto row = [](double distance) {
    std::vector<NodePtr> balls;
    for (int i = 0; i < 100; ++i) balls.push_back(translate(sphere(0.25), {distance * i, 0, 0}));
    return compile(combine(NodeKind::kUnion, std::move(balls), 0.1));
  };
  for (const double radius : radii(*row(0.8))) CHECK(radius == doctest::Approx(0.25).epsilon(1e-12));
  // over a gap of 2k no ball lowers the other, of which the bound gives up no more than a twentieth of k
  for (const double radius : radii(*row(0.7))) CHECK(radius < 0.25 + 0.05 * 0.1);
  for (const double radius : radii(*row(0.49))) {
    CHECK(radius >= 0.25 + 0.1 / 4 - 0.01);
    CHECK(radius < 0.25 + 0.1 * 0.7);
  }
  for (const double radius : radii(*cloud(200, ball, 0.0))) CHECK(radius <= 0.3 + 1e-12);
}

TEST_CASE("where many balls are in one place, they reach as far as they can be lowered in all") {
  std::vector<NodePtr> balls;
  for (int i = 0; i < 400; ++i) balls.push_back(translate(sphere(0.25), {i < 60 ? 0.001 * i : 2.0 * i, 0, 0}));
  const std::shared_ptr<const Program> program = compile(combine(NodeKind::kUnion, std::move(balls), 0.1));
  const std::optional<BallTree<double>> tree = tree_of<double>(*program);
  REQUIRE(tree);
  Random random(4);  // NOLINT(bugprone-random-generator-seed): the same numbers each time
  std::vector<Vec3> points;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 way{0.0, uniform(random, -1, 1), uniform(random, -1, 1)};
    points.push_back(Vec3{0.03, 0, 0} + way * (uniform(random, 0.25, 0.4) / length(way)));
  }
  const std::vector<double> fields = fields_at<double>(*program, points);
  std::size_t near = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (fields[i] > 0.0) continue;
    CHECK(distance_to(*tree, points[i]) <= 0.0);
    near += length(points[i]) > 0.25 + 0.06 ? 1U : 0U;
  }
  CHECK(near > 100);
}

TEST_CASE_TEMPLATE("nodes hold their balls", Real, float, double) {
  for (const double k : {0.0, 0.06}) {
    const std::optional<BallTree<Real>> tree = tree_of<Real>(*cloud(1000, ball, k));
    REQUIRE(tree);
    std::vector<std::size_t> around;  // nodes, from the first on
    std::size_t leaves = 0;
    const auto visit = [&](const auto& self, std::size_t index) -> void {
      const BallNode<Real>& node = tree->nodes()[index];
      around.push_back(index);
      if (node.is_leaf) {
        ++leaves;
        const BallLeaf<Real>& leaf = tree->leaves()[node.other];
        for (std::size_t i = 0; i < kBallsOfLeaf; ++i) {
          if (std::isinf(leaf.radius[i])) continue;
          for (const std::size_t holder : around) {
            const BallNode<Real>& one = tree->nodes()[holder];
            const Vec3 way = Vec3{leaf.x[i], leaf.y[i], leaf.z[i]} - Vec3{one.center[0], one.center[1], one.center[2]};
            CHECK(length(way) + static_cast<double>(leaf.radius[i]) <= static_cast<double>(one.radius));
          }
        }
      } else {
        self(self, index + 1);
        self(self, node.other);
      }
      around.pop_back();
    };
    visit(visit, 0);
    CHECK(leaves == tree->leaves().size());
  }
}

TEST_CASE("balls that are one are two, and crowds may be united") {
  std::vector<NodePtr> pairs;
  for (int i = 0; i < 50; ++i) {
    const NodePtr one = translate(sphere(0.25), {2.0 * i, 0, 0});
    pairs.insert(pairs.end(), {one, one});
  }
  const auto check = [](const Program& program, std::size_t balls, double radius) {
    const std::optional<BallTree<double>> tree = tree_of<double>(program);
    REQUIRE(tree);
    std::size_t count = 0;
    for (const BallLeaf<double>& leaf : tree->leaves()) {
      for (const double found : leaf.radius) {
        if (found == -kInfinity) continue;
        CHECK(found >= radius);
        ++count;
      }
    }
    CHECK(count == balls);
  };
  check(*compile(combine(NodeKind::kUnion, pairs, 0.1)), 100, 0.25 + 0.1 / 4);  // min(d, d) − k/4
  const auto blended = [](int first) {
    std::vector<NodePtr> balls;
    for (int i = 0; i < 40; ++i) balls.push_back(translate(sphere(0.25), {0.9 * (first + i), 0, 0}));
    return combine(NodeKind::kUnion, std::move(balls), 0.05);
  };
  check(*compile(combine(NodeKind::kUnion, {blended(0), blended(100)}, 0.0)), 80, 0.25);
  // how much a blend of blends takes is not known
  CHECK_FALSE(tree_of<double>(*compile(combine(NodeKind::kUnion, {blended(0), blended(100)}, 0.05))));
}

TEST_CASE_TEMPLATE("only crowds of balls have trees", Real, float, double) {
  CHECK(tree_of<Real>(*cloud(200)));
  CHECK(tree_of<Real>(*cloud(static_cast<int>(BallTree<Real>::kFewest))));
  CHECK_FALSE(tree_of<Real>(*cloud(static_cast<int>(BallTree<Real>::kFewest) - 1)));
  CHECK(tree_of<Real>(*cloud(200, [](Random& random) { return chunk(0.1, random); }, 0.0)));
  CHECK_FALSE(
      tree_of<Real>(*cloud(200, [](Random&) { return box({0.1, 0.2, 0.5}); })));  // balls about them are mostly empty
  CHECK_FALSE(tree_of<Real>(*cloud(200, [](Random&) { return octahedron(0.1); })));
  CHECK_FALSE(tree_of<Real>(
      *cloud(200, [](Random& random) { return random() % 8 == 0 ? cylinder(0.1, {}, {0, 1, 0}) : sphere(0.1); })));
  CHECK_FALSE(tree_of<Real>(*cloud(200, ball, 2.0)));  // all is within reach of blends
  const auto of_balls = [](NodeKind kind, double size, double k) {
    std::vector<NodePtr> balls;
    for (int i = 0; i < 100; ++i) balls.push_back(translate(sphere(size), {4 * size * i, 0, 0}));
    return compile(combine(kind, std::move(balls), k));
  };
  CHECK(tree_of<Real>(*of_balls(NodeKind::kUnion, 1.0, 0.0)));
  CHECK_FALSE(tree_of<Real>(*of_balls(NodeKind::kIntersection, 1.0, 0.0)));
  CHECK_FALSE(tree_of<Real>(*of_balls(NodeKind::kDifference, 1.0, 0.0)));
  CHECK_FALSE(tree_of<Real>(*of_balls(NodeKind::kMetaballs, 1.0, 0.1)));
  // squares of its numbers are none in float
  CHECK(tree_of<Real>(*of_balls(NodeKind::kUnion, 1e-9, 0.0)));
  CHECK(tree_of<Real>(*of_balls(NodeKind::kUnion, 1e20, 0.0)).has_value() == (sizeof(Real) == 8));
  CHECK(tree_of<Real>(*of_balls(NodeKind::kUnion, 1e-20, 0.0)).has_value() == (sizeof(Real) == 8));
}

TEST_CASE("what is cancelled is made when it is asked for again") {
  const std::shared_ptr<const Program> program = cloud(3000);
  const bool cancelled = true;
  CHECK(program->balls<float>(cancelled) == nullptr);
  const BallTree<float>* const tree = program->balls<float>(kNotCancelled);
  REQUIRE(tree != nullptr);
  CHECK(program->balls<float>(cancelled) == tree);
  CHECK(program->balls<float>(kNotCancelled) == tree);
  CHECK(cloud(10)->balls<float>(kNotCancelled) == nullptr);
}

// Rays ---------------------------------------------------------------------------------------------------------------------------

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
