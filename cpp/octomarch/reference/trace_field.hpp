// The field of a node graph along a piece of a ray. Traces of primitives, expressions and operators come before it; the
// certified search asks it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "octomarch/graph/node.hpp"
#include "octomarch/reference/poll.hpp"
#include "octomarch/reference/trace.hpp"
#include "octomarch/reference/trace_domain.hpp"
#include "octomarch/reference/trace_expression.hpp"

namespace octomarch::reference {

/// Walks one graph as Evaluator does, but with traces: constant stack, and each shared part once for each way that leads to
/// it. Not for use by several threads at once.
class FieldTracer {
 public:
  /// Contract: `root` is not null.
  FieldTracer(NodePtr root, Poll poll);

  /// Undefined where the field may be no number.
  Trace along(const PointTrace& p);

 private:
  /// What a kRepeat has met so far.
  struct CopyVisits {
    Copies copies;
    std::vector<Trace> traces;
  };
  /// A node on the way down, how many visits it has made, and their fold so far.
  struct Frame {
    const Node* node;
    PointTrace p;
    std::size_t visits = 0;
    Trace trace{};
    std::unique_ptr<CopyVisits> repeat = nullptr;
  };
  struct Place {
    const Node* node;
    PointTrace p;
    friend bool operator==(const Place&, const Place&) = default;
  };
  struct PlaceHash {
    std::size_t operator()(const Place& place) const;
  };

  void push(const Node& node, const PointTrace& p);
  bool descend();
  static void absorb(Frame& parent, const Trace& child);
  Trace finish(Frame& frame);
  Trace primitive(const Node& node, const PointTrace& p);
  Trace field(const Node& node, const PointTrace& p);
  const Trace& expression_along(const Node& root, const PointTrace& p);
  void count_work(std::size_t amount);

  NodePtr root_;
  Poll poll_;
  std::unordered_set<const Node*> shared_;
  std::unordered_map<Place, Trace, PlaceHash> known_;
  std::unordered_map<const Node*, TracedExpression> expressions_;
  std::vector<Frame> stack_;
  std::uint64_t work_done_ = 0;
};

}  // namespace octomarch::reference
