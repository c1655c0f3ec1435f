// render/cell_sweep.hpp: rays pass from cell to cell from front to back, until all have ended.
#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <map>
#include <span>
#include <thread>
#include <vector>

#include "parts.hpp"
#include <doctest/doctest.h>

#include "octomarch/render/cell_sweep.hpp"

namespace octomarch {
namespace {

/// Shapes all over a cube, so that cells have something to cut; no lanes run them, so that no ray goes alone.
auto compiled_cloud() {
  Random random(12);  // NOLINT(bugprone-random-generator-seed): the same numbers each time
  const auto place = [&] { return uniform(random, -4.0, 4.0); };
  std::vector<NodePtr> balls;
  for (int i = 0; i < 400; ++i) {
    const double x = place();
    const double y = place();
    balls.push_back(translate(twist(box({0.1, 0.1, 0.1}), 10, 1), {x, y, place()}));
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

  std::size_t ended() const { return static_cast<std::size_t>(std::ranges::count(left, 0)); }
};

/// Walkers from one side of the cube through it, away from an octant.
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

template <class Real>
class Sweeper {
 public:
  using Visits = std::map<std::array<Real, 6>, int>;

  explicit Sweeper(Octree<Real>& octree)
      : octree_(octree), runner_(octree.tape()), choice_(octree, runner_), sweep_(choice_) {}

  /// Moves all until their ends, and returns how often each cell, known by its region, was visited. move(i) moves one by a step.
  /// `patience`: steps in a row at the most.
  template <class Move>
  Visits run(Walkers<Real>& walkers, unsigned nearest, Move&& move, int patience = 1000) {
    Visits visits;
    const std::uint64_t before = stage_.cells_visited;
    choice_.begin(kStayOfRay, is_cancelled_, stage_);
    for (std::size_t i = 0; i < walkers.at.size(); ++i) wait(walkers, i);
    sweep_.run(
        nearest,
        [&](const TapePart& part, const Region<Real>& region, std::span<const Way> rays) {
          CHECK(part.length <= octree_.tape().code.size());
          CHECK(part.code[part.length - 1].op < Opcode{kOpcodeCount});
          ++visits[{region.lo[0], region.lo[1], region.lo[2], region.hi[0], region.hi[1], region.hi[2]}];
          marched_ += rays.size();
          for (const Way way : rays) {
            const std::size_t i = way.element();
            const auto is_within = [&] {
              return contains(region, walkers.at[i][0], walkers.at[i][1], walkers.at[i][2]);
            };
            REQUIRE(is_within());
            for (int step = 0; step < patience && walkers.left[i] > 0 && is_within(); ++step) {
              move(i);
              --walkers.left[i];
            }
            if (walkers.left[i] > 0) wait(walkers, i);
          }
          if (--until_cancelled_ == 0) is_cancelled_ = true;
        },
        [](std::span<const Way> /*alone*/) { FAIL("the tape is no chain"); });
    int sum = 0;
    for (const auto& visit : visits) sum += visit.second;
    if (!is_cancelled_) CHECK(stage_.cells_visited - before == static_cast<std::uint64_t>(sum));
    return visits;
  }

  void cancel_after(int visits) { until_cancelled_ = visits; }
  void go_on() { is_cancelled_ = false; }
  /// Rays of all visits.
  std::size_t marched() const { return marched_; }

 private:
  void wait(const Walkers<Real>& walkers, std::size_t i) {
    sweep_.add(i, walkers.at[i][0], walkers.at[i][1], walkers.at[i][2]);
  }

  Octree<Real>& octree_;
  Runner<Real> runner_;
  CellChoice<Real> choice_;
  CellSweep<Real> sweep_;
  StageStats stage_;
  bool is_cancelled_ = false;
  int until_cancelled_ = 0;
  std::size_t marched_ = 0;
};

/// Moves a walker on by its step, so many times.
template <class Real>
void walk(Walkers<Real>& walkers, std::size_t i, Real times = 1) {
  for (unsigned axis = 0; axis < 3; ++axis) walkers.at[i][axis] += times * walkers.step[i][axis];
}

TEST_CASE_TEMPLATE("rays that go one way visit each cell once", Real, float, double) {
  Random random(13);  // NOLINT(bugprone-random-generator-seed): likewise
  const auto program = compiled_cloud();
  for (unsigned nearest = 0; nearest < 8; ++nearest) {
    Octree<Real> octree(program->distance(), *program->focus());
    Sweeper<Real> sweeper(octree);
    std::size_t visited = 0;
    for (int round = 0; round < 3; ++round) {  // cells are made, then found
      Walkers<Real> walkers = through_the_cloud<Real>(nearest, random);
      const auto visits = sweeper.run(walkers, nearest, [&](std::size_t i) { walk(walkers, i); });
      CHECK(walkers.ended() == 500);
      // but for the cube about the focus, which is left for the focus and come back to
      CHECK(std::ranges::count_if(visits, [](const auto& visit) { return visit.second > 1; }) <= 1);
      visited += visits.size();
    }
    CHECK(visited > 50);
    CHECK(octree.cells() > Octree<Real>::kTops + 50);
  }
}

TEST_CASE_TEMPLATE("rays that go back and forth, or stop within a cell, are all marched to their ends", Real, float,
                   double) {
  constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
  const auto program = compiled_cloud();
  const std::size_t most_bytes = 1 << 20;
  for (const std::size_t bytes : {most_bytes, std::size_t{0}}) {  // no cell stays where there is no memory
    Octree<Real> octree(program->distance(), *program->focus(), bytes);
    Sweeper<Real> sweeper(octree);
    Random random(14);  // NOLINT(bugprone-random-generator-seed): likewise
    for (int round = 0; round < 3; ++round) {
      Walkers<Real> walkers = through_the_cloud<Real>(round % 2 == 0 ? 0 : 5, random);
      walkers.at[7] = {std::numeric_limits<Real>::quiet_NaN(), 0, 0};  // is left out
      walkers.at[8] = {std::numeric_limits<Real>::max(), 0, 0};        // is in none of the tops
      walkers.at[9] = {0, -kInfinity, 0};                              // likewise
      const auto move = [&](std::size_t i) { walk(walkers, i, walkers.left[i] % 5 == 0 ? Real(-3) : Real(1)); };
      const auto visits = sweeper.run(walkers, 0, move, 2);
      CHECK(walkers.ended() == 499);
      CHECK(walkers.left[7] == 60);
      CHECK(visits.size() > 20);
    }
    CHECK((octree.cells() > 1 + Octree<Real>::kTops) == (bytes > 0));
  }
}

TEST_CASE("a sweep that is cancelled ends, and leaves no rays for the next") {
  Random random(15);  // NOLINT(bugprone-random-generator-seed): likewise
  const auto program = compiled_cloud();
  Octree<float> octree(program->distance(), *program->focus());
  Sweeper<float> sweeper(octree);
  for (int round = 0; round < 4; ++round) {
    Walkers<float> walkers = through_the_cloud<float>(0, random);
    const auto move = [&](std::size_t i) { walk(walkers, i); };
    sweeper.cancel_after(1 + 3 * round);
    CHECK(sweeper.run(walkers, 0, move).size() <= 1U + 3U * static_cast<unsigned>(round));
    CHECK(walkers.ended() < 500);
    sweeper.go_on();
    Walkers<float> nobody;
    const std::size_t before = sweeper.marched();
    CHECK(sweeper.run(nobody, 0, move).empty());
    CHECK(sweeper.marched() == before);
  }
}

TEST_CASE_TEMPLATE("threads that sweep one octree lose no rays", Real, float, double) {
  const auto program = compiled_cloud();
  Octree<Real> octree(program->distance(), *program->focus());
  constexpr std::size_t kThreads = 4;
  std::array<std::size_t, kThreads> ended{};
  {
    std::vector<std::jthread> threads;
    for (std::size_t thread = 0; thread < kThreads; ++thread) {
      threads.emplace_back([&, thread] {
        Random random(thread / 2);  // two and two have the same rays
        Sweeper<Real> sweeper(octree);
        for (unsigned round = 0; round < 8; ++round) {
          Walkers<Real> walkers = through_the_cloud<Real>(round, random);
          sweeper.run(walkers, round, [&](std::size_t i) { walk(walkers, i); });
          ended[thread] += walkers.ended();
        }
      });
    }
  }
  for (const std::size_t count : ended) CHECK(count == 8 * 500);
}

}  // namespace
}  // namespace octomarch
