// Trees of balls hold all places where the field of a crowd is little, and crowds alone have them.
#include <algorithm>
#include <array>
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

}  // namespace
}  // namespace octomarch
