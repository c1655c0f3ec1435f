// What an expression can be over a box: its values and its slope, by interval arithmetic. The builder asks it for
// Lipschitz bounds of the user's own fields; the node graph comes before it.
#pragma once

#include "octomarch/graph/node.hpp"

namespace octomarch {

struct ExpressionBounds {
  double lo = -kInfinity;
  double hi = kInfinity;
  double slope = kInfinity;  ///< ≥ ‖∇‖ everywhere in the box; +inf where no bound is found
};

/// Bounds over `box` (which may be endless), rounded outward. O(nodes), for a bounded box O(nodes · pieces): it is cut
/// into pieces as long as that tightens the slope.
ExpressionBounds expression_bounds(const Node& expression, const Aabb& box);

}  // namespace octomarch
