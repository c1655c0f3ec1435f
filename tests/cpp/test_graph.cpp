// The node graph: interning, graphs of extreme depth and width, canonical forms, and what builders refuse.
#include <atomic>
#include <cmath>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include "octomarch/base/error.hpp"
#include "octomarch/graph/builder.hpp"

namespace octomarch {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr Vec3 kX{1.0, 0.0, 0.0};
constexpr Vec3 kY{0.0, 1.0, 0.0};
constexpr Vec3 kZ{0.0, 0.0, 1.0};

/// The message of the ArgumentError that `build` throws, or nothing.
template <class Build>
std::string refusal(const Build& build) {
  try {
    build();
  } catch (const ArgumentError& error) {
    return error.what();
  }
  return {};
}

NodePtr unite(NodePtr a, NodePtr b, double smooth = 0.0) {
  return combine(NodeKind::kUnion, {std::move(a), std::move(b)}, smooth);
}

TEST_CASE("equal nodes are one object") {
  CHECK(sphere(1.0) == sphere(1.0));
  const NodePtr a = unite(sphere(1.0), translate(box({1.0, 2.0, 3.0}), kX));
  const NodePtr b = unite(sphere(1.0), translate(box({1.0, 2.0, 3.0}), kX));
  CHECK(a == b);
  CHECK(a != unite(sphere(1.0), translate(box({1.0, 2.0, 3.0}), kY)));
  CHECK(a != unite(translate(box({1.0, 2.0, 3.0}), kX), sphere(1.0)));
  CHECK(translate(sphere(1.0), {-0.0, 1.0, 0.0}) == translate(sphere(1.0), {0.0, 1.0, -0.0}));
  CHECK(count_nodes(a) == 4);
  CHECK(count_nodes(unite(a, b)) == 5);
}

TEST_CASE("a node dies with its last user and can be made again") {
  std::weak_ptr<const Node> watched;
  {
    const NodePtr once = sphere(0.123);
    watched = once;
    CHECK_FALSE(watched.expired());
  }
  CHECK(watched.expired());
  CHECK(sphere(0.123)->parameter(0) == 0.123);
}

TEST_CASE("graphs of a hundred thousand nodes, deep or wide, come and go on a small stack") {
  constexpr int kNodes = 100'000;
  NodePtr deep = sphere(1.0);
  for (int i = 1; i <= kNodes; ++i) deep = translate(complement(std::move(deep)), {static_cast<double>(i), 0.0, 0.0});
  CHECK(count_nodes(deep) == 2 * kNodes + 1);
  deep.reset();

  std::vector<NodePtr> shapes;
  for (int i = 0; i < kNodes; ++i) shapes.push_back(translate(sphere(1.0), {i + 1.0, 0.0, 0.0}));
  NodePtr wide = combine(NodeKind::kUnion, std::move(shapes), 0.1);
  CHECK(wide->children().size() == kNodes);
  CHECK(count_nodes(wide) == kNodes + 2);
  wide.reset();

  NodePtr folded = sphere(1.0);
  for (int i = 1; i <= kNodes; ++i) folded = unite(std::move(folded), translate(sphere(1.0), {0.0, i + 0.0, 0.0}));
  CHECK(count_nodes(folded) == 2 * kNodes + 1);
}

TEST_CASE("threads that make and drop the same nodes agree on which they are") {
  std::atomic<int> disagreements = 0;
  const auto work = [&disagreements] {
    for (int i = 0; i < 20'000; ++i) {
      const double radius = i % 7;
      const NodePtr a = complement(sphere(radius));
      const NodePtr b = complement(sphere(radius));
      if (a != b || a->child(0).parameter(0) != radius) ++disagreements;
    }
  };
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();
  CHECK(disagreements == 0);
}

TEST_CASE("operations that change nothing return their shape") {
  const NodePtr shape = box({1.0, 2.0, 3.0});
  CHECK(translate(shape, {0.0, -0.0, 0.0}) == shape);
  CHECK(rotate(shape, 0.0, kX) == shape);
  CHECK(rotate(shape, -720.0, {1.0, 2.0, 3.0}) == shape);
  CHECK(scale(shape, 1.0) == shape);
  CHECK(combine(NodeKind::kDifference, {shape}, 0.5) == shape);
  CHECK(complement(complement(shape)) == shape);
  CHECK(repeat(shape, {1.0, 0.0, 2.0}, {1, 9, 1}) == shape);
}

TEST_CASE("quarter turns are exact") {
  const NodePtr shape = box({1.0, 2.0, 3.0});
  const NodePtr turned = rotate(shape, 90.0, kZ);
  const Mat3 expected = {0, -1, 0, 1, 0, 0, 0, 0, 1};
  for (std::size_t i = 0; i < expected.size(); ++i) CHECK(turned->parameter(i) == expected[i]);
  CHECK(rotate(shape, -270.0, {0.0, 0.0, 5.0}) == turned);
  CHECK(rotate(shape, 90.0 + 360.0 * 1e6, kZ) == turned);
  CHECK(rotate(shape, 180.0, kX) == rotate(shape, -180.0, kX));
}

TEST_CASE("rotations are right-handed and keep lengths") {
  const NodePtr turned = rotate(sphere(1.0), 37.0, {1.0, -2.0, 0.5});
  Mat3 m{};
  for (std::size_t i = 0; i < m.size(); ++i) m[i] = turned->parameter(i);
  const Mat3 product = m * transposed(m);
  for (std::size_t i = 0; i < m.size(); ++i) CHECK(std::abs(product[i] - kIdentity3[i]) < 1e-15);
  const double trace = m[0] + m[4] + m[8];
  CHECK(trace == doctest::Approx(1.0 + 2.0 * std::cos(37.0 * std::acos(-1.0) / 180.0)));
  CHECK(m[3] - m[1] > 0.0);  // 2 sin(angle)·axis.z
}

TEST_CASE("axial primitives take any axis and do not care which way it points") {
  CHECK(torus(2.0, 1.0, {0.0, 0.0, -3.0}) == torus(2.0, 1.0, kZ));
  CHECK(cylinder(1.0, 2.0, kX)->parameter(2) == 0.0);
  CHECK(cylinder(1.0, std::nullopt, kY)->kind() == NodeKind::kCylinder);
  const NodePtr leaning = cylinder(1.0, 2.0, {1.0, -2.0, 2.0});
  REQUIRE(leaning->kind() == NodeKind::kRotate);
  CHECK(leaning->child(0).parameter(2) == 1.0);
  CHECK(leaning == cylinder(1.0, 2.0, {-1.0, 2.0, -2.0}));
  // the middle column is the image of y
  CHECK(leaning->parameter(1) == doctest::Approx(-1.0 / 3.0));
  CHECK(leaning->parameter(4) == doctest::Approx(2.0 / 3.0));
  CHECK(leaning->parameter(7) == doctest::Approx(-2.0 / 3.0));
}

TEST_CASE("repetition centres its copies") {
  const NodePtr shape = repeat(sphere(0.25), {1.0, 2.0, 0.0}, {4, 3, 7});
  const RepeatAxis even = repeat_axis(*shape, 0);
  CHECK(even.period == 1.0);
  CHECK(even.shift == 0.0);
  CHECK(even.limit == 1.5);
  const RepeatAxis odd = repeat_axis(*shape, 1);
  CHECK(odd.shift == 0.5);
  CHECK(odd.limit == 1.0);
  CHECK(repeat_axis(*shape, 2).period == 0.0);
  CHECK(std::isinf(repeat_axis(*repeat(sphere(0.25), kX, {0, 0, 0}), 0).limit));
}

TEST_CASE("builders name the argument and the value they refuse") {
  CHECK(refusal([] { sphere(kNaN); }) == "radius must be finite and >= 0, got nan");
  CHECK(refusal([] { sphere(-0.5); }) == "radius must be finite and >= 0, got -0.5");
  CHECK(refusal([] { box({1.0, kInfinity, 2.0}); }) == "size must be finite and >= 0 on every axis, got (1, inf, 2)");
  CHECK(refusal([] { plane({}, {}); }) == "normal must be finite and not zero, got (0, 0, 0)");
  CHECK(refusal([] { plane(kY, {kNaN, 0.0, 0.0}); }) == "point must be finite, got (nan, 0, 0)");
  CHECK(refusal([] { cylinder(1.0, -1.0, kY); }).starts_with("height must be"));
  CHECK(refusal([] { torus(1.0, kNaN, kY); }).starts_with("tube_radius must be"));
  CHECK(refusal([] { torus(1.0, 1.0, {0.0, 0.0, 0.0}); }).starts_with("axis must be"));
  CHECK(refusal([] { capsule({kNaN, 0.0, 0.0}, {}, 1.0); }).starts_with("a must be finite"));
  CHECK(refusal([] { unite(sphere(1.0), sphere(2.0), -0.1); }) == "smooth must be finite and >= 0, got -0.1");
  CHECK(refusal([] { unite(sphere(1.0), sphere(2.0), kInfinity); }).starts_with("smooth must be"));
  CHECK(refusal([] { unite(sphere(1.0), nullptr); }).starts_with("shapes must be"));
  CHECK(refusal([] { combine(NodeKind::kUnion, {}, 0.0); }) == "shapes must be at least one shape, got none");
  CHECK(refusal([] { combine(NodeKind::kPaint, {sphere(1.0)}, 0.0); }).starts_with("kind must be"));
  CHECK(refusal([] { complement(nullptr); }).starts_with("shape must be"));
  CHECK(refusal([] { translate(sphere(1.0), {0.0, kNaN, 0.0}); }) == "offset must be finite, got (0, nan, 0)");
  CHECK(refusal([] { rotate(sphere(1.0), kInfinity, kX); }) == "degrees must be finite, got inf");
  CHECK(refusal([] { scale(sphere(1.0), 0.0); }) == "factor must be finite and > 0, got 0");
  CHECK(refusal([] { repeat(sphere(1.0), {-1.0, 0.0, 0.0}, {}); }).starts_with("period must be"));
  CHECK(refusal([] { repeat(sphere(1.0), {}, {}); }).starts_with("period must be"));
  CHECK(refusal([] { repeat(sphere(1.0), kX, {-1, 0, 0}); }).starts_with("counts must be"));
  CHECK(refusal([] { paint(sphere(1.0), {}); }).starts_with("material must be an expression"));
}

TEST_CASE("paint carries its material") {
  Material material = default_material();
  material.slots[3] = expression(NodeKind::kSine, {coordinate(0)});
  CHECK(material_of(*paint(sphere(1.0), material)) == material);
}

TEST_CASE("roughness runs from a sharp highlight to a dull one") {
  CHECK(phong_exponent(0.0) == 8192.0);
  CHECK(phong_exponent(0.5) == doctest::Approx(30.0));
  CHECK(phong_exponent(1.0) == 1.0);
}

}  // namespace
}  // namespace octomarch
