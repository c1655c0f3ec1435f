// program/octree.hpp: cells and their parts, whoever makes them, and which tapes are worth them.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <thread>
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

TEST_CASE_TEMPLATE("a point lies in the regions of all cells on its way", Real, float, double) {
  Random random(8);  // NOLINT(bugprone-random-generator-seed): the same numbers each time
  const auto program = compile(row_of_balls(40, 0.25));
  for (const double offset : {0.0, 1000.0}) {
    const Vec3 moved{offset, -offset, 3.0 * offset};
    const Aabb focus{program->focus()->lo + moved, program->focus()->hi + moved};
    Octree<Real> octree(program->distance(), focus);
    const double size = focus.hi.x - focus.lo.x;
    for (int i = 0; i < 2000; ++i) {
      const double reach = size * std::exp2(uniform(random, -12.0, 60.0));
      const Vec3 middle = (focus.lo + focus.hi) * 0.5;
      const auto near = [&](double at) { return static_cast<Real>(at + uniform(random, -reach, reach)); };
      const std::array<Real, 3> p{near(middle.x), near(middle.y), near(middle.z)};
      const std::uint64_t way = octree.way_to(p[0], p[1], p[2]);
      const std::size_t top = way >> Octree<Real>::kWayBits;
      if (top == octree.tops().size()) {
        CHECK(reach > 1e12 * size);
        continue;
      }
      typename Octree<Real>::Place place{&octree.tops()[top], 0, {}};
      CHECK(contains(place.region(), p[0], p[1], p[2]));
      for (unsigned level = 0; level < Octree<Real>::kLevels; ++level) {
        const Region<Real> before = place.region();
        place = place.child(Way(way, 0).octant(level));
        const Region<Real> region = place.region();
        CHECK(contains(region, p[0], p[1], p[2]));
        CHECK(contains(before, region.lo[0], region.lo[1], region.lo[2]));
        CHECK(contains(before, region.hi[0], region.hi[1], region.hi[2]));
        CHECK(region.hi[0] - region.lo[0] <= Real(0.5) * (before.hi[0] - before.lo[0]) + 2 * place.top->room);
      }
    }
  }
}

TEST_CASE_TEMPLATE("small cells have short programs, however far one can look", Real, float, double) {
  Random random(3);  // NOLINT(bugprone-random-generator-seed): likewise
  std::vector<NodePtr> balls;
  const auto place_of = [&] {
    return Vec3{uniform(random, -2.0, 2.0), uniform(random, -2.0, 2.0), uniform(random, -2.0, 2.0)};
  };
  for (int i = 0; i < 300; ++i) balls.push_back(translate(sphere(0.2), place_of()));
  const auto program = compile(combine(NodeKind::kUnion, std::move(balls), 0.0));
  Octree<Real> octree(program->distance(), *program->focus());
  Runner<Real> runner(program->distance());
  CellMaker<Real> maker(octree, runner);
  for (int i = 0; i < 30; ++i) {
    const Vec3 p = place_of();
    const std::uint64_t way = octree.way_to(static_cast<Real>(p.x), static_cast<Real>(p.y), static_cast<Real>(p.z));
    REQUIRE((way >> Octree<Real>::kWayBits) == 0U);
    typename Octree<Real>::Place place{octree.tops().data(), 0, {}};
    typename Octree<Real>::Cell* cell = &place.top->cell;
    while (!cell->is_leaf) {
      const unsigned octant = Way(way, 0).octant(place.level);
      place = place.child(octant);
      cell = &maker.child(*cell, place, octant);
    }
    CHECK(cell->part.length <= 12);
    CHECK(place.level <= 8);
  }
}

