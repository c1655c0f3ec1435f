// Ranges and pruning against what kernels compute, instruction by instruction: a range holds every number that an instruction
// gives at any point of a region, and a pruned part gives the results of the whole tape there. Tapes are compiled from shapes
// that together hold every opcode.
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "parts.hpp"
#include <doctest/doctest.h>

#include "octomarch/base/types.hpp"
#include "octomarch/graph/builder.hpp"
#include "octomarch/kernels/dispatch.hpp"
#include "octomarch/program/operator_ranges.hpp"
#include "octomarch/program/program.hpp"
#include "octomarch/program/prune.hpp"
#include "octomarch/render/buffer.hpp"

namespace octomarch {
namespace {

using Kind = NodeKind;

constexpr double kFar = std::numeric_limits<double>::infinity();

// Shapes ---------------------------------------------------------------------------------------------------------------

NodePtr on(Kind kind, std::vector<NodePtr> operands) { return expression(kind, std::move(operands)); }
NodePtr x() { return coordinate(0); }
NodePtr y() { return coordinate(1); }
NodePtr z() { return coordinate(2); }
NodePtr plus(NodePtr a, NodePtr b) { return on(Kind::kAdd, {std::move(a), std::move(b)}); }
NodePtr times(NodePtr a, NodePtr b) { return on(Kind::kMultiply, {std::move(a), std::move(b)}); }
NodePtr smaller(NodePtr a, NodePtr b) { return on(Kind::kMinimum, {std::move(a), std::move(b)}); }
NodePtr larger(NodePtr a, NodePtr b) { return on(Kind::kMaximum, {std::move(a), std::move(b)}); }
NodePtr absolute(NodePtr a) { return on(Kind::kAbsolute, {std::move(a)}); }
NodePtr chosen(NodePtr condition, NodePtr a, NodePtr b) {
  return on(Kind::kWhere, {std::move(condition), std::move(a), std::move(b)});
}

/// Of values that turn up and down.
NodePtr sampled(Interpolation interpolation) {
  std::vector<float> values;
  for (int i = 0; i < 60; ++i) values.push_back(static_cast<float>(i * 37 % 60) / 60.0F - 0.4F);
  return grid({3, 4, 5}, std::move(values), {{-1.0, -0.5, -0.75}, {1.0, 0.75, 0.5}}, interpolation);
}

/// Pruning asks for no true bound.
NodePtr own(NodePtr value) { return field(std::move(value), 1.0, std::nullopt); }

Material paint_of(const NodePtr& value) {
  Material material = default_material();
  material.slots[0] = value;
  return material;
}

NodePtr smoothly(Kind kind, std::vector<NodePtr> shapes, double k) { return combine(kind, std::move(shapes), k); }

std::vector<NodePtr> primitives() {
  const Vec3 up{0.0, 1.0, 0.0};
  const Vec3 askew{1.0, 2.0, 3.0};
  std::vector<NodePtr> shapes = {
      sphere(0.8),
      sphere(0.0),
      box({1.0, 2.0, 0.5}),
      box({1.0, 0.0, 0.5}),
      box({1.0, 2.0, 0.5}, Kind::kBoxExterior),
      box({1.0, 2.0, 0.5}, Kind::kBoxMaximum),
      plane({0.0, 1.0, 0.25}, {0.0, -1.0, 0.0}),
      plane(up, {0.0, -1.0, 0.0}),
      cylinder(0.5, std::nullopt, up),
      cylinder(0.5, 1.5, askew),
      capped_cone(0.5, 0.25, 1.0, up),
      capped_cone(0.0, 0.25, 1.0, askew),
      torus(0.75, 0.25, {0.0, 0.0, 1.0}),
      capsule({0.0, 0.0, 0.0}, {0.5, 0.25, 0.125}, 0.125),
      octahedron(0.75),
      pyramid(0.5, 1.0),
      rectangle({1.0, 0.5}),
      polygon({0.0, 0.0, 1.0, 0.25, 0.5, 0.5, 0.75, 1.5}),
      sampled(Interpolation::kLinear),
      sampled(Interpolation::kCubic),
  };
  const std::size_t count = shapes.size();
  for (std::size_t i = 0; i < count; ++i) {
    shapes.push_back(translate(shapes[i], {0.5, -0.25, 1.0}));
    shapes.push_back(scale(rotate(shapes[i], 33.0, askew), 3.0));
  }
  return shapes;
}

/// Of every kind, with all operands near enough to be blended somewhere and far enough to be pruned elsewhere.
std::vector<NodePtr> operators() {
  const NodePtr ball = sphere(0.75);
  const NodePtr cube = translate(box({1.0, 1.0, 1.0}), {0.75, 0.5, 0.25});
  const NodePtr flat = polygon({0.25, 0.0, 1.0, 0.25, 0.5, 0.75});
  std::vector<NodePtr> shapes = {
      complement(ball),
      round(cube, 0.125),
      shell(cube, 0.25),
      extrude(flat, 0.5),
      revolve(flat, 0.5),
      revolve(flat, 0.0),
      stretch(cube, {1.0, 2.0, 0.5}),
      mirror(cube, 0),
      elongate(cube, {0.5, 0.0, 0.25}),
      twist(cube, 40.0, 1),
      bend(cube, -25.0),
      twist(bend(twist(cube, 30.0, 0), 20.0), 50.0, 2),
      repeat(cube, {3.0, 0.0, 0.0}, {0, 0, 0}),
      repeat(cube, {3.0, 4.0, 5.0}, {0, 0, 0}),
      repeat(cube, {3.0, 4.0, 5.0}, {3, 4, 1}),
      repeat(rotate(cube, 20.0, {1.0, 1.0, 0.0}), {3.0, 4.0, 5.0}, {0, 4, 0}),
      displace(ball, times(constant(0.1), on(Kind::kSine, {times(constant(9.0), x())})), 0.9),
      displace(ball, noise(times(x(), x()), y(), z(), 3), 1.0),
  };
  for (const double k : {0.0, 0.25, 1e-3, 30.0}) {
    for (const Kind kind : {Kind::kUnion, Kind::kIntersection, Kind::kDifference}) {
      shapes.push_back(smoothly(kind, {ball, cube, translate(ball, {0.0, 2.0, 0.0})}, k));
    }
    if (k > 0.0) shapes.push_back(smoothly(Kind::kMetaballs, {ball, cube, translate(ball, {0.0, 2.0, 0.0})}, k));
  }
  return shapes;
}

/// Numbers of every kind of expression, those among them that are infinite or none at all in places.
std::vector<NodePtr> numbers() {
  const NodePtr two = constant(2.0);
  std::vector<NodePtr> all = {
      plus(x(), constant(3.0)),
      on(Kind::kSubtract, {constant(1.0), times(x(), y())}),
      on(Kind::kSubtract, {times(x(), x()), times(y(), y())}),
      on(Kind::kDivide, {x(), y()}),
      on(Kind::kDivide, {plus(x(), y()), constant(3.0)}),
      on(Kind::kDivide, {constant(1.0), x()}),
      on(Kind::kNegate, {plus(x(), y())}),
      times(times(x(), x()), larger(y(), constant(0.0))),
      times(larger(x(), constant(0.0)), times(on(Kind::kExponential, {y()}), z())),
      smaller(x(), constant(0.5)),
      larger(x(), constant(0.5)),
      smaller(x(), constant(kFar)),
      larger(constant(-kFar), on(Kind::kLogarithm, {x()})),
      plus(absolute(x()), smaller(absolute(y()), z())),
      on(Kind::kSquareRoot, {plus(times(x(), x()), y())}),
      on(Kind::kFloor, {times(x(), two)}),
      on(Kind::kExponential, {times(x(), two)}),
      on(Kind::kLogarithm, {absolute(x())}),
      on(Kind::kSine, {times(x(), y())}),
      on(Kind::kCosine, {times(x(), x())}),
      on(Kind::kTangent, {on(Kind::kDivide, {x(), constant(5.0)})}),
      on(Kind::kArcSine, {x()}),
      on(Kind::kArcCosine, {y()}),
      on(Kind::kArcTangent, {times(x(), two)}),
      on(Kind::kArcTangent2, {y(), x()}),
      on(Kind::kModulo, {x(), constant(0.75)}),
      on(Kind::kPower, {absolute(x()), y()}),
      on(Kind::kLess, {x(), y()}),
      on(Kind::kLessEqual, {on(Kind::kSquareRoot, {x()}), y()}),
      chosen(on(Kind::kLess, {x(), constant(0.25)}), y(), z()),
      chosen(x(), plus(y(), constant(1.0)), on(Kind::kSquareRoot, {z()})),
      chosen(on(Kind::kSquareRoot, {x()}), y(), z()),
      noise(x(), times(y(), constant(3.0)), z(), 7),
      noise(times(x(), x()), on(Kind::kExponential, {y()}), z(), 0),
      texel(image(2, 1, {0.F, 1.F, 0.5F, 1.F, 0.25F, 0.F}), x(), y(), 1, 1),
  };
  return all;
}

/// Numbers beside a shape that is nearer in some regions, and farther in others.
std::vector<NodePtr> fields() {
  const NodePtr ball = translate(sphere(0.5), {0.25, 0.0, 0.5});
  std::vector<NodePtr> shapes = {solid(on(Kind::kLess, {x(), y()}))};
  for (const NodePtr& number : numbers()) {
    shapes.push_back(own(number));
    shapes.push_back(combine(Kind::kUnion, {own(number), ball}, 0.0));
    shapes.push_back(combine(Kind::kDifference, {ball, own(number)}, 0.25));
  }
  shapes.push_back(field(times(x(), y()), 2.0, Aabb{{-1.0, -1.0, -1.0}, {1.0, 0.5, 1.0}}));
  return shapes;
}

std::vector<NodePtr> painted() {
  std::vector<NodePtr> shapes;
  const NodePtr ball = paint(sphere(0.75), paint_of(plus(x(), y())));
  const NodePtr cube = paint(translate(box({1.0, 1.0, 1.0}), {0.75, 0.5, 0.25}), paint_of(times(x(), coordinate(5))));
  for (const double k : {0.0, 0.25}) {
    for (const Kind kind : {Kind::kUnion, Kind::kIntersection, Kind::kDifference}) {
      shapes.push_back(smoothly(kind, {ball, cube, translate(ball, {0.0, 2.0, 0.0})}, k));
    }
  }
  shapes.push_back(smoothly(Kind::kMetaballs, {ball, cube}, 0.125));
  return shapes;
}

/// All shapes of this file, compiled once.
const std::vector<std::shared_ptr<const Program>>& programs() {
  static const std::vector<std::shared_ptr<const Program>> all = [] {
    std::vector<std::shared_ptr<const Program>> made;
    for (const auto& shapes : {primitives(), operators(), fields(), painted()}) {
      for (const NodePtr& shape : shapes) made.push_back(compile(shape));
    }
    return made;
  }();
  return all;
}

/// Their distance tapes, and of those that are painted the tapes of attributes.
std::vector<const Tape*> tapes() {
  std::vector<const Tape*> all;
  for (const auto& program : programs()) {
    all.push_back(&program->distance());
    all.push_back(&program->attributes().tape);
    if (!program->surface().is_constant()) all.push_back(&program->surface().tape);
  }
  return all;
}

// Regions and values in them -------------------------------------------------------------------------------------------

template <class Real>
bool holds(const Range<Real>& range, Real value) {
  return std::isnan(value) ? range.is_whole() : range.lo <= value && value <= range.hi;
}

/// Equal as numbers, or neither one.
template <class Real>
bool are_same(const std::vector<Real>& a, const std::vector<Real>& b) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!(a[i] == b[i] || (std::isnan(a[i]) && std::isnan(b[i])))) return false;
  }
  return a.size() == b.size();
}

