// Gradients that take the derivatives of coordinates as known are those that compute with them, and it is where they can be
// known that they are.
#include <algorithm>
#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include "octomarch/graph/builder.hpp"
#include "octomarch/program/program.hpp"
#include "octomarch/render/loaded_tape.hpp"

namespace octomarch {
namespace {

NodePtr union_of(std::vector<NodePtr> shapes) { return combine(NodeKind::kUnion, std::move(shapes), 0.0); }

/// Every operator that has a form for coordinates, beside some that have none.
std::vector<NodePtr> shapes() {
  const Vec3 place{0.3, -0.2, 0.1};
  const NodePtr x = coordinate(0);
  const NodePtr wave = expression(NodeKind::kSine, {expression(NodeKind::kMultiply, {x, coordinate(2)})});
  const NodePtr primitives = union_of(
      {sphere(0.5), translate(sphere(0.3), {1, 1, 1}), box({1, 2, 3}), translate(box({0.4, 0.4, 0.4}), {-1, 1, 0}),
       box({0.3, 0.4, 0.5}, NodeKind::kBoxExterior), box({0.3, 0.4, 0.5}, NodeKind::kBoxMaximum),
       plane({1, 2, 3}, {0, -2, 0}), capsule({1, 0, 0}, {0, 1, 0.5}, 0.2)});
  std::vector<NodePtr> result{primitives, field(x, 1.0, std::nullopt), displace(primitives, wave, 3.0)};
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 along{axis == 0 ? 1.0 : 0.0, axis == 1 ? 1.0 : 0.0, axis == 2 ? 1.0 : 0.0};
    const NodePtr round = union_of({cylinder(0.3, std::nullopt, along), cylinder(0.4, 1.5, along), torus(1, 0.2, along),
                                    plane(along, place), translate(cylinder(0.2, std::nullopt, along), place)});
    result.push_back(round);
    result.push_back(repeat(translate(round, place), {3, 2, 4}, {0, 0, 0}));
    result.push_back(repeat(translate(primitives, place), {2, 0, 3}, {3, 0, 2}));
    result.push_back(rotate(union_of({round, repeat(sphere(0.2), {1, 1, 1}, {0, 0, 0})}), 33.0, {1, 2, 3}));
    result.push_back(union_of({rotate(primitives, 90.0, along), extrude(rectangle({1.0, 0.5}), 2.0)}));
  }
  return result;
}

template <class Real>
VectorBuffer<Real> points(std::size_t count) {
  VectorBuffer<Real> rows(kernels::padded_lanes(count));
  for (std::size_t i = 0; i < count; ++i) {
    const double a = static_cast<double>(i);
    rows.x[i] = static_cast<Real>(2.0 * std::sin(1.7 * a));
    rows.y[i] = static_cast<Real>(i % 5 == 0 ? 0.5 : 2.0 * std::sin(2.3 * a));
    rows.z[i] = static_cast<Real>(i % 7 == 0 ? 0.0 : 2.0 * std::sin(3.1 * a));
  }
  return rows;
}

std::vector<bool> are_on_coordinates(const NodePtr& shape) {
  const Program program(shape);
  const Tape& tape = program.distance();
  const std::vector<AxisStep> steps = axis_steps(tape.code, tape.registers, tape.result());
  std::vector<bool> found;
  for (std::size_t i = 0; i < tape.code.size(); ++i) found.push_back(steps[i].is_on_coordinates);
  return found;
}

TEST_CASE_TEMPLATE("known derivatives give the gradients of computed ones", Real, float, double) {
  constexpr std::size_t kCount = 500;
  const VectorBuffer<Real> at = points<Real>(kCount);
  for (const NodePtr& shape : shapes()) {
    const Program program(shape);
    CAPTURE(listing(program));
    LoadedTape<Real> tape(program.distance(), TapeUse::kGradients);
    kernels::TapeView<Real> computing = tape.view();
    computing.axes = nullptr;
    const bool never = false;
    for (const kernels::Isa& isa : kernels::available_isas()) {
      CAPTURE(isa.name);
      VectorBuffer<Real> found(kernels::padded_lanes(kCount));
      VectorBuffer<Real> expected(kernels::padded_lanes(kCount));
      isa.table<Real>().gradient(tape.view(), tape.memory(), at.read(), kCount, &never, found.view());
      isa.table<Real>().gradient(computing, tape.memory(), at.read(), kCount, &never, expected.view());
      CHECK(std::equal(found.x.data(), found.x.data() + kCount, expected.x.data()));
      CHECK(std::equal(found.y.data(), found.y.data() + kCount, expected.y.data()));
      CHECK(std::equal(found.z.data(), found.z.data() + kCount, expected.z.data()));
    }
  }
}

TEST_CASE("coordinates stay known where they are moved, and repeated") {
  using Steps = std::vector<bool>;
  CHECK(are_on_coordinates(translate(box({1, 2, 3}), {1, 2, 3})) == Steps{true});
  CHECK(are_on_coordinates(repeat(cylinder(0.2, std::nullopt, {1, 0, 0}), {0, 1, 1}, {0, 0, 0})) ==
        Steps{true, true, true});
  CHECK(are_on_coordinates(rotate(box({1, 2, 3}), 33.0, {1, 2, 3})) == Steps{false, false});
  CHECK(are_on_coordinates(extrude(rectangle({1.0, 0.5}), 2.0)) == Steps{true, false});
}

TEST_CASE("a coordinate that stands twice among the inputs is none") {
  const std::vector<Instruction> code{{Opcode::kOriginSphere, {3, 0, 0}, {0, 1, 0, 0}, 0},
                                      {Opcode::kOriginCylinder, {4, 0, 0}, {2, 0, 0, 0}, 0}};
  const std::vector<AxisStep> steps = axis_steps(code, 5, 4);
  CHECK_FALSE(steps[0].is_on_coordinates);
  CHECK(steps[0].axes == std::array<std::uint8_t, 3>{0, 1, 0});
  CHECK(steps[1].is_on_coordinates);
  CHECK(steps[1].axes == std::array<std::uint8_t, 3>{2, 0, 1});
  CHECK(steps[2].axes == std::array<std::uint8_t, 3>{kNoAxis, kNoAxis, kNoAxis});
}

}  // namespace
}  // namespace octomarch
