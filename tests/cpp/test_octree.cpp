// program/octree.hpp: cells and their parts, whoever makes them, and which tapes are worth them.
#include <array>
#include <memory>
#include <vector>

#include "parts.hpp"
#include <doctest/doctest.h>

#include "octomarch/program/octree.hpp"
#include "octomarch/render/cell_groups.hpp"

namespace octomarch {
namespace {

TEST_CASE_TEMPLATE("an octree finds the same part in every thread's pruner", Real, float, double) {
  const auto program = compile(row_of_balls(40, 0.25));
  const Tape& tape = program->distance();
  Octree<Real> octree(tape, *program->focus());
  Runner<Real> runner(tape);
  CellMaker<Real> first(octree, runner);
  CellMaker<Real> second(octree, runner);
  typename Octree<Real>::Cell* cell = &octree.tops().front().cell;
  typename Octree<Real>::Place place{octree.tops().data(), 0, {}};
  while (!cell->is_leaf) {
    place = place.child(7);
    typename Octree<Real>::Cell& child = first.child(*cell, place, 7);
    CHECK(&second.child(*cell, place, 7) == &child);
    CHECK(child.part.length <= cell->part.length);
    cell = &child;
  }
  CHECK(octree.cells() > 2);
  CHECK(octree.bytes() > 0);
}

TEST_CASE_TEMPLATE("a full octree groups points as one that is not", Real, float, double) {
  Random random(6);  // NOLINT(bugprone-random-generator-seed): the same numbers each time
  const auto program = compile(row_of_balls(2000, 0.25));
  const Tape& tape = program->distance();
  Octree<Real> roomy(tape, *program->focus());
  Octree<Real> full(tape, *program->focus(), 0);
  Runner<Real> runner(tape);
  const Region<Real> all{{0, -1, -1}, {4000, 1, 1}};
  constexpr std::size_t kCount = 1000;
  const bool never = false;
  std::vector<std::array<Real, 3>> points(kCount);
  for (auto& p : points)
    for (std::size_t axis = 0; axis < 3; ++axis) p[axis] = number_in(all.lo[axis], all.hi[axis], random);
  const auto lengths_of_rounds = [&](Octree<Real>& octree) {
    CellGroups<Real> groups(octree, runner);
    StageStats stage;
    std::vector<std::size_t> lengths;
    for (int round = 0; round < 6; ++round) {
      groups.sort(kCount, 3.0, never, stage, [&](std::size_t i) { return points[i]; });
      std::size_t length = 0;
      for (const CellGroup<Real>& group : groups.groups()) length += group.count * group.cell->part.length;
      lengths.push_back(length);
    }
    return lengths;
  };
  const std::vector<std::size_t> in_roomy = lengths_of_rounds(roomy);
  const std::vector<std::size_t> in_full = lengths_of_rounds(full);
  CHECK(in_roomy.front() == in_full.front());
  CHECK(in_full.front() < kCount * tape.code.size() / 2);
  CHECK(in_full.back() == in_full.front());
  // cells are made as their having been missing adds up
  CHECK(std::is_sorted(in_roomy.rbegin(), in_roomy.rend()));
  CHECK(in_roomy.back() < kCount * tape.code.size() / 4);
  CHECK(roomy.cells() > full.cells());
  CHECK(full.is_full());
}

TEST_CASE("a tape is worth an octree where much of it goes away") {
  const auto worth = [](const NodePtr& shape) {
    const auto program = compile(shape);
    return is_worth_an_octree(program->distance(), program->focus().value_or(Aabb{{0, 0, 0}, {0, 0, 0}}));
  };
  CHECK(worth(row_of_balls(100, 0.0)));
  CHECK(!worth(row_of_balls(10, 0.0)));
  CHECK(!worth(row_of_balls(100, 500.0)));  // blended all over
  std::vector<NodePtr> points;
  for (int i = 0; i < 60; ++i) points.push_back(capped_cone(0.0, 0.0, 0.0, {1.0, 0.5 + i, 3.0}));
  CHECK(!worth(combine(NodeKind::kUnion, points, 0.0)));  // all in one point
}

}  // namespace
}  // namespace octomarch