template <class Real>
std::string text_of(const Region<Real>& region) {
  std::string text;
  for (unsigned axis = 0; axis < 3; ++axis) {
    text += "[" + std::to_string(region.lo[axis]) + ", " + std::to_string(region.hi[axis]) + "] ";
  }
  return text;
}

/// Walks a tape over a region and over points of it side by side.
template <class Real>
void check_ranges(const Tape& tape, const Region<Real>& region, const VectorBuffer<Real>& points) {
  const HeldPart all = whole_of(tape);
  const TapePart whole = all.view();
  Runner<Real> runner(tape);
  std::vector<Range<Real>> ranges(tape.registers);
  for (std::uint32_t i = 0; i < tape.inputs; ++i) {
    ranges[i] = i < 3 ? Range<Real>(region.lo[i], region.hi[i]) : Range<Real>::whole();
  }
  for (std::size_t i = 0; i < tape.code.size(); ++i) {
    const Instruction& instruction = tape.code[i];
    const OpcodeInfo& shape = info(instruction.op);
    Range<Real> in[kMaxInputs];
    Range<Real> out[kMaxOutputs];
    for (std::size_t k = 0; k < shape.inputs; ++k) in[k] = ranges[instruction.in[k]];
    operator_ranges(instruction.op, constants_of<Real>(tape) + instruction.constants, in, out);
    const std::vector<std::uint16_t> registers(instruction.out.begin(), instruction.out.begin() + shape.outputs);
    const std::vector<Real> values = runner.values(whole, i + 1, points, registers);
    for (std::size_t k = 0; k < shape.outputs; ++k) {
      ranges[instruction.out[k]] = out[k];
      for (std::size_t point = 0; point < kPoints; ++point) {
        const Real value = values[k * kPoints + point];
        if (holds(out[k], value)) continue;
        CHECK_MESSAGE(false, std::string(shape.mnemonic), " gives ", value, " outside of [", out[k].lo, ", ", out[k].hi,
                      "] in the region ", text_of(region));
      }
    }
  }
}

