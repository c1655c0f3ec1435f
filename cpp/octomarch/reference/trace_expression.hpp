// Traces of expressions: the user's own numbers along a piece of a ray. Traces and lattices come before it; those of
// fields ask for it.
#pragma once

#include <cstddef>
#include <vector>

#include "octomarch/reference/steps.hpp"
#include "octomarch/reference/trace.hpp"

namespace octomarch::reference {

/// An expression made ready, as Expression is for points. Not for use by several threads at once.
class TracedExpression {
 public:
  /// Contract: `root` is an expression, and outlives this.
  explicit TracedExpression(const Node& root);

  /// Undefined where it may be no number: by division by 0, or by functions outside of their range.
  const Trace& along(const PointTrace& p);

  std::size_t size() const { return steps_.size(); }

 private:
  Trace result(std::size_t i, const PointTrace& p) const;

  std::vector<Step> steps_;
  std::vector<Interval> ranges_;  // of images, for the steps that look into one
  std::vector<Trace> results_;
};

}  // namespace octomarch::reference
