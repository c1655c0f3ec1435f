// Which materials a graph has, and which paint gives which. The node graph comes before it; the evaluator asks it what
// the primitive it arrived at is made of.
#pragma once

#include <unordered_map>
#include <vector>

#include "octomarch/graph/node.hpp"
#include "octomarch/graph/scene.hpp"

namespace octomarch::reference {

/// Distinct materials in order of first appearance over primitives, depth first, children from left to right.
struct MaterialTable {
  std::vector<Material> materials;
  std::unordered_map<const Node*, int> index_of_paint;  ///< for each kPaint node that is the innermost of a primitive
  int index_of_unpainted = -1;                          ///< of default_material(), where a primitive has no paint
};

/// O(nodes) for a graph in which no shared sub-shape is painted from outside in several ways.
MaterialTable collect_materials(const Node& root);

}  // namespace octomarch::reference
