// The walk: frames go down with points, traces come up. See trace_field.hpp.
#include "octomarch/reference/trace_field.hpp"

#include <algorithm>
#include <bit>
#include <functional>
#include <limits>
#include <utility>

#include "octomarch/reference/operands.hpp"
#include "octomarch/reference/trace_primitives.hpp"

namespace octomarch::reference {
namespace {

constexpr std::uint64_t kWorkPerPoll = 1U << 12U;  // some milliseconds

/// The distance of every point of a solid from its surface, which nobody knows.
constexpr double kSolidDistance = std::numeric_limits<float>::min();

/// Inside where the expression is not 0.
Trace solid(const Trace& truth) {
  const auto distance = [](const Interval& value) -> Interval {
    if (!value.contains(0.0)) return -kSolidDistance;
    return value == Interval(0.0) ? Interval(kSolidDistance) : Interval{-kSolidDistance, kSolidDistance};
  };
  Trace result{distance(truth.over), distance(truth.first), distance(truth.last), Interval::whole()};
  if (result.over.is_point()) result = constant(result.over);
  result.is_undefined = truth.is_undefined;
  return result;
}

/// A solid's values say nothing of how far it is, so scales leave them; where some part is a solid, they may.
Trace scaled(const Trace& a, double factor, bool may_be_solid) {
  const Trace result = a * factor;
  if (!may_be_solid || factor == 1.0) return result;
  return {hull(a.over, result.over),
          hull(a.first, result.first),
          hull(a.last, result.last),
          Interval::whole(),
          false,
          a.is_undefined};
}

double scale_of(const Node& node) {
  if (node.kind() == NodeKind::kScale) return node.parameter(0);
  return std::min({node.parameter(0), node.parameter(1), node.parameter(2)});
}

/// The next operand taken into those so far; contract: `node` may have several.
Trace folded(const Node& node, const Trace& so_far, const Trace& next) {
  const double k = node.parameter(0);
  switch (node.kind()) {
    case NodeKind::kIntersection: return -smooth_minimum(-so_far, -next, k);
    case NodeKind::kDifference: return -smooth_minimum(-so_far, next, k);
    case NodeKind::kMetaballs: return exponential_minimum(so_far, next, k);
    default: return smooth_minimum(so_far, next, k);
  }
}

/// What an operator over one shape makes of it, all but displacement.
Trace from_child(const Node& node, const PointTrace& p, const Trace& child) {
  switch (node.kind()) {
    case NodeKind::kComplement: return -child;
    case NodeKind::kRound: return child - node.parameter(0);
    case NodeKind::kShell: return abs(child) - node.parameter(0);
    case NodeKind::kScale:
    case NodeKind::kStretch: return scaled(child, scale_of(node), node.has_solid());
    case NodeKind::kExtrude: return box_trace(std::array{child, abs(p[2]) - node.parameter(0)});
    case NodeKind::kTwist:
    case NodeKind::kBend: return max(child, wall_trace(node, p));
    default: return child;
  }
}

/// Calls visit(number) with all that a trace says.
template <class Visit>
void each_number(const Trace& a, const Visit& visit) {
  for (const Interval* part : {&a.over, &a.first, &a.last, &a.rise}) {
    visit(part->lo());
    visit(part->hi());
  }
}

}  // namespace

std::size_t FieldTracer::PlaceHash::operator()(const Place& place) const {
  std::size_t hash = std::hash<const Node*>{}(place.node);
  for (const Trace& trace : place.p) {
    each_number(trace, [&hash](double number) {
      const auto word = std::bit_cast<std::uint64_t>(number + 0.0);  // zeros of both signs are equal
      hash = (hash ^ word ^ (word >> 29U)) * 0x9e3779b97f4a7c15ULL;
    });
  }
  return hash ^ (hash >> 32U);
}

FieldTracer::FieldTracer(NodePtr root, Poll poll)
    : root_(std::move(root)), poll_(std::move(poll)), shared_(shared_nodes(*root_)) {}

Trace FieldTracer::along(const PointTrace& p) {
  known_.clear();
  stack_.clear();
  push(*root_, p);
  while (true) {
    count_work(1);
    if (descend()) continue;
    const Trace trace = finish(stack_.back());
    stack_.pop_back();
    if (stack_.empty()) return trace;
    absorb(stack_.back(), trace);
  }
}

void FieldTracer::push(const Node& node, const PointTrace& p) {
  stack_.push_back({&node, p});
  if (node.kind() == NodeKind::kRepeat) stack_.back().repeat = std::make_unique<CopyVisits>(Copies(node, p));
}

/// Makes the next visit of the node on top of the stack; false when it has made them all.
bool FieldTracer::descend() {
  Frame& parent = stack_.back();
  const std::span<const NodePtr> shapes = operand_shapes(*parent.node);
  const std::size_t visits = parent.repeat ? parent.repeat->copies.size() : shapes.size();
  if (parent.visits == visits) return false;
  const Node& child = *shapes[parent.repeat ? 0 : parent.visits];
  const PointTrace p = parent.repeat ? parent.repeat->copies.point(parent.visits) : child_trace(*parent.node, parent.p);
  ++parent.visits;
  if (shared_.contains(&child)) {
    if (const auto known = known_.find({&child, p}); known != known_.end()) {
      absorb(parent, known->second);
      return true;
    }
  }
  push(child, p);
  return true;
}

/// Folds what the latest visit returned into `parent`.
void FieldTracer::absorb(Frame& parent, const Trace& child) {
  if (parent.repeat) {
    parent.repeat->traces.push_back(child);
  } else if (operand_shapes(*parent.node).size() == 1) {
    parent.trace = from_child(*parent.node, parent.p, child);
  } else {
    parent.trace = parent.visits == 1 ? child : folded(*parent.node, parent.trace, child);
  }
}

/// The trace of a node that has made its visits, or of a primitive.
Trace FieldTracer::finish(Frame& frame) {
  const Node& node = *frame.node;
  if (frame.visits == 0) frame.trace = primitive(node, frame.p);
  if (frame.repeat) frame.trace = frame.repeat->copies.nearest(frame.repeat->traces);
  if (node.kind() == NodeKind::kDisplace) frame.trace = frame.trace + expression_along(node.child(1), frame.p);
  if (shared_.contains(&node)) known_.emplace(Place{&node, frame.p}, frame.trace);
  return frame.trace;
}

Trace FieldTracer::primitive(const Node& node, const PointTrace& p) {
  if (node.kind() == NodeKind::kField) return field(node, p);
  if (node.kind() == NodeKind::kSolid) return solid(expression_along(node.child(0), p));
  return primitive_trace(node, p);
}

/// The expression at the nearest point of the box, cut to the box on those axes that have bounds.
Trace FieldTracer::field(const Node& node, const PointTrace& p) {
  PointTrace held = p;
  std::vector<Trace> excess;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double lo = node.parameter(1 + axis);
    const double hi = node.parameter(4 + axis);
    if (lo != -kInfinity) held[axis] = max(held[axis], lo);
    if (hi != kInfinity) held[axis] = min(held[axis], hi);
    if (lo == -kInfinity && hi == kInfinity) continue;
    const Trace below = constant(lo) - p[axis];
    const Trace above = p[axis] - hi;
    excess.push_back(lo == -kInfinity ? above : hi == kInfinity ? below : max(below, above));
  }
  const Trace& own = expression_along(node.child(0), held);
  if (excess.empty()) return own;
  return max(own, box_trace(excess) * std::max(node.parameter(0), 1.0));
}

const Trace& FieldTracer::expression_along(const Node& root, const PointTrace& p) {
  TracedExpression& expression = expressions_.try_emplace(&root, root).first->second;
  count_work(expression.size());
  return expression.along(p);
}

void FieldTracer::count_work(std::size_t amount) {
  work_done_ += amount;
  if (work_done_ < kWorkPerPoll) return;
  work_done_ = 0;
  if (poll_) poll_();
}

}  // namespace octomarch::reference