TEST_CASE("parts are packed and unpacked as they were, unless their instructions differ too much") {
  const auto program = compile(row_of_balls(20'000, 0.25));
  const Tape& tape = program->distance();
  const HeldPart whole = whole_of(tape);
  Arena arena;
  Packer packer;
  const std::vector<std::uint32_t> constants = constant_offsets(tape);
  Unpacker unpacker(constants);
  const std::optional<TapePart> packed = packer.pack(whole.view(), arena);
  REQUIRE(packed.has_value());
  // a block for the patterns, one for three bytes an instruction, and one as large as both
  CHECK(arena.bytes() <= 2 * (4096 + 3 * tape.code.size()));
  const TapePart unpacked = unpacker.ready(*packed);
  CHECK(std::ranges::equal(unpacked.instructions(), tape.code));
  CHECK(std::equal(whole.origins.begin(), whole.origins.end(), unpacked.origins));
  CHECK(std::equal(tape.results.begin(), tape.results.end(), unpacked.results));
  CHECK(unpacked.registers == tape.registers);
  CHECK(unpacker.ready(whole.view()).code == whole.code.data());

  // 255 patterns fit into a byte that has to stand for something else too; a part of as many patterns as that has no use for any
  HeldPart varied = whole;
  const auto vary = [&](std::size_t patterns) {
    for (std::size_t i = 0; i < varied.code.size(); ++i) {
      varied.code[i].out[0] = static_cast<std::uint16_t>(i % patterns);
      varied.code[i].op = Opcode::kUnion;
      varied.code[i].in = {};
    }
  };
  vary(255);
  const std::optional<TapePart> most = packer.pack(varied.view(), arena);
  REQUIRE(most.has_value());
  CHECK(std::ranges::equal(unpacker.ready(*most).instructions(), varied.code));
  vary(256);
  CHECK(!packer.pack(varied.view(), arena).has_value());
  varied.code.resize(20);
  varied.origins.resize(20);
  CHECK(!packer.pack(varied.view(), arena).has_value());
}

TEST_CASE("packed parts may come from far apart in a tape") {
  const auto program = compile(row_of_balls(70'000, 0.25));
  const Tape& tape = program->distance();
  const std::vector<std::uint32_t> constants = constant_offsets(tape);
  Unpacker unpacker(constants);
  for (const std::vector<std::uint32_t>& gaps : std::initializer_list<std::vector<std::uint32_t>>{
           {65535}, {65536}, {65537}, {131070, 1}, {131071}, {1, 65536, 2, 65537, 1}, {139'000}}) {
    HeldPart part = whole_of(tape);
    part.origins.resize(20);
    for (const std::uint32_t gap : gaps) part.origins.push_back(part.origins.back() + gap);
    REQUIRE(part.origins.back() < tape.code.size());
    part.code.clear();
    for (const std::uint32_t origin : part.origins) part.code.push_back(tape.code[origin]);
    Arena arena;
    const std::optional<TapePart> packed = Packer().pack(part.view(), arena);
    REQUIRE(packed.has_value());
    const TapePart unpacked = unpacker.ready(*packed);
    CHECK(std::ranges::equal(unpacked.instructions(), part.code));
    CHECK(std::equal(part.origins.begin(), part.origins.end(), unpacked.origins));
  }
}

template <class Real>
std::size_t cells_below(const typename Octree<Real>::Cell& cell) {
  std::size_t count = 1;
  for (unsigned octant = 0; octant < 8; ++octant) {
    const typename Octree<Real>::Cell* const child = cell.child(octant);
    if (child == nullptr) continue;
    CHECK(child->part.length <= cell.part.length);
    count += cells_below<Real>(*child);
  }
  return count;
}

TEST_CASE_TEMPLATE("threads that make cells at the same time lose none", Real, float, double) {
  const auto program = compile(row_of_balls(600, 0.25));
  const Tape& tape = program->distance();
  Octree<Real> octree(tape, *program->focus());
  constexpr std::size_t kThreads = 4;
  constexpr std::size_t kCount = 3000;
  std::array<std::size_t, kThreads> placed{};
  {
    std::vector<std::jthread> threads;
    for (std::size_t thread = 0; thread < kThreads; ++thread) {
      threads.emplace_back([&, thread] {
        Random random(thread / 2);  // two and two have the same points
        Runner<Real> runner(tape);
        CellChoice<Real> choice(octree, runner);
        CellGroups<Real> groups(choice);
        StageStats stage;
        const bool never = false;
        for (int round = 0; round < 8; ++round) {
          groups.sort(kCount, Few::kInGroups, never, stage, [&](std::size_t /*i*/) {
            const auto at = [&](double lo, double hi) { return static_cast<Real>(uniform(random, lo, hi)); };
            return std::array<Real, 3>{at(0.0, 1200.0), at(-1.0, 1.0), at(-1.0, 1.0)};
          });
          groups.for_each_place([&](std::size_t /*i*/, std::size_t /*place*/) { ++placed[thread]; });
        }
      });
    }
  }
  for (const std::size_t count : placed) CHECK(count == 8 * kCount);
  std::size_t cells = 1;  // that outside of all
  for (const auto& top : octree.tops()) cells += cells_below<Real>(top.cell);
  CHECK(cells == octree.cells());
  CHECK(cells > 300);
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
    CellChoice<Real> choice(octree, runner);
    CellGroups<Real> groups(choice);
    StageStats stage;
    std::vector<std::size_t> lengths;
    for (int round = 0; round < 20; ++round) {
      groups.sort(kCount, Few::kInGroups, never, stage, [&](std::size_t i) { return points[i]; });
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