HeldPart copy_of(const TapePart& part) {
  return {{part.code, part.code + part.length},
          {part.origins, part.origins + part.length},
          {part.results, part.results + part.result_count},
          part.registers};
}

/// Prunes a part of a tape, and what is left in a part of the region, and so on; returns how much was dropped.
template <class Real>
std::size_t check_parts(const Tape& tape, Region<Real> region, bool is_distance, bool by_samples, Random& random) {
  Runner<Real> runner(tape);
  const std::vector<Margin> margins = margins_of(tape, region);
  Pruner<Real> pruner(tape, by_samples ? &runner : nullptr);
  const HeldPart all = whole_of(tape);
  const TapePart whole = all.view();
  HeldPart held = all;
  for (int level = 0; level < 3; ++level) {
    if (const std::optional<TapePart> left = pruner.prune(held.view(), region, margins.data())) {
      CHECK(left->registers <= held.registers);
      CHECK(left->length <= held.code.size());
      CHECK(left->result_count == held.results.size());
      held = copy_of(*left);
    }
    const TapePart part = held.view();
    const VectorBuffer<Real> points = points_in(region, random);
    CHECK_MESSAGE(are_same(runner.results(part, points), runner.results(whole, points)), "in ", text_of(region));
    if (is_distance) {
      CHECK_MESSAGE(are_same(runner.gradients(part, points), runner.gradients(whole, points)), "in ", text_of(region));
    }
    region = part_of(region, random);
  }
  return all.code.size() - held.code.size();
}

