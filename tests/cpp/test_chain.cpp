// program/chain.hpp: which tapes are chains, and that their parts, as lists of operands, are the parts.
#include <algorithm>
#include <functional>
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

/// A union of what is made of random numbers, at random places.
NodePtr many(const std::function<NodePtr(Random&)>& make, double smooth, NodeKind kind = NodeKind::kUnion) {
  Random random(21);  // NOLINT(bugprone-random-generator-seed): the same numbers each time
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

NodePtr shells(NodePtr shape, int count) {
  for (int i = 0; i < count; ++i) shape = shell(std::move(shape), 0.1 + 0.01 * i);
  return shape;
}

struct Made {
  std::string name;
  NodePtr shape;
  std::size_t body;  ///< instructions of each operand
};

std::vector<Made> chains() {
  return {
      {"balls", many(ball, 0.0), 1},
      {"blended balls", many(ball, 0.1), 1},
      {"metaballs", many(ball, 0.001, NodeKind::kMetaballs), 1},
      {"an intersection", many([](Random& r) { return sphere(5.0 + size(r)); }, 0.05, NodeKind::kIntersection), 1},
      {"boxes", many([](Random& r) { return box({size(r), size(r), size(r)}); }, 0.1), 1},
      {"turned boxes", many([](Random& r) { return turned(box({size(r), size(r), size(r)}), r); }, 0.1), 2},
      {"turned tori", many([](Random& r) { return turned(torus(size(r), 0.05, {0, 1, 0}), r); }, 0.0), 2},
      {"capsules", many([](Random& r) { return capsule({0, 0, 0}, {size(r), 0.2, size(r)}, 0.1); }, 0.1), 1},
      {"cylinders", many([](Random& r) { return cylinder(size(r), 0.5, {0, 1, 0}); }, 0.0), 1},
      {"shells", many([](Random& r) { return shell(ball(r), 0.05); }, 0.1), 2},
  };
}

TEST_CASE("unions of like shapes are chains") {
  for (const Made& made : chains()) {
    CAPTURE(made.name);
    const auto program = compile(made.shape);
    const std::optional<Chain> chain = Chain::of(program->distance());
    REQUIRE(chain.has_value());
    CHECK(chain->operands() == kCount);
    CHECK(chain->body().size() == made.body);
    CHECK(chain->length(kCount) == program->distance().code.size());
    const Tape& tape = program->distance();
    for (std::size_t i = 1; i < kCount; ++i) {  // after the first, one operand and its blend after the other
      const std::size_t at = chain->length(i);
      CHECK(chain->first_constant(i) == tape.code[at].constants);
      CHECK(tape.code[at].op == tape.code[0].op);
    }
    CHECK(chain->first_constant(0) == 0);
  }
}

TEST_CASE("other tapes are none") {
  const std::vector<Made> others = {
      {"one shape", sphere(1.0), 0},
      {"boxes among balls", many([](Random& r) { return r() % 2 == 0 ? ball(r) : box({0.1, 0.2, 0.3}); }, 0.1), 0},
      {"what is cut by itself",
       many(
           [](Random& r) {
             return combine(NodeKind::kDifference, {turned(box({1, 1, 1}), r), translate(ball(r), {0.3, 0, 0})}, 0.0);
           },
           0.0),
       0},
      {"long operands", many([](Random& r) { return shells(ball(r), 8); }, 0.0), 0},
      {"a difference", many(ball, 0.1, NodeKind::kDifference), 0},
      {"blends of two widths", combine(NodeKind::kUnion, {many(ball, 0.1), translate(sphere(0.3), {5, 0, 0})}, 0.2), 0},
      {"a shell of all", shell(many(ball, 0.1), 0.1), 0},
      {"two unions", combine(NodeKind::kIntersection, {many(ball, 0.0), translate(many(ball, 0.0), {0.1, 0, 0})}, 0.0),
       0},
      {"repeated balls", repeat(many(ball, 0.1), {5, 5, 5}, {0, 0, 0}), 0},
      {"fields",
       many([](Random& r) { return displace(ball(r), noise(coordinate(0), coordinate(1), coordinate(2), 1), 1.0); },
            0.0),
       0},
  };
  for (const Made& made : others) {
    CAPTURE(made.name);
    const auto program = compile(made.shape);
    CHECK_FALSE(Chain::of(program->distance()).has_value());
  }
}

TEST_CASE_TEMPLATE("a part as a list of operands has the bits of the part", Real, float, double) {
  Random random(22);  // NOLINT(bugprone-random-generator-seed): likewise
  for (const Made& made : chains()) {
    CAPTURE(made.name);
    const auto program = compile(made.shape);
    const Tape& tape = program->distance();
    const std::optional<Chain> chain = Chain::of(tape);
    REQUIRE(chain.has_value());
    const HeldPart whole = whole_of(tape);
    Runner<Real> runner(tape);
    Pruner<Real> pruner(tape);
    Unpacker unpacker({}, &*chain);
    std::vector<std::uint32_t> operands;
    REQUIRE(chain->find_operands(whole.view(), operands));
    CHECK(operands.size() == kCount);
    std::size_t cut = 0;
    for (int i = 0; i < 50; ++i) {
      Region<Real> region;
      for (unsigned axis = 0; axis < 3; ++axis) {
        region.lo[axis] = static_cast<Real>(uniform(random, -2.5, 2.0));
        region.hi[axis] = region.lo[axis] + static_cast<Real>(uniform(random, 0.0, 0.5));
      }
      const std::optional<TapePart> part = pruner.prune(whole.view(), region, nullptr);
      if (!part) continue;
      REQUIRE(chain->find_operands(*part, operands));
      CHECK(std::ranges::is_sorted(operands));
      const TapePart listed = chain->part_of(operands);
      CHECK(listed.length == part->length);
      CHECK(chain->operands_of(listed) == operands.size());
      const TapePart ready = unpacker.ready(listed);
      CHECK(std::equal(part->origins, part->origins + part->length, ready.origins));
      const VectorBuffer<Real> points = points_in(region, random);
      CHECK(runner.results(ready, points) == runner.results(*part, points));
      cut += tape.code.size() - part->length;
    }
    CHECK(cut > 0);
  }
}

TEST_CASE("what is no list of operands is told") {
  const auto program = compile(many(ball, 0.1));
  const Tape& tape = program->distance();
  const std::optional<Chain> chain = Chain::of(tape);
  REQUIRE(chain.has_value());
  const HeldPart whole = whole_of(tape);
  std::vector<std::uint32_t> operands;
  const auto without = [&](std::size_t instruction) {
    HeldPart part = whole;
    const auto at = static_cast<std::ptrdiff_t>(instruction);
    part.code.erase(part.code.begin() + at);
    part.origins.erase(part.origins.begin() + at);
    return part;
  };
  for (const std::size_t instruction : {std::size_t{0}, std::size_t{1}, std::size_t{2}, tape.code.size() - 1}) {
    const HeldPart part = without(instruction);
    CHECK_FALSE(chain->find_operands(part.view(), operands));
  }
}

}  // namespace
}  // namespace octomarch
