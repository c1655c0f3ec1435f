// render/cell_sweep.hpp: rays pass from cell to cell from front to back, until all have ended.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include "parts.hpp"
#include <doctest/doctest.h>

#include "octomarch/render/cell_sweep.hpp"

namespace octomarch {
namespace {

/// Balls all over a cube, so that cells have something to cut.
auto compiled_cloud() {
  Random random(12);  // NOLINT(bugprone-random-generator-seed): the same numbers each time
  std::vector<NodePtr> balls;
  for (int i = 0; i < 400; ++i) {
    balls.push_back(
        translate(sphere(0.1), {uniform(random, -4.0, 4.0), uniform(random, -4.0, 4.0), uniform(random, -4.0, 4.0)}));
  }
  return compile(combine(NodeKind::kUnion, std::move(balls), 0.0));
}

/// Rays as points that move.
template <class Real>
struct Walkers {
  using Point = std::array<Real, 3>;
  std::vector<Point> at;
  std::vector<Point> step;
  std::vector<int> left;  ///< steps until the end
};

template <class Real>
class Sweeper {
 public:
  explicit Sweeper(const Tape& tape, const Aabb& focus)
      : runner_(tape), octree_(tape, focus), choice_(octree_, runner_), sweep_(choice_) {}

  /// Moves all until their ends, and returns how often each cell, known by its region, was visited. move(i) moves one by a step.
  template <class Move>
  std::map<std::array<Real, 6>, int> run(Walkers<Real>& walkers, unsigned nearest, Move&& move) {
    std::map<std::array<Real, 6>, int> visits;
    choice_.begin(3.0, never_, stage_);
    for (std::size_t i = 0; i < walkers.at.size(); ++i) wait(walkers, i);
    sweep_.run(nearest, [&](const TapePart& part, const Region<Real>& region, std::span<const Way> rays) {
      CHECK(part.length <= octree_.tape().code.size());
      ++visits[{region.lo[0], region.lo[1], region.lo[2], region.hi[0], region.hi[1], region.hi[2]}];
      for (const Way way : rays) {
        const std::size_t i = way.element();
        const auto is_within = [&] { return contains(region, walkers.at[i][0], walkers.at[i][1], walkers.at[i][2]); };
        REQUIRE(is_within());
        while (walkers.left[i] > 0 && is_within()) {
          move(i);
          --walkers.left[i];
        }
        if (walkers.left[i] > 0) wait(walkers, i);
      }
    });
    return visits;
  }

  std::size_t cells() const { return octree_.cells(); }
  StageStats& stage() { return stage_; }
  void cancel_all() { never_ = true; }

 private:
  void wait(const Walkers<Real>& walkers, std::size_t i) {
    sweep_.add(i, walkers.at[i][0], walkers.at[i][1], walkers.at[i][2]);
  }

  Runner<Real> runner_;
  Octree<Real> octree_;
  CellChoice<Real> choice_;
  CellSweep<Real> sweep_;
  StageStats stage_;
  bool never_ = false;
};

/// Walkers from about a point beside the cube through it, with steps that have the signs of `octant`'s axes reversed.
template <class Real>
Walkers<Real> through_the_cloud(unsigned nearest, Random& random) {
  Walkers<Real> walkers;
  for (int i = 0; i < 500; ++i) {
    std::array<Real, 3> at;
    std::array<Real, 3> step;
    for (unsigned axis = 0; axis < 3; ++axis) {
      const double sign = (nearest >> axis & 1U) != 0 ? -1.0 : 1.0;
      at[axis] = static_cast<Real>(-sign * uniform(random, 3.0, 6.0));
      step[axis] = static_cast<Real>(sign * uniform(random, 0.05, 0.2));
    }
    walkers.at.push_back(at);
    walkers.step.push_back(step);
    walkers.left.push_back(60);
  }
  return walkers;
}

TEST_CASE_TEMPLATE("rays that go one way visit each cell once", Real, float, double) {
  Random random(13);  // NOLINT(bugprone-random-generator-seed): likewise
  const auto program = compiled_cloud();
  for (unsigned nearest = 0; nearest < 8; ++nearest) {
    Sweeper<Real> sweeper(program->distance(), *program->focus());
    std::size_t visited = 0;
    for (int round = 0; round < 3; ++round) {  // cells are made, then found
      Walkers<Real> walkers = through_the_cloud<Real>(nearest, random);
      const auto visits = sweeper.run(walkers, nearest, [&](std::size_t i) {
        for (unsigned axis = 0; axis < 3; ++axis) walkers.at[i][axis] += walkers.step[i][axis];
      });
      CHECK(std::ranges::all_of(walkers.left, [](int left) { return left == 0; }));
      // but for the cube about the focus, which is left for the focus and come back to
      const auto often = std::ranges::count_if(visits, [](const auto& visit) { return visit.second > 1; });
      CHECK(often <= 1);
      visited += visits.size();
    }
    CHECK(visited > 50);
    CHECK(sweeper.stage().cells_visited >= visited);
  }
}

TEST_CASE_TEMPLATE("rays that go back and forth are all marched to their ends", Real, float, double) {
  Random random(14);  // NOLINT(bugprone-random-generator-seed): likewise
  const auto program = compiled_cloud();
  Sweeper<Real> sweeper(program->distance(), *program->focus());
  Walkers<Real> walkers = through_the_cloud<Real>(0, random);
  walkers.at[7] = {std::numeric_limits<Real>::quiet_NaN(), 0, 0};  // is left out
  walkers.at[8] = {std::numeric_limits<Real>::max(), 0, 0};        // is in none of the tops
  const auto visits = sweeper.run(walkers, 0, [&](std::size_t i) {
    const Real sign = walkers.left[i] % 5 == 0 ? Real(-3) : Real(1);
    for (unsigned axis = 0; axis < 3; ++axis) walkers.at[i][axis] += sign * walkers.step[i][axis];
  });
  CHECK(std::ranges::count_if(walkers.left, [](int left) { return left == 0; }) == 499);
  CHECK(walkers.left[7] == 60);
  CHECK(visits.size() > 20);
}

TEST_CASE("a sweep that is cancelled leaves rays where they are, and none for the next") {
  Random random(15);  // NOLINT(bugprone-random-generator-seed): likewise
  const auto program = compiled_cloud();
  Sweeper<float> sweeper(program->distance(), *program->focus());
  Walkers<float> walkers = through_the_cloud<float>(0, random);
  sweeper.cancel_all();
  const auto visits = sweeper.run(walkers, 0, [](std::size_t) {});
  CHECK(visits.empty());
  CHECK(std::ranges::all_of(walkers.left, [](int left) { return left == 60; }));
  walkers.at.clear();
  CHECK(sweeper.run(walkers, 0, [](std::size_t) {}).empty());
}

}  // namespace
}  // namespace octomarch
