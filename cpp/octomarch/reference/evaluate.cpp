// The walk over the node graph: frames go down with points, samples come up with values. See evaluate.hpp.
#include "octomarch/reference/evaluate.hpp"

#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

namespace octomarch::reference {
namespace {

constexpr int kUnpainted = -1;
constexpr std::uint64_t kVisitsPerPoll = 1U << 18U;  // some ten milliseconds

/// Combinations and transforms that are reached from more than one place, so worth remembering.
std::unordered_set<const Node*> shared_nodes(const Node& root) {
  std::unordered_set<const Node*> seen;
  std::unordered_set<const Node*> shared;
  std::vector<const Node*> work{&root};
  while (!work.empty()) {
    const Node* const node = work.back();
    work.pop_back();
    for (const NodePtr& child : node->children()) {
      if (child->children().empty()) continue;
      if (seen.insert(child.get()).second) {
        work.push_back(child.get());
      } else {
        shared.insert(child.get());
      }
    }
  }
  return shared;
}

template <class T>
Sample<T> negated(const Sample<T>& a) {
  return {-a.value, -a.gradient, a.material};
}

/// min(a, b) − max(k − |a − b|, 0)²/(4k), its gradient, and the material of the smaller. Of equal operands the second
/// counts, unless only the first has a gradient.
template <class T>
Sample<T> minimum(const Sample<T>& a, const Sample<T>& b, T k) {
  const bool a_smaller = a.value < b.value;
  const bool tie_to_a = a.value == b.value && b.gradient == Vector<T>(0);
  Sample<T> result{a_smaller ? a.value : b.value, a_smaller || tie_to_a ? a.gradient : b.gradient,
                   a_smaller ? a.material : b.material};
  const T overlap = k - std::abs(a.value - b.value);
  if (overlap > T(0)) {
    result.value -= overlap / (T(4) * k) * overlap;
    const T share = overlap / (T(2) * k);  // of the larger operand
    result.gradient = a_smaller ? glm::mix(a.gradient, b.gradient, share) : glm::mix(b.gradient, a.gradient, share);
  }
  return result;
}

/// The rotation of a kRotate node, parent from child.
template <class T>
glm::mat<3, 3, T> rotation(const Node& node) {
  glm::mat<3, 3, T> parent_from_child;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      parent_from_child[column][row] = T(node.parameter(static_cast<std::size_t>(3 * row + column)));
    }
  }
  return parent_from_child;
}

/// Copies of a kRepeat's child that are looked at: the nearest cell and its neighbours on the side of p, per axis.
std::size_t copies(const Node& repeat) {
  std::size_t count = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) count *= repeat.parameter(axis) > 0.0 ? 2 : 1;
  return count;
}

/// Centre of the copy number `copy`: of its bits, one per repeated axis, those that are set choose the neighbour. The
/// nearest copy of a shape that fills more than half its cell on one side can be the neighbour's.
template <class T>
Vector<T> copy_centre(const Node& repeat, const Vector<T>& p, std::size_t copy) {
  Vector<T> centre(0);
  for (int axis = 0; axis < 3; ++axis) {
    const RepeatAxis constants = repeat_axis(repeat, static_cast<std::size_t>(axis));
    if (constants.period == 0.0) continue;
    const T period = T(constants.period);
    const T shift = T(constants.shift);
    const T limit = T(constants.limit);
    T cell = glm::clamp(std::floor(p[axis] / period + shift) + T(0.5) - shift, -limit, limit);
    if ((copy & 1U) != 0) {
      const T side = p[axis] - cell * period < T(0) ? T(-1) : T(1);
      cell = glm::clamp(cell + side, -limit, limit);
    }
    centre[axis] = cell * period;
    copy >>= 1U;
  }
  return centre;
}

std::size_t visit_count(const Node& node) {
  return node.kind() == NodeKind::kRepeat ? copies(node) : node.children().size();
}

/// Where visit number `visit` of `node` evaluates its child.
template <class T>
Vector<T> child_point(const Node& node, const Vector<T>& p, std::size_t visit) {
  switch (node.kind()) {
    case NodeKind::kTranslate: return p - vector_parameter<T>(node, 0);
    case NodeKind::kRotate: return glm::transpose(rotation<T>(node)) * p;
    case NodeKind::kScale: return p / T(node.parameter(0));
    case NodeKind::kRepeat: return p - copy_centre(node, p, visit);
    default: return p;
  }
}

}  // namespace