template <class Real>
std::optional<HeldPart> pruned(const std::shared_ptr<const Program>& program, const Region<Real>& region) {
  const Tape& tape = program->distance();
  Pruner<Real> pruner(tape);
  const std::optional<TapePart> part = pruner.prune(whole_of(tape).view(), region, nullptr);
  return part ? std::optional(copy_of(*part)) : std::nullopt;
}

template <class Real>
std::size_t length_in(const NodePtr& shape, const Region<Real>& region) {
  const auto program = compile(shape);
  const std::optional<HeldPart> part = pruned(program, region);
  return part ? part->code.size() : program->distance().code.size();
}

TEST_CASE("the shapes of these tests hold every opcode") {
  std::set<Opcode> seen;
  for (const Tape* tape : tapes()) {
    for (const Instruction& instruction : tape->code) seen.insert(instruction.op);
  }
  for (std::size_t op = 0; op < kOpcodeCount; ++op) {
    CHECK_MESSAGE(seen.count(static_cast<Opcode>(op)) == 1, std::string(kOpcodes[op].mnemonic));
  }
}

TEST_CASE_TEMPLATE("ranges hold what every instruction gives at points of a region", Real, float, double) {
  Random random(1);  // NOLINT(bugprone-random-generator-seed): the same numbers each time
  for (const Tape* tape : tapes()) {
    for (int trial = 0; trial < 200; ++trial) {
      const Region<Real> region = random_region<Real>(random);
      check_ranges(*tape, region, points_in(region, random));
    }
  }
}

