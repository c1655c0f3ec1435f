// An expression's nodes in a row, as they are evaluated. The node graph comes before it; values at points and traces along
// rays are both worked out step by step.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "octomarch/graph/node.hpp"

namespace octomarch::reference {

struct Step {
  const Node* node;
  std::array<std::size_t, 3> operands;  ///< indices of earlier steps
};

/// Each distinct node once, after its operands; `root` is the last. Images are no operands. Constant stack.
std::vector<Step> steps_of(const Node& root);

}  // namespace octomarch::reference
