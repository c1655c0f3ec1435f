#include "octomarch/reference/operands.hpp"

#include <vector>

namespace octomarch::reference {

std::span<const NodePtr> operand_shapes(const Node& shape) {
  const std::span<const NodePtr> children = shape.children();
  switch (shape.kind()) {
    case NodeKind::kField:
    case NodeKind::kSolid: return {};
    case NodeKind::kPaint:
    case NodeKind::kDisplace: return children.first(1);
    default: return children;
  }
}

std::unordered_set<const Node*> shared_nodes(const Node& root) {
  std::unordered_set<const Node*> seen;
  std::unordered_set<const Node*> shared;
  std::vector<const Node*> work{&root};
  while (!work.empty()) {
    const Node* const node = work.back();
    work.pop_back();
    for (const NodePtr& child : operand_shapes(*node)) {
      if (child->children().empty()) continue;
      if (seen.insert(child.get()).second) {
        work.push_back(child.get());
      } else {
        shared.insert(child.get());
      }
    }
  }
  return shared;
}

}  // namespace octomarch::reference
