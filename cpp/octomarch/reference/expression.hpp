// Expressions at a point, by a walk over their nodes. Noise and texels come before it; fields, materials and skies ask it.
#pragma once

#include <cstddef>
#include <vector>

#include "octomarch/graph/node.hpp"
#include "octomarch/reference/jet.hpp"
#include "octomarch/reference/steps.hpp"

namespace octomarch::reference {

/// An expression made ready: its distinct nodes, operands first. Constant stack whatever its depth. Keeps references to
/// the nodes. Not for use by several threads at once.
template <class T>
class Expression {
 public:
  /// Contract: `root` is an expression.
  explicit Expression(const Node& root);

  /// Value and gradient. `normal` stands in coordinates 3 to 5, and counts as constant.
  Jet<T> at(const Vector<T>& point, const Vector<T>& normal = Vector<T>(0));

  /// Nodes that a lookup evaluates.
  std::size_t size() const { return steps_.size(); }

 private:
  std::vector<Step> steps_;
  std::vector<Jet<T>> results_;
};

extern template class Expression<float>;
extern template class Expression<double>;

}  // namespace octomarch::reference
