#include "octomarch/reference/steps.hpp"

#include <span>
#include <unordered_map>

namespace octomarch::reference {
namespace {

/// What stands above a node's operands; images are parameters, no operands.
std::span<const NodePtr> operands(const Node& node) {
  return node.children().subspan(node.kind() == NodeKind::kTexel ? 1 : 0);
}

}  // namespace

std::vector<Step> steps_of(const Node& root) {
  std::vector<Step> steps;
  std::unordered_map<const Node*, std::size_t> index_of;
  std::vector<const Node*> work{&root};
  while (!work.empty()) {
    const Node* const node = work.back();
    const std::size_t waiting = work.size();
    for (const NodePtr& operand : operands(*node)) {
      if (!index_of.contains(operand.get())) work.push_back(operand.get());
    }
    if (work.size() > waiting) continue;
    work.pop_back();
    if (index_of.contains(node)) continue;
    Step step{node, {}};
    for (std::size_t i = 0; i < operands(*node).size(); ++i) step.operands[i] = index_of.at(operands(*node)[i].get());
    index_of.emplace(node, steps.size());
    steps.push_back(step);
  }
  return steps;
}

}  // namespace octomarch::reference