template <class T>
Evaluator<T>::Evaluator(NodePtr root, Poll poll)
    : root_(std::move(root)),
      poll_(std::move(poll)),
      table_(collect_materials(*root_)),
      shared_(shared_nodes(*root_)) {}

template <class T>
T Evaluator<T>::distance(const Vector<T>& p) {
  // Comparisons drop a NaN operand, so it has to be looked for.
  if (std::isnan(p.x) || std::isnan(p.y) || std::isnan(p.z)) return std::numeric_limits<T>::quiet_NaN();
  return walk(p, false).value;
}

template <class T>
int Evaluator<T>::material(const Vector<T>& p) {
  const int index = walk(p, false).material;
  return index == kUnpainted ? table_.index_of_unpainted : index;
}

template <class T>
std::size_t Evaluator<T>::PlaceHash::operator()(const Place& place) const {
  std::size_t hash = std::hash<const Node*>{}(place.node);
  for (const std::uint64_t word : place.bits) hash = (hash ^ word ^ (word >> 29U)) * 0x9e3779b97f4a7c15ULL;
  return hash ^ (hash >> 32U);
}

template <class T>
typename Evaluator<T>::Place Evaluator<T>::place_of(const Frame& frame) {
  const auto bits = [](T x) { return std::bit_cast<std::uint64_t>(static_cast<double>(x)); };
  return {frame.node, {bits(frame.p.x), bits(frame.p.y), bits(frame.p.z)}};
}

template <class T>
Sample<T> Evaluator<T>::walk(const Vector<T>& p, bool with_gradient) {
  known_.clear();
  stack_.assign(1, Frame{root_.get(), p});
  while (true) {
    if (poll_ && ++visits_ % kVisitsPerPoll == 0) poll_();
    if (descend()) continue;
    const Sample<T> sample = finish(stack_.back(), with_gradient);
    stack_.pop_back();
    if (stack_.empty()) return sample;
    absorb(stack_.back(), sample);
  }
}

/// Makes the next visit of the node on top of the stack; false when it has made them all.
template <class T>
bool Evaluator<T>::descend() {
  Frame& parent = stack_.back();
  if (parent.visits == visit_count(*parent.node)) return false;
  const std::span<const NodePtr> children = parent.node->children();
  const NodePtr& child = parent.node->kind() == NodeKind::kRepeat ? children[0] : children[parent.visits];
  const Frame frame{child.get(), child_point(*parent.node, parent.p, parent.visits)};
  ++parent.visits;
  if (shared_.contains(frame.node)) {
    if (const auto known = known_.find(place_of(frame)); known != known_.end()) {
      absorb(parent, known->second);
      return true;
    }
  }
  stack_.push_back(frame);
  return true;
}

/// Folds what the latest visit returned into `parent`, in the frame of parent's point.
template <class T>
void Evaluator<T>::absorb(Frame& parent, const Sample<T>& child) const {
  const Node& node = *parent.node;
  Sample<T>& sample = parent.sample;
  const bool first = parent.visits == 1;
  switch (node.kind()) {
    case NodeKind::kUnion: sample = first ? child : minimum(sample, child, T(node.parameter(0))); break;
    case NodeKind::kIntersection:
      sample = first ? child : negated(minimum(negated(sample), negated(child), T(node.parameter(0))));
      break;
    case NodeKind::kDifference:
      sample = first ? child : negated(minimum(negated(sample), child, T(node.parameter(0))));
      break;
    case NodeKind::kRepeat: sample = first ? child : minimum(sample, child, T(0)); break;
    case NodeKind::kComplement: sample = negated(child); break;
    case NodeKind::kRotate: sample = {child.value, rotation<T>(node) * child.gradient, child.material}; break;
    case NodeKind::kScale: sample = {child.value * T(node.parameter(0)), child.gradient, child.material}; break;
    case NodeKind::kPaint:
      sample = child;
      if (child.material == kUnpainted) sample.material = table_.index_of_paint.at(&node);
      break;
    default: sample = child;
  }
}

/// The sample of a node that has made its visits, or of a primitive.
template <class T>
Sample<T> Evaluator<T>::finish(const Frame& frame, bool with_gradient) {
  if (frame.node->children().empty()) {
    const Vector<T> gradient = with_gradient ? primitive_gradient(*frame.node, frame.p) : Vector<T>(0);
    return {primitive_distance(*frame.node, frame.p), gradient, kUnpainted};
  }
  if (shared_.contains(frame.node)) known_.emplace(place_of(frame), frame.sample);
  return frame.sample;
}

template class Evaluator<float>;
template class Evaluator<double>;

}  // namespace octomarch::reference
