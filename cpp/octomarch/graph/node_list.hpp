// Nodes in a row, each after its children, as scene files keep them: graphs taken apart, and made again of what nobody has
// checked. The schema comes before it; bindings give it to Python.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "octomarch/graph/expression_bounds.hpp"
#include "octomarch/graph/node.hpp"

namespace octomarch {

/// All nodes that can be reached from `roots`, each once and after its children, in an order that depends on nothing but
/// the graph. O(nodes + children), constant stack.
std::vector<NodePtr> children_first(std::span<const NodePtr> roots);

/// Nodes of unknown origin, made in such an order.
class NodeList {
 public:
  /// Appends the node of that name. `children` are places of nodes in this list. Throws ArgumentError that names the
  /// parameter or child and the value, where the result would be a node that no builder makes. O(parameters + children +
  /// texels), also where that depends on all that lies below.
  void append(std::string_view kind, std::vector<double> parameters, std::span<const std::size_t> children,
              std::vector<float> texels);

  std::size_t size() const { return nodes_.size(); }
  const NodePtr& at(std::size_t i) const { return nodes_.at(i); }

 private:
  std::vector<NodePtr> nodes_;
  Amplitudes amplitudes_;
};

}  // namespace octomarch
