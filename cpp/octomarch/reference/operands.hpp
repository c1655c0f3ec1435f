// What shapes are made of: which children of a node are shapes, and which of all below it are met more than once. The node
// graph comes before it; walks over fields and materials ask it.
#pragma once

#include <span>
#include <unordered_set>

#include "octomarch/graph/node.hpp"

namespace octomarch::reference {

/// The children of a shape that are shapes; none of a primitive.
std::span<const NodePtr> operand_shapes(const Node& shape);

/// Combinations, transforms and the user's own fields below `root` that are reached from more than one place.
std::unordered_set<const Node*> shared_nodes(const Node& root);

}  // namespace octomarch::reference
