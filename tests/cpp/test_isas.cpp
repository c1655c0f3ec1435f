// Pictures and queries by every instruction set have the bits of one lane's. pytest holds the same of far more; this runs where
// Python does not, such as on a processor that is emulated.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <vector>

#include <doctest/doctest.h>

#include "octomarch/graph/builder.hpp"
#include "octomarch/program/program.hpp"
#include "octomarch/render/query.hpp"
#include "octomarch/render/render.hpp"

namespace octomarch {
namespace {

constexpr std::uint32_t kWidth = 45, kHeight = 37;  // no whole number of blocks

/// Primitives, blends, repeats, turns, an expression, a floor; enough of them for an octree.
NodePtr shape() {
  std::vector<NodePtr> parts{plane({0, 1, 0}, {0, -1, 0}), twist(box({1, 2, 1}), 40.0, 1),
                             repeat(sphere(0.2), {1, 0, 1}, {3, 1, 3})};
  const NodePtr x = coordinate(0);
  const NodePtr wave = expression(NodeKind::kSine, {expression(NodeKind::kMultiply, {x, constant(7.0)})});
  parts.push_back(translate(
      displace(torus(0.8, 0.2, {0, 1, 0}), expression(NodeKind::kMultiply, {wave, constant(0.05)}), std::nullopt),
      {1.5, 0.5, 0.0}));
  std::vector<NodePtr> balls;
  for (int i = 0; i < 60; ++i) {
    const double a = 0.7 * i;
    balls.push_back(translate(sphere(0.15), {2.0 * std::cos(a), -0.5 + 0.03 * i, 2.0 * std::sin(a)}));
  }
  parts.push_back(combine(NodeKind::kUnion, std::move(balls), 0.1));
  return combine(NodeKind::kUnion, std::move(parts), 0.0);
}

Scene scene() {
  Scene result;
  result.lights.push_back({});
  result.sky.color = {constant(0.2), coordinate(1), constant(0.5)};
  return result;
}

template <class Real>
struct Picked {
  std::vector<Real> color, depth, normal;
  std::vector<std::int32_t> object, steps;
  std::vector<std::uint8_t> status;
};

template <class Real>
Picked<Real> picture(const Program& program, const kernels::Isa& isa, const March& march) {
  constexpr std::size_t kPixels = std::size_t{kWidth} * kHeight;
  Picked<Real> result{std::vector<Real>(3 * kPixels),     std::vector<Real>(kPixels),
                      std::vector<Real>(3 * kPixels),     std::vector<std::int32_t>(kPixels),
                      std::vector<std::int32_t>(kPixels), std::vector<std::uint8_t>(kPixels)};
  Planes<Real> planes;
  planes.color = result.color.data();
  planes.depth = result.depth.data();
  planes.normal = result.normal.data();
  planes.object_id = result.object.data();
  planes.steps = result.steps.data();
  planes.status = result.status.data();
  Camera camera;
  camera.eye = {4, 3, 6};
  const Scene lit = scene();
  render(Picture{&program, &lit, camera, march, Shading{}, kWidth, kHeight, {0, 0, kWidth, kHeight}, 1}, planes, isa, 2,
         Listener{});
  return result;
}

template <class Number>
bool same_bits(const std::vector<Number>& a, const std::vector<Number>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Number)) == 0;
}

TEST_CASE_TEMPLATE("every instruction set renders the bits of one lane", Real, float, double) {
  const Program program(shape());
  for (const Method method : {Method::kAuto, Method::kPlain, Method::kRelaxed, Method::kCertified}) {
    March march;
    march.method = method;
    const Picked<Real> expected = picture<Real>(program, kernels::find_isa("scalar"), march);
    CHECK(std::count(expected.status.begin(), expected.status.end(), std::uint8_t{0}) > 500);
    for (const kernels::Isa& isa : kernels::available_isas()) {
      CAPTURE(isa.name);
      const Picked<Real> found = picture<Real>(program, isa, march);
      CHECK(same_bits(found.color, expected.color));
      CHECK(same_bits(found.depth, expected.depth));
      CHECK(same_bits(found.normal, expected.normal));
      CHECK(same_bits(found.object, expected.object));
      CHECK(same_bits(found.steps, expected.steps));
      CHECK(same_bits(found.status, expected.status));
    }
  }
}

TEST_CASE_TEMPLATE("every instruction set finds the distances and gradients of one lane", Real, float, double) {
  const Program program(shape());
  constexpr std::size_t kCount = 5000;
  std::vector<double> points;
  for (std::size_t i = 0; i < 3 * kCount; ++i) points.push_back(3.0 * std::sin(1.7 * static_cast<double>(i)));
  const auto query = [&](const kernels::Isa& isa) {
    std::vector<Real> values(4 * kCount);
    const Execution how{&isa, 2, {}};
    query_distance<Real>(program, points.data(), kCount, values.data(), how);
    query_gradient<Real>(program, points.data(), kCount, values.data() + kCount, how);
    return values;
  };
  const std::vector<Real> expected = query(kernels::find_isa("scalar"));
  for (const kernels::Isa& isa : kernels::available_isas()) {
    CAPTURE(isa.name);
    CHECK(same_bits(query(isa), expected));
  }
}

}  // namespace
}  // namespace octomarch
