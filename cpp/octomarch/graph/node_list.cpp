#include "octomarch/graph/node_list.hpp"

#include <string>
#include <unordered_set>
#include <utility>

#include "octomarch/base/error.hpp"
#include "octomarch/graph/schema.hpp"
#include "octomarch/graph/text.hpp"

namespace octomarch {
namespace {

/// Another machine's library functions may put the last digits of a bound elsewhere.
constexpr double kAsGoodAs = 1.0 - 1e-9;

}  // namespace

std::vector<NodePtr> children_first(std::span<const NodePtr> roots) {
  std::vector<NodePtr> order;
  std::unordered_set<const Node*> known;  // of those that are held more than once
  std::vector<std::pair<const NodePtr*, bool>> stack;
  for (const NodePtr& root : roots) {
    stack.emplace_back(&root, false);
    while (!stack.empty()) {
      const auto [node, children_done] = stack.back();
      stack.pop_back();
      const bool is_met_once = has_one_owner(*node);
      if (!is_met_once && known.contains(node->get())) continue;
      if (children_done) {
        if (!is_met_once) known.insert(node->get());
        order.push_back(*node);
        continue;
      }
      stack.emplace_back(node, true);
      const std::span<const NodePtr> children = (*node)->children();
      for (std::size_t i = children.size(); i-- > 0;) stack.emplace_back(&children[i], false);
    }
  }
  return order;
}

void NodeList::append(std::string_view kind, std::vector<double> parameters, std::span<const std::size_t> children,
                      std::vector<float> texels) {
  std::vector<NodePtr> nodes;
  for (std::size_t i = 0; i < children.size(); ++i) {
    require(children[i] < nodes_.size(), "children[" + std::to_string(i) + "]", "the place of a node before this one",
            children[i]);
    nodes.push_back(nodes_[children[i]]);
  }
  NodePtr node = checked_node(kind, std::move(parameters), std::move(nodes), std::move(texels));
  if (node->kind() == NodeKind::kDisplace) {
    const double least = amplitudes_.of(node->child(1));
    require(node->parameter(1) >= least * kAsGoodAs, "amplitude",
            "at least " + text(least) + ", as much as the expression displaces by", text(node->parameter(1)));
  }
  nodes_.push_back(std::move(node));
}

}  // namespace octomarch
