// Operators over points, for traces: where they look at their child along a piece of a ray. Traces come before it; the walk
// over a field goes down through it.
#pragma once

#include <cstddef>
#include <vector>

#include "octomarch/graph/node.hpp"
#include "octomarch/reference/trace.hpp"

namespace octomarch::reference {

/// Where an operator over points, other than a kRepeat, evaluates its child; p itself for all other nodes.
PointTrace child_trace(const Node& node, const PointTrace& p);

/// What a kTwist or kBend is cut to: the distance to the cylinder that holds it.
Trace wall_trace(const Node& node, const PointTrace& p);

/// The copies that a kRepeat may look at along a piece. A point between two neighbouring centres looks at these two, per
/// axis; a piece may reach over one centre. Where it goes farther, only where the copies can be is known.
class Copies {
 public:
  Copies(const Node& repeat, const PointTrace& p);

  std::size_t size() const { return copies_.size(); }
  /// Where copy `i` evaluates the child.
  PointTrace point(std::size_t i) const;
  /// The field, from the child's along each copy, in their order.
  Trace nearest(const std::vector<Trace>& children) const;

 private:
  /// A range of gaps between neighbouring centres, each by the number of its lower one.
  struct Gaps {
    double first;
    double last;
  };
  enum class Part : std::uint8_t { kOver, kFirst, kLast };
  enum class Use : std::uint8_t { kNever, kMaybe, kAlways };

  /// The copies along one axis: number n has its centre at (n + shift)·period, |n + shift| ≤ limit.
  class Row {
   public:
    Row(const RepeatAxis& constants, const Trace& x);

    std::size_t size() const { return is_known_ ? static_cast<std::size_t>(highest_ - lowest_) + 1 : 1; }
    /// The coordinate as copy `i` sees it.
    Trace seen_by(std::size_t i, const Trace& x) const;
    /// Is the copy among those that are looked at in a part of the piece?
    Use use(std::size_t i, Part part) const;

   private:
    Gaps gaps_over(const Interval& x) const;
    double existing(double number) const;
    Trace seen_by_any(const Trace& x) const;

    double period_;  // 0: one copy, where the child is
    double shift_;
    double limit_;
    bool is_known_ = true;        // which copies are looked at?
    std::array<Gaps, 3> gaps_{};  // over the parts
    double lowest_ = 0.0;
    double highest_ = 0.0;
  };
  using Place = std::array<std::size_t, 3>;  // of a copy in each row

  Use use(const Place& place, Part part) const;

  PointTrace p_;
  std::array<Row, 3> rows_;
  std::vector<Place> copies_;
};

}  // namespace octomarch::reference