TEST_CASE_TEMPLATE("parts, and parts of parts, give the results of the whole tape", Real, float, double) {
  Random random(2);  // NOLINT(bugprone-random-generator-seed): the same numbers each time
  std::size_t dropped = 0;
  std::size_t sampled = 0;
  for (const auto& program : programs()) {
    for (int trial = 0; trial < 200; ++trial) {
      dropped += check_parts<Real>(program->distance(), random_region<Real>(random), true, false, random);
      sampled += check_parts<Real>(program->distance(), random_region<Real>(random), true, true, random);
      const bool by_samples = trial % 2 == 0;
      dropped += check_parts<Real>(program->attributes().tape, random_region<Real>(random), false, by_samples, random);
      if (program->surface().is_constant()) continue;
      dropped += check_parts<Real>(program->surface().tape, random_region<Real>(random), false, by_samples, random);
    }
  }
  CHECK(dropped > 10000);
  CHECK(sampled > 5000);
}

TEST_CASE_TEMPLATE("a long tape in cells of all sizes", Real, float, double) {
  Random random(3);  // NOLINT(bugprone-random-generator-seed): the same numbers each time
  for (const double k : {0.0, 0.5}) {
    std::vector<NodePtr> rows;
    for (int i = 0; i < 6; ++i) rows.push_back(rotate(row_of_balls(10, k), 50.0 * i, {1.0, i + 0.5, 2.0}));
    const auto program = compile(combine(Kind::kDifference, {combine(Kind::kUnion, rows, k), box({3.0, 1.0, 1.0})}, k));
    for (int trial = 0; trial < 200; ++trial) {
      check_parts<Real>(program->distance(), random_region<Real>(random), true, trial % 2 == 0, random);
    }
  }
}

TEST_CASE_TEMPLATE("what is never decided is never pruned", Real, float, double) {
  Random random(4);  // NOLINT(bugprone-random-generator-seed): the same numbers each time
  for (const NodePtr& shape : primitives()) {
    const auto program = compile(shape);
    const bool has_choice = std::any_of(program->distance().code.begin(), program->distance().code.end(),
                                        [](const Instruction& i) { return i.op == Opcode::kDifference; });
    if (!has_choice) CHECK(!pruned(program, random_region<Real>(random)));
  }
  const auto pair = compile(row_of_balls(2, 0.0));
  CHECK(!pruned<Real>(pair, {{-4, -4, -4}, {4, 4, 4}}));
  constexpr Real kEverywhere = std::numeric_limits<Real>::infinity();
  CHECK(!pruned<Real>(pair, {{-kEverywhere, 0, 0}, {kEverywhere, 0, 0}}));
}

TEST_CASE_TEMPLATE("of a row of balls the near ones are left", Real, float, double) {
  const NodePtr row = row_of_balls(40, 0.0);
  CHECK(length_in<Real>(row, {{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}}) == 1);
  CHECK(length_in<Real>(row, {{1.75, -0.5, -0.5}, {4.25, 0.5, 0.5}}) < 10);
}

