// program/chain.hpp: which tapes are chains, and that their parts, as lists of operands, are the parts.
#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <vector>

#include "parts.hpp"
#include <doctest/doctest.h>

#include "octomarch/program/chain.hpp"
#include "octomarch/render/loaded_tape.hpp"

namespace octomarch {
namespace {

constexpr int kCount = 40;
constexpr std::size_t kFew = 5;

/// A union of what is made of random numbers, at random places.
NodePtr many(const std::function<NodePtr(Random&)>& make, double smooth, NodeKind kind = NodeKind::kUnion,
             std::uint64_t seed = 21) {
  Random random(seed);  // NOLINT(bugprone-random-generator-seed): the same numbers each time
  std::vector<NodePtr> shapes;
  for (int i = 0; i < kCount; ++i) {
    const double x = uniform(random, -2.0, 2.0);
    const double y = uniform(random, -2.0, 2.0);
    shapes.push_back(translate(make(random), {x, y, uniform(random, -2.0, 2.0)}));
  }
  return combine(kind, std::move(shapes), smooth);
}

double size(Random& random) { return uniform(random, 0.1, 0.4); }
NodePtr ball(Random& random) { return sphere(size(random)); }
NodePtr turned(NodePtr shape, Random& random) {
  return rotate(std::move(shape), uniform(random, 10.0, 80.0), {1.0, uniform(random, 1.0, 2.0), 0.5});
}

NodePtr stick(Random& random) { return capsule({0, 0, 0}, {size(random), size(random), 0.1}, 0.05); }
NodePtr pin(Random& random) {
  return combine(NodeKind::kUnion, {cylinder(0.05, 0.5, {0, 1, 0}), translate(sphere(size(random)), {0, 0.25, 0})},
                 0.0);
}
NodePtr bead(Random& random) {
  return combine(NodeKind::kDifference, {sphere(size(random)), translate(sphere(0.1), {0.1, 0, 0})}, 0.0);
}
/// Unites in two ways.
NodePtr knob(Random& random) {
  const NodePtr blended = combine(NodeKind::kUnion, {ball(random), box({0.5, 0.1, 0.1})}, 0.1);
  return combine(NodeKind::kUnion, {blended, stick(random)}, 0.0);
}
NodePtr wavy(Random& random) {
  return displace(ball(random), noise(coordinate(0), coordinate(1), coordinate(2), 1), 1.0);
}

NodePtr shells(NodePtr shape, int count) {
  for (int i = 0; i < count; ++i) shape = shell(std::move(shape), 0.1 + 0.01 * i);
  return shape;
}

/// One of several, at random.
NodePtr any_of(std::initializer_list<NodePtr> shapes, Random& random) {
  return shapes.begin()[random() % shapes.size()];
}

struct Made {
  std::string name;
  NodePtr shape;
  std::vector<std::size_t> bodies;  ///< instructions of the operands of each kind, ascending
  std::size_t operands = kCount;
};

/// Nothing but operands of few kinds.
std::vector<Made> chains() {
  return {
      {"balls", many(ball, 0.0), {1}},
      {"blended balls", many(ball, 0.1), {1}},
      {"metaballs", many(ball, 0.001, NodeKind::kMetaballs), {1}},
      {"an intersection", many([](Random& r) { return sphere(5.0 + size(r)); }, 0.05, NodeKind::kIntersection), {1}},
      {"boxes", many([](Random& r) { return box({size(r), size(r), size(r)}); }, 0.1), {1}},
      {"turned boxes", many([](Random& r) { return turned(box({size(r), size(r), size(r)}), r); }, 0.1), {2}},
      {"turned tori", many([](Random& r) { return turned(torus(size(r), 0.05, {0, 1, 0}), r); }, 0.0), {2}},
      {"capsules", many([](Random& r) { return capsule({0, 0, 0}, {size(r), 0.2, size(r)}, 0.1); }, 0.1), {1}},
      {"cylinders", many([](Random& r) { return cylinder(size(r), 0.5, {0, 1, 0}); }, 0.0), {1}},
      {"cones", many([](Random& r) { return turned(capped_cone(size(r), 0.1, 0.5, {0, 1, 0}), r); }, 0.0), {2}},
      {"shells", many([](Random& r) { return shell(ball(r), 0.05); }, 0.1), {2}},
      {"twenty shells", many([](Random& r) { return shells(ball(r), 20); }, 0.1), {21}},
      {"balls and boxes", many([](Random& r) { return any_of({ball(r), box({0.1, 0.2, size(r)})}, r); }, 0.1), {1, 1}},
      {"of three kinds",
       many(
           [](Random& r) {
             return any_of({ball(r), turned(box({0.1, 0.2, 0.3}), r), capsule({}, {0.2, 0, 0}, 0.1)}, r);
           },
           0.0),
       {1, 1, 2}},
      {"turned pins", many([](Random& r) { return turned(pin(r), r); }, 0.1), {4}},
      {"pins among balls", many([](Random& r) { return any_of({ball(r), turned(pin(r), r)}, r); }, 0.1), {1, 4}},
      {"beads", many(bead, 0.1), {3}},
      {"knobs", many(knob, 0.1), {5}},
      {"needier shapes second",
       many([i = 0](Random& r) mutable { return i++ % 2 == 0 ? bead(r) : turned(pin(r), r); }, 0.0),
       {3, 4}},
      {"balls and sticks", combine(NodeKind::kUnion, {many(ball, 0.0), many(stick, 0.0)}, 0.0), {1, 1}, 2 * kCount},
      {"blended balls and sticks",
       combine(NodeKind::kUnion, {many(ball, 0.1), many(stick, 0.0)}, 0.0),
       {1, 1},
       2 * kCount},
      {"sticks and blended balls",
       combine(NodeKind::kUnion, {many(stick, 0.0), many(ball, 0.1)}, 0.0),
       {1, 1},
       2 * kCount},
      {"unions of unions",
       combine(NodeKind::kUnion,
               {combine(NodeKind::kUnion, {many(ball, 0.0), many(ball, 0.0, NodeKind::kUnion, 25)}, 0.0),
                combine(NodeKind::kUnion, {many(stick, 0.0), many(stick, 0.0, NodeKind::kUnion, 26)}, 0.0)},
               0.0),
       {1, 1},
       4 * kCount},
      {"blends of two widths",
       combine(NodeKind::kUnion,
               {many(ball, 0.1), translate(sphere(0.3), {1, 0, 0}), translate(sphere(0.3), {0, 1, 0})}, 0.2),
       {1, 1},
       kCount + 2},
  };
}

NodePtr with(NodePtr shape) { return combine(NodeKind::kUnion, {many(ball, 0.1), std::move(shape)}, 0.0); }

/// Beads, of which one's hole is filled: the ball that is taken from it is also added.
NodePtr filled() {
  Random random(27);  // NOLINT(bugprone-random-generator-seed): likewise
  std::vector<NodePtr> shapes;
  for (int i = 0; i < kCount; ++i) {
    const Vec3 place{uniform(random, -2, 2), uniform(random, -2, 2), uniform(random, -2, 2)};
    const NodePtr hole = translate(sphere(0.2), place + Vec3{0.25, 0, 0});
    shapes.push_back(combine(NodeKind::kDifference, {translate(sphere(0.3), place), hole}, 0.0));
    if (i == kCount - 1) shapes.push_back(hole);
  }
  return combine(NodeKind::kUnion, std::move(shapes), 0.0);
}

/// A half-space whose field is no instruction, just a coordinate.
NodePtr half_space() { return field(coordinate(0), 1.0, {}); }

/// Chains with something else beside them.
std::vector<Made> chains_and_more() {
  Random random(24);  // NOLINT(bugprone-random-generator-seed): likewise
  const NodePtr balls = many(ball, 0.1);
  return {
      {"a box more", with(translate(box({0.5, 0.5, 0.5}), {1, 1, 1})), {1}},
      {"a turned box before", combine(NodeKind::kUnion, {turned(box({1, 1, 1}), random), many(ball, 0.1)}, 0.0), {1}},
      {"a field more", with(wavy(random)), {1}},
      {"beads and what fills one", filled(), {3}},
      {"a coordinate more", with(half_space()), {1}},
      {"a coordinate before", combine(NodeKind::kUnion, {half_space(), many(ball, 0.0)}, 0.0), {1}},
      {"a coordinate before blended balls",
       combine(NodeKind::kUnion, {translate(half_space(), {0.1, 0, 0}), balls}, 0.0),
       {1}},
      {"the smaller of two coordinates more",
       with(field(expression(NodeKind::kMinimum, {coordinate(0), coordinate(1)}), 1.0, {})),
       {1}},
      {"a wavy ball among many", many([i = 0](Random& r) mutable { return ++i == 20 ? wavy(r) : ball(r); }, 0.1), {1}},
      {"less a box", combine(NodeKind::kDifference, {many(ball, 0.1), box({1, 1, 1})}, 0.0), {1}},
      {"smoothly less two balls",
       combine(NodeKind::kDifference, {many(ball, 0.1), sphere(0.5), translate(sphere(0.5), {1, 0, 0})}, 0.1),
       {1}},
      {"two unions", combine(NodeKind::kUnion, {balls, translate(many(ball, 0.2), {3, 0, 0})}, 0.0), {1}},
      {"a ball that is met twice", combine(NodeKind::kUnion, {balls, shell(balls->children()[3], 0.01)}, 0.0), {1}},
  };
}

std::vector<std::size_t> bodies_of(const Chain& chain) {
  std::vector<std::size_t> bodies;
  for (const Chain::Kind& kind : chain.kinds()) bodies.push_back(kind.length);
  std::ranges::sort(bodies);
  return bodies;
}

TEST_CASE("operands of few kinds are a chain") {
  for (const Made& made : chains()) {
    CAPTURE(made.name);
    const auto program = compile(made.shape);
    const std::optional<Chain> chain = Chain::of(program->distance(), kFew);
    REQUIRE(chain.has_value());
    CHECK(chain->is_whole());
    CHECK(chain->operands() == made.operands);
    CHECK(bodies_of(*chain) == made.bodies);
    std::size_t length = 0;
    for (std::size_t i = 0; i < chain->operands(); ++i) length += chain->kind_of(i).length + 1;
    CHECK(length - 1 == program->distance().code.size());
  }
}

TEST_CASE("what else a tape has is no part of its chain") {
  for (const Made& made : chains_and_more()) {
    CAPTURE(made.name);
    const auto program = compile(made.shape);
    const std::optional<Chain> chain = Chain::of(program->distance(), kFew);
    REQUIRE(chain.has_value());
    CHECK_FALSE(chain->is_whole());
    CHECK(bodies_of(*chain) == made.bodies);
    CHECK(chain->operands() + 3 >= kCount);
    std::vector<std::uint32_t> operands;
    CHECK_FALSE(chain->find_operands(whole_of(program->distance()).view(), operands));
  }
}

TEST_CASE("other tapes are none") {
  const std::vector<Made> others = {
      {"one shape", sphere(1.0), {}},
      {"long operands", many([](Random& r) { return shells(ball(r), 24); }, 0.0), {}},
      {"a difference", many(ball, 0.1, NodeKind::kDifference), {}},
      {"a shell of all", shell(many(ball, 0.1), 0.1), {}},
      {"repeated balls", repeat(many(ball, 0.1), {5, 5, 5}, {0, 0, 0}), {}},
      {"fields", many(wavy, 0.0), {}},
      {"long operands that choose",
       many([](Random& r) { return turned(combine(NodeKind::kUnion, {pin(r), knob(r)}, 0.1), r); }, 0.1),
       {}},
      {"of too many kinds", many([i = 0](Random& r) mutable { return shells(ball(r), i++ % 23); }, 0.0), {}},
  };
  for (const Made& made : others) {
    CAPTURE(made.name);
    const auto program = compile(made.shape);
    CHECK_FALSE(Chain::of(program->distance(), kFew).has_value());
  }
}

TEST_CASE("few operands that choose by themselves are no chain") {
  const auto program = compile(many(bead, 0.1));
  CHECK(Chain::of(program->distance(), kCount).has_value());
  CHECK_FALSE(Chain::of(program->distance(), kCount + 1).has_value());
  CHECK(kCount < Chain::kManyThatChoose);
}

template <class Real>
Region<Real> small_region(Random& random) {
  Region<Real> region;
  for (unsigned axis = 0; axis < 3; ++axis) {
    region.lo[axis] = static_cast<Real>(uniform(random, -2.5, 2.0));
    region.hi[axis] = region.lo[axis] + static_cast<Real>(uniform(random, 0.0, 0.5));
  }
  return region;
}

TEST_CASE_TEMPLATE("a part as a list of operands has the bits of the part", Real, float, double) {
  Random random(22);  // NOLINT(bugprone-random-generator-seed): likewise
  for (const Made& made : chains_and_more()) {
    CAPTURE(made.name);
    const auto program = compile(made.shape);
    const Tape& tape = program->distance();
    const std::optional<Chain> chain = Chain::of(tape, kFew);
    REQUIRE(chain.has_value());
    const HeldPart whole = whole_of(tape);
    Runner<Real> runner(tape, kFew);
    const std::vector<Margin> margins = margins_of(tape, Region<Real>{{-3, -3, -3}, {3, 3, 3}});
    Pruner<Real> by_ranges(tape);
    Pruner<Real> by_samples(tape, &runner);
    Unpacker unpacker({}, &*chain);
    std::vector<std::uint32_t> operands;
    std::size_t lists = 0;
    for (int i = 0; i < 100; ++i) {
      const Region<Real> region = small_region<Real>(random);
      const std::optional<TapePart> part =
          (i % 2 == 0 ? by_ranges : by_samples).prune(whole.view(), region, margins.data());
      if (!part || !chain->find_operands(*part, operands)) continue;
      CHECK(std::ranges::is_sorted(operands));
      const TapePart list = chain->part_of(operands);
      CHECK(list.is_list());
      const TapePart ready = unpacker.ready(list);
      CHECK(ready.length == list.length);
      const VectorBuffer<Real> points = points_in(region, random);
      CHECK(runner.results(ready, points) == runner.results(*part, points));
      ++lists;
    }
    CHECK(lists > 5);
  }
}

TEST_CASE_TEMPLATE("what pruning leaves of a list has the bits of the list", Real, float, double) {
  Random random(23);  // NOLINT(bugprone-random-generator-seed): likewise
  for (const Made& made : chains()) {
    CAPTURE(made.name);
    const auto program = compile(made.shape);
    const Tape& tape = program->distance();
    const std::optional<Chain> chain = Chain::of(tape, kFew);
    REQUIRE(chain.has_value());
    Runner<Real> runner(tape, kFew);
    const std::vector<Real> table = chain->template table<Real>(tape);
    Pruner<Real> pruner(tape, &runner, table.data());
    Unpacker unpacker({}, &*chain);
    std::vector<std::uint32_t> operands(chain->operands());
    std::iota(operands.begin(), operands.end(), 0U);
    const TapePart list = chain->part_of(operands);
    const std::vector<Margin> margins = chain->margins(table, Region<Real>{{-3, -3, -3}, {3, 3, 3}});
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    const std::vector<Margin> none(margins.size(), Margin{kInfinity, kInfinity});
    const TapePart ready = unpacker.ready(list);
    std::vector<std::uint32_t> left;
    std::size_t dropped = 0;
    for (int i = 0; i < 50; ++i) {
      const Region<Real> region = small_region<Real>(random);
      REQUIRE(pruner.prune(*chain, list, ready, region, margins.data(), left));
      CHECK(std::ranges::includes(operands, left));
      dropped += operands.size() - left.size();
      const VectorBuffer<Real> points = points_in(region, random);
      const std::vector<Real> expected = runner.results(ready, points);
      Unpacker other({}, &*chain);
      CHECK(runner.results(other.ready(chain->part_of(left)), points) == expected);
      // ranges tell too, and what they cut inside of operands comes back
      for (const Margin* known : {margins.data(), none.data()}) {
        const std::optional<TapePart> part = pruner.prune(ready, region, known);
        if (!part || !Chain::find_operands_of_list(*part, left)) continue;
        CHECK(std::ranges::includes(operands, left));
        CHECK(runner.results(other.ready(chain->part_of(left)), points) == expected);
      }
      CHECK_FALSE(pruner.prune(*chain, list, ready, region, none.data(), left));
    }
    CHECK(dropped > 0);
  }
}

TEST_CASE("operands of which something is left count, what is between them does not") {
  const auto program = compile(chains_and_more()[0].shape);
  const Tape& tape = program->distance();
  const std::optional<Chain> chain = Chain::of(tape, kFew);
  REQUIRE(chain.has_value());
  const HeldPart whole = whole_of(tape);
  const auto only = [&](const std::vector<std::uint32_t>& instructions) {
    HeldPart part;
    for (const std::uint32_t i : instructions) {
      part.code.push_back(whole.code[i]);
      part.origins.push_back(i);
    }
    part.results = whole.results;
    std::vector<std::uint32_t> operands;
    const bool is_list = chain->find_operands(part.view(), operands);
    return is_list ? std::optional(operands) : std::nullopt;
  };
  using Operands = std::vector<std::uint32_t>;
  const auto last = static_cast<std::uint32_t>(tape.code.size() - 1);  // takes the box up
  CHECK(only({0, 1, 2}) == Operands{0, 1});
  CHECK(only({1, 3, 4}) == Operands{1, 2});
  CHECK(only({0}) == Operands{0});
  CHECK_FALSE(only({0, last - 1, last}).has_value());
  CHECK_FALSE(only({0, last - 1}).has_value());
  CHECK_FALSE(only({2}).has_value());  // takes the second ball up
}

}  // namespace
}  // namespace octomarch
