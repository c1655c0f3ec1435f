// What an expression can be over a box: its values and its slope, by interval arithmetic. The builder asks it for
// Lipschitz bounds of the user's own fields, lists of nodes for what displaces shapes; the node graph comes before it.
#pragma once

#include <memory>

#include "octomarch/graph/node.hpp"

namespace octomarch {

/// Bounds of gradient noise and of the length of its gradient, found by branch and bound over a cell, with the worst of
/// the twelve gradients at each corner (tests/cpp/test_noise_bounds.cpp); those that are met are 1.0363 and 3.75.
inline constexpr double kNoiseValue = 1.05;
inline constexpr double kNoiseSlope = 3.8;

struct ExpressionBounds {
  double lo = -kInfinity;
  double hi = kInfinity;
  double slope = kInfinity;  ///< ≥ ‖∇‖ everywhere in the box; +inf where no bound is found
};

/// Bounds over `box` (which may be endless), rounded outward. O(nodes), for a bounded box O(nodes · pieces): it is cut
/// into pieces as long as that tightens the slope.
ExpressionBounds expression_bounds(const Node& expression, const Aabb& box);

/// How large |expression| can be anywhere, for any number of expressions. Each node that they share is looked at once,
/// so that asking for all of a graph is O(nodes). Contract: every expression asked for outlives this.
class Amplitudes {
 public:
  Amplitudes();
  ~Amplitudes();
  Amplitudes(const Amplitudes&) = delete;
  Amplitudes& operator=(const Amplitudes&) = delete;

  double of(const Node& expression);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace octomarch