TEST_CASE_TEMPLATE("operands of smooth operators are left up to the reach of the blend", Real, float, double) {
  const NodePtr low = plane({0.0, 1.0, 0.0}, {0.0, 0.0, 0.0});    // y
  const NodePtr high = plane({0.0, 1.0, 0.0}, {0.0, -2.0, 0.0});  // y + 2
  const NodePtr level = plane({1.0, 0.0, 0.0}, {0.0, 0.0, 0.0});  // x
  const auto is_kept = [](const NodePtr& shape, const Region<Real>& region) { return !pruned(compile(shape), region); };
  for (const Kind kind : {Kind::kUnion, Kind::kIntersection}) {
    CHECK(is_kept(combine(kind, {low, level}, 1.0), {{0, 0, 0}, {0, Real(0.999), 0}}));
    CHECK(is_kept(combine(kind, {low, level}, 1.0), {{0, Real(0.999), 0}, {0, 2, 0}}));
    CHECK(!is_kept(combine(kind, {low, level}, 1.0), {{0, 1, 0}, {0, 2, 0}}));
    CHECK(is_kept(combine(kind, {low, level}, 2.0), {{0, 1, 0}, {0, 2, 0}}));
  }
  CHECK(is_kept(combine(Kind::kDifference, {low, level}, 1.0), {{0, 0, 0}, {0, Real(0.999), 0}}));
  CHECK(!is_kept(combine(Kind::kDifference, {low, level}, 1.0), {{0, 1, 0}, {0, 2, 0}}));
  CHECK(!is_kept(combine(Kind::kMetaballs, {low, high}, 0.001), {{0, 0, 0}, {0, Real(0.25), 0}}));
  CHECK(is_kept(combine(Kind::kMetaballs, {low, high}, 0.25), {{0, 0, 0}, {0, Real(0.25), 0}}));
}

TEST_CASE_TEMPLATE("choices by a constant", Real, float, double) {
  const Region<Real> left{{-2, 0, 0}, {-1, 1, 1}};
  const Region<Real> right{{1, 0, 0}, {2, 1, 1}};
  const Region<Real> both{{-1, 0, 0}, {1, 1, 1}};
  const auto length = [](const NodePtr& number, const Region<Real>& region) {
    return length_in<Real>(own(plus(number, y())), region);
  };
  for (const NodePtr& number : {absolute(x()), smaller(x(), constant(0.0)), larger(x(), constant(0.0))}) {
    CHECK(length(number, both) == 2);
    CHECK(length(number, left) + length(number, right) < 5);
  }
  const NodePtr choice = chosen(on(Kind::kLess, {x(), constant(0.0)}), y(), z());
  CHECK(length(choice, left) == 1);
  CHECK(length(choice, right) == 1);
  CHECK(length(choice, both) > 2);
}

TEST_CASE_TEMPLATE("samples tell which of many balls are near, and of what else there is only where it has slopes",
                   Real, float, double) {
  const Region<Real> near{{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}};
  const auto left = [&](const NodePtr& shape, const Region<Real>& region) {
    const auto program = compile(shape);
    const Tape& tape = program->distance();
    Runner<Real> runner(tape);
    const std::vector<Margin> margins = margins_of(tape, region);
    Pruner<Real> pruner(tape, &runner);
    const std::optional<TapePart> part = pruner.prune(whole_of(tape).view(), region, margins.data());
    return part ? part->length : tape.code.size();
  };
  CHECK(left(row_of_balls(40, 0.0), near) == 1);
  CHECK(left(row_of_balls(40, 0.25), near) == 1);
  CHECK(left(rotate(row_of_balls(40, 0.0), 30.0, {1.0, 2.0, 3.0}), near) == 1);
  CHECK(left(combine(Kind::kDifference, {box({1.0, 1.0, 1.0}), row_of_balls(40, 0.0)}, 0.0), near) == 3);
  // the nearest of a row changes along it, so that no sample alone tells which to keep
  const Region<Real> along{{Real(-0.5), -0.5, -0.5}, {Real(8.5), 0.5, 0.5}};
  CHECK(left(row_of_balls(40, 0.0), along) < 16);
  CHECK(left(row_of_balls(40, 0.0), {{-1000, -1000, -1000}, {1000, 1000, 1000}}) == 79);
}

}  // namespace
}  // namespace octomarch
