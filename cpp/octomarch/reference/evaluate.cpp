// The walk over the node graph: frames go down with points, samples come up with values. See evaluate.hpp.
#include "octomarch/reference/evaluate.hpp"

#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "octomarch/reference/domain.hpp"
#include "octomarch/reference/operands.hpp"
#include "octomarch/reference/operators.hpp"
#include "octomarch/reference/own_field.hpp"
#include "octomarch/reference/primitives.hpp"

namespace octomarch::reference {
namespace {

constexpr std::uint64_t kWorkPerPoll = 1U << 18U;  // some ten milliseconds

std::size_t visit_count(const Node& node) {
  return node.kind() == NodeKind::kRepeat ? copies(node) : operand_shapes(node).size();
}

}  // namespace

template <class T>
Evaluator<T>::Evaluator(NodePtr root, Poll poll, const Vec3& anchor)
    : root_(std::move(root)),
      poll_(std::move(poll)),
      anchor_(anchor),
      is_solid_(root_->has_solid()),
      table_(collect_materials(*root_)),
      shared_(shared_nodes(*root_)) {}

template <class T>
T Evaluator<T>::distance(const Vector<T>& p) {
  // Comparisons drop a NaN operand, so it has to be looked for.
  if (std::isnan(p.x) || std::isnan(p.y) || std::isnan(p.z)) return std::numeric_limits<T>::quiet_NaN();
  return walk(p, Ask::kDistance).value;
}

template <class T>
int Evaluator<T>::material(const Vector<T>& p) {
  const int index = walk(p, Ask::kDistance).material;
  return index == kUnpainted ? table_.index_of_unpainted : index;
}

template <class T>
Slots<T> Evaluator<T>::slots(const Vector<T>& p, const Vector<T>& normal) {
  Frame whole{root_.get(), {p, anchor_}, normal};
  whole.sample = walk(p, Ask::kSlots, normal);
  paint(whole, default_material().slots);
  return whole.sample.painted;
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
  const auto& [p, shift] = frame.at;
  return {
      frame.node,
      {bits(p.x), bits(p.y), bits(p.z), std::bit_cast<std::uint64_t>(shift.x), std::bit_cast<std::uint64_t>(shift.y),
       std::bit_cast<std::uint64_t>(shift.z), bits(frame.normal.x), bits(frame.normal.y), bits(frame.normal.z)}};
}

template <class T>
Sample<T> Evaluator<T>::walk(const Vector<T>& p, Ask ask, const Vector<T>& normal) {
  known_.clear();
  stack_.assign(1, Frame{root_.get(), {p, anchor_}, normal});
  while (true) {
    count_work(1);
    if (descend(ask)) continue;
    const Sample<T> sample = finish(stack_.back(), ask);
    stack_.pop_back();
    if (stack_.empty()) return sample;
    absorb(stack_.back(), sample);
  }
}

/// Makes the next visit of the node on top of the stack; false when it has made them all.
template <class T>
bool Evaluator<T>::descend(Ask ask) {
  Frame& parent = stack_.back();
  if (parent.visits == visit_count(*parent.node)) return false;
  const std::span<const NodePtr> children = parent.node->children();
  const NodePtr& child = parent.node->kind() == NodeKind::kRepeat ? children[0] : children[parent.visits];
  Frame frame{child.get(), child_spot(*parent.node, parent.at, parent.visits)};
  if (ask == Ask::kSlots) frame.normal = child_normal(*parent.node, parent.at.point(), parent.normal);
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
  const Sample<T> here =
      operand_shapes(*parent.node).size() == 1 ? from_child(*parent.node, parent.at.point(), child) : child;
  parent.sample = parent.visits == 1 ? here : folded(*parent.node, parent.sample, here);
}

/// The sample of a node that has made its visits, or of a primitive.
template <class T>
Sample<T> Evaluator<T>::finish(Frame& frame, Ask ask) {
  const Node& node = *frame.node;
  if (frame.visits == 0) frame.sample = primitive(frame, ask);
  if (node.kind() == NodeKind::kDisplace) {
    const Jet<T> displacement = ready(node.child(1)).at(frame.at.point());
    frame.sample.value += displacement.value;
    frame.sample.gradient += displacement.gradient;
  }
  if (node.kind() == NodeKind::kPaint) {
    if (ask == Ask::kSlots) paint(frame, node.children().subspan(1));
    if (frame.sample.material == kUnpainted) frame.sample.material = table_.index_of_paint.at(&node);
  }
  if (shared_.contains(frame.node)) known_.emplace(place_of(frame), frame.sample);
  return frame.sample;
}

template <class T>
Sample<T> Evaluator<T>::primitive(const Frame& frame, Ask ask) {
  const Node& node = *frame.node;
  const Vector<T> p = frame.at.from(origin_of(node));
  if (node.kind() == NodeKind::kField) return field_sample(node, ready(node.child(0)), p);
  if (node.kind() == NodeKind::kSolid) return solid_sample(ready(node.child(0)), p);
  const Vector<T> gradient = ask == Ask::kGradient ? primitive_gradient(node, p) : Vector<T>(0);
  return {primitive_distance(node, p), gradient};
}

/// Gives what is unpainted in the frame's sample the slots at its point.
template <class T>
void Evaluator<T>::paint(Frame& frame, std::span<const NodePtr> slots) {
  Sample<T>& sample = frame.sample;
  if (sample.unpainted == T(0)) return;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const T value = ready(*slots[i]).at(frame.at.point(), frame.normal).value;
    sample.painted[i] = sample.unpainted == T(1) ? value : sample.painted[i] + sample.unpainted * value;
  }
  sample.unpainted = T(0);
}

template <class T>
Expression<T>& Evaluator<T>::ready(const Node& expression) {
  Expression<T>& result = expressions_.try_emplace(&expression, expression).first->second;
  count_work(result.size());
  return result;
}

template <class T>
void Evaluator<T>::count_work(std::size_t amount) {
  work_done_ += amount;
  if (work_done_ < kWorkPerPoll) return;
  work_done_ = 0;
  if (poll_) poll_();
}

template class Evaluator<float>;
template class Evaluator<double>;

}  // namespace octomarch::reference
