// Graphs as lists of nodes: taken apart children first, and made again with every check of the builders.
#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "octomarch/base/error.hpp"
#include "octomarch/graph/builder.hpp"
#include "octomarch/graph/node_list.hpp"
#include "octomarch/graph/schema.hpp"

namespace octomarch {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct Item {
  std::string kind;
  std::vector<double> parameters;
  std::vector<std::size_t> children;
  std::vector<float> texels;
};

/// The message with which the last of the nodes is refused, or nothing.
std::string refusal(const std::vector<Item>& items) {
  NodeList list;
  for (const Item& item : items) {
    try {
      list.append(item.kind, item.parameters, item.children, item.texels);
    } catch (const ArgumentError& error) {
      CHECK(list.size() + 1 == items.size());
      return error.what();
    }
  }
  return {};
}

/// The same graph, by way of a list.
NodePtr again(const NodePtr& root) {
  const std::vector<NodePtr> nodes = children_first({&root, 1});
  NodeList list;
  for (const NodePtr& node : nodes) {
    std::vector<std::size_t> children;
    for (const NodePtr& child : node->children()) {
      const auto place = std::ranges::find(nodes, child) - nodes.begin();
      children.push_back(static_cast<std::size_t>(place));
    }
    list.append(name(node->kind()), {node->parameters().begin(), node->parameters().end()}, children,
                {node->texels().begin(), node->texels().end()});
  }
  return list.at(list.size() - 1);
}

TEST_CASE("a list holds each node once, after its children") {
  const NodePtr ball = sphere(1.0);
  const NodePtr pair = combine(NodeKind::kUnion, {ball, translate(ball, {1.0, 0.0, 0.0})}, 0.0);
  const NodePtr root = combine(NodeKind::kIntersection, {pair, ball, pair}, 0.5);
  const std::vector<NodePtr> nodes = children_first({&root, 1});
  REQUIRE(nodes.size() == 4);
  CHECK(nodes[0] == ball);
  CHECK(nodes[1] == translate(ball, {1.0, 0.0, 0.0}));
  CHECK(nodes[2] == pair);
  CHECK(nodes[3] == root);
  const std::vector<NodePtr> both{ball, root};
  CHECK(children_first(both) == nodes);
  CHECK(children_first({}).empty());
}

TEST_CASE("what builders make can be made again") {
  const NodePtr wave = expression(NodeKind::kSine, {expression(NodeKind::kMultiply, {constant(4.0), coordinate(0)})});
  CHECK(again(wave) == wave);
  const NodePtr waved = displace(twist(box({1.0, 2.0, 3.0}), 30.0, 1), wave, std::nullopt);
  CHECK(again(waved) == waved);
  const NodePtr picture = image(2, 1, {0.0F, 0.25F, 0.5F, 1.0F, -1.0F, 1e30F});
  const NodePtr looked_up = texel(picture, coordinate(0), coordinate(1), 2, 1);
  CHECK(again(looked_up) == looked_up);
  const NodePtr cut = field(wave, 5.0, Aabb{{-1.0, -kInfinity, 0.0}, {1.0, kInfinity, 2.0}});
  CHECK(again(cut) == cut);
}

TEST_CASE("what no builder makes is refused by name and value") {
  const std::vector<std::vector<Item>> refused{
      {{"ball", {1.0}, {}, {}}},
      {{"sphere", {-1.0}, {}, {}}},
      {{"sphere", {kNaN}, {}, {}}},
      {{"sphere", {}, {}, {}}},
      {{"sphere", {1.0}, {}, {1.0F}}},
      {{"sphere", {1.0}, {}, {}}, {"complement", {}, {1}, {}}},
      {{"sphere", {1.0}, {}, {}}, {"negate", {}, {0}, {}}},
      {{"union", {0.0}, {}, {}}},
      {{"coordinate", {0.5}, {}, {}}},
      {{"constant", {kNaN}, {}, {}}},
      {{"image", {1.0, 1.0}, {}, {0.0F, 0.0F, std::numeric_limits<float>::infinity()}}},
      {{"image", {2.0, 1.0}, {}, {0.0F, 0.0F, 0.0F}}},
  };
  const std::vector<std::string> messages{
      "kind must be a kind of node that this version knows, got ball",
      "radius must be finite and >= 0, got -1",
      "radius must be finite and >= 0, got nan",
      "parameters must be 1 numbers, got 0",
      "texels must be those of an image or a grid, got sphere",
      "children[0] must be the place of a node before this one, got 1",
      "children[0] must be expression, got shape",
      "children must be at least 1 nodes, got 0",
      "index must be a whole number from 0 to 2147483647, got 0.5",
      "value must be a number, got nan",
      "texels must be finite, got some that are not",
      "texels must be 3 for each of the image's pixels, got 3",
  };
  for (std::size_t i = 0; i < refused.size(); ++i) CHECK(refusal(refused[i]) == messages[i]);
}

TEST_CASE("amplitudes are those that the builder finds") {
  const NodePtr x = coordinate(0);
  const NodePtr sine = expression(NodeKind::kSine, {x});
  const NodePtr scaled = expression(NodeKind::kMultiply, {constant(0.3), sine});
  const NodePtr picture = image(1, 2, {0.0F, 0.0F, 0.5F, 0.0F, 0.0F, -2.0F});
  const NodePtr blue = texel(picture, x, sine, 2, 0);
  Amplitudes amplitudes;
  for (const NodePtr& wave : {scaled, sine, constant(-7.0), blue, x, scaled}) {
    CHECK(amplitudes.of(*wave) == displace(sphere(1.0), wave, 1.0)->parameter(1));
  }
}

TEST_CASE("nodes know what they are made of") {
  const NodePtr z = coordinate(2);
  const NodePtr flat = rectangle({1.0, 1.0});
  CHECK(z->uses_z());
  CHECK_FALSE(coordinate(0)->uses_z());
  CHECK(expression(NodeKind::kAdd, {constant(1.0), expression(NodeKind::kSine, {coordinate(4)})})->uses_normal());
  CHECK_FALSE(z->uses_normal());
  CHECK(flat->is_flat());
  CHECK(translate(flat, {0.0, 0.0, 5.0})->is_flat());
  CHECK(rotate(flat, 30.0, {0.0, 0.0, 1.0})->is_flat());
  CHECK_FALSE(rotate(flat, 30.0, {0.0, 1.0, 1.0})->is_flat());
  CHECK(solid(coordinate(1))->is_flat());
  CHECK_FALSE(solid(z)->is_flat());
  CHECK_FALSE(displace(flat, z, 1.0)->is_flat());
  Material by_height = default_material();
  by_height.slots[0] = z;
  CHECK(paint(flat, by_height)->is_flat());
  CHECK_FALSE(combine(NodeKind::kUnion, {flat, sphere(1.0)}, 0.0)->is_flat());
  CHECK_FALSE(extrude(flat, 1.0)->is_flat());
}

}  // namespace
}  // namespace octomarch
