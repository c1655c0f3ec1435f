// Interning of nodes: one table of weak entries, so that equal sub-shapes are one object and die with their last user.
// Builders (builder.cpp) come before it; everything that walks the graph relies on its guarantee of identity.
#include "octomarch/graph/node.hpp"

#include <algorithm>
#include <bit>
#include <iterator>
#include <mutex>
#include <unordered_set>
#include <utility>

#include "octomarch/base/hash_table.hpp"

namespace octomarch {
namespace {

/// One round of the 64-bit finaliser of MurmurHash3 (A. Appleby, public domain), mixing `word` into `seed`.
std::uint64_t mix(std::uint64_t seed, std::uint64_t word) {
  std::uint64_t h = seed ^ (word + 0x9e3779b97f4a7c15ULL + (seed << 6U) + (seed >> 2U));
  h = (h ^ (h >> 33U)) * 0xff51afd7ed558ccdULL;
  h = (h ^ (h >> 33U)) * 0xc4ceb9fe1a85ec53ULL;
  return h ^ (h >> 33U);
}

std::uint64_t hash(NodeKind kind, std::span<const double> parameters, std::span<const NodePtr> children,
                   std::span<const float> texels) {
  std::uint64_t h = mix(0, static_cast<std::uint64_t>(kind));
  for (const double parameter : parameters) h = mix(h, std::bit_cast<std::uint64_t>(parameter));
  for (const NodePtr& child : children) h = mix(h, reinterpret_cast<std::uintptr_t>(child.get()));
  for (std::size_t i = 0; i < texels.size(); i += 2) {  // two at a time: there may be millions
    const std::uint64_t second = i + 1 < texels.size() ? std::bit_cast<std::uint32_t>(texels[i + 1]) : 0;
    h = mix(h, second << 32U | std::bit_cast<std::uint32_t>(texels[i]));
  }
  return h;
}

bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }
bool same_bits(float a, float b) { return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b); }

/// Does a shape of this kind look the same at every z, if what it is made of does?
bool stays_flat(NodeKind kind, std::span<const double> p) {
  switch (kind) {
    case NodeKind::kRectangle:
    case NodeKind::kPolygon:
    case NodeKind::kField:
    case NodeKind::kSolid:
    case NodeKind::kUnion:
    case NodeKind::kIntersection:
    case NodeKind::kDifference:
    case NodeKind::kMetaballs:
    case NodeKind::kComplement:
    case NodeKind::kRound:
    case NodeKind::kShell:
    case NodeKind::kDisplace:
    case NodeKind::kScale:
    case NodeKind::kPaint:
    case NodeKind::kTranslate:
    case NodeKind::kStretch:
    case NodeKind::kMirror: return true;
    case NodeKind::kCylinder: return p[1] == 2.0;
    case NodeKind::kRotate: return p[8] == 1.0;
    case NodeKind::kPlane:
    case NodeKind::kRepeat:
    case NodeKind::kElongate: return p[2] == 0.0;
    default: return false;
  }
}

}  // namespace

/// The table of living nodes.
class Interner {
 public:
  /// Never destroyed: nodes held by static objects may outlive any static table.
  static Interner& instance() {
    static Interner& interner = *new Interner;
    return interner;
  }

  NodePtr intern(NodeKind kind, std::vector<double> parameters, std::vector<NodePtr> children,
                 std::vector<float> texels) {
    const std::uint64_t key = hash(kind, parameters, children, texels);
    {
      const std::lock_guard lock(mutex_);
      if (NodePtr existing = find(key, kind, parameters, children, texels)) return existing;
    }
    // Made outside the lock: should anything here throw, the destructor runs, and it takes the lock.
    const auto fresh = std::make_shared<Node>(key, kind, std::move(parameters), std::move(children), std::move(texels));
    const std::lock_guard lock(mutex_);
    if (NodePtr existing = find(key, kind, fresh->parameters(), fresh->children(), fresh->texels())) {
      return existing;
    }
    table_.insert(key, fresh.get());
    return fresh;
  }

  void forget(const Node* node) {
    const std::lock_guard lock(mutex_);
    table_.erase(node->hash_, [node](const Node* other) { return other == node; });
  }

 private:
  /// Contract: the lock is held. A node stays readable while it is in the table, even when its last owner is gone and
  /// its destructor waits for the lock; then it cannot be revived and a new node takes its place beside it.
  NodePtr find(std::uint64_t key, NodeKind kind, std::span<const double> parameters, std::span<const NodePtr> children,
               std::span<const float> texels) const {
    NodePtr alive;
    table_.find(key, [&](Node* node) {
      if (node->kind() != kind ||
          !std::ranges::equal(node->parameters(), parameters, [](double a, double b) { return same_bits(a, b); }) ||
          !std::ranges::equal(node->children(), children) ||
          !std::ranges::equal(node->texels(), texels, [](float a, float b) { return same_bits(a, b); })) {
        return false;
      }
      alive = node->weak_from_this().lock();
      return alive != nullptr;
    });
    return alive;
  }

  std::mutex mutex_;
  /// Not of const nodes: their weak_from_this() converts, and owns the node meanwhile, perhaps as the last.
  HashTable<Node*> table_;
};

Node::Node(std::uint64_t hash, NodeKind kind, std::vector<double> parameters, std::vector<NodePtr> children,
           std::vector<float> texels)
    : hash_(hash),
      kind_(kind),
      parameters_(std::move(parameters)),
      children_(std::move(children)),
      texels_(std::move(texels)) {
  const auto any = [this](const auto& is_so) {
    return std::ranges::any_of(children_, [&](const NodePtr& child) { return is_so(*child); });
  };
  const double coordinate = kind == NodeKind::kCoordinate ? parameters_[0] : 0.0;
  uses_z_ = coordinate == 2.0 || any([](const Node& child) { return child.uses_z_; });
  uses_normal_ = coordinate >= 3.0 || any([](const Node& child) { return child.uses_normal_; });
  has_solid_ = kind == NodeKind::kSolid || any([](const Node& child) { return child.has_solid_; });
  const bool is_painted = kind == NodeKind::kPaint;  // whatever its colours do, the field stays as it is
  is_flat_ = stays_flat(kind, parameters_) && !any([is_painted](const Node& child) {
               return is_shape(child.kind_) ? !child.is_flat_ : child.uses_z_ && !is_painted;
             });
}

/// The outermost destructor on a thread owns the work list; those that come out of dropping children only append to it, so
/// the stack stays flat however deep the graph is.
Node::~Node() {
  thread_local std::vector<NodePtr>* pending = nullptr;
  Interner::instance().forget(this);
  if (children_.empty()) return;
  if (pending != nullptr) {
    std::ranges::move(children_, std::back_inserter(*pending));
    return;
  }
  std::vector<NodePtr> work = std::move(children_);
  pending = &work;
  while (!work.empty()) {
    const NodePtr next = std::move(work.back());
    work.pop_back();
  }
  pending = nullptr;
}

NodePtr intern(NodeKind kind, std::vector<double> parameters, std::vector<NodePtr> children,
               std::vector<float> texels) {
  for (double& parameter : parameters) parameter += 0.0;  // −0 becomes +0
  return Interner::instance().intern(kind, std::move(parameters), std::move(children), std::move(texels));
}

std::size_t count_nodes(const NodePtr& root) {
  if (!root) return 0;
  std::size_t count = 0;
  std::unordered_set<const Node*> seen;
  std::vector<const Node*> work{root.get()};
  while (!work.empty()) {
    const Node* const node = work.back();
    work.pop_back();
    ++count;
    for (const NodePtr& child : node->children()) {
      if (has_one_owner(child) || seen.insert(child.get()).second) work.push_back(child.get());
    }
  }
  return count;
}

double nearest_middle(const RepeatAxis& axis, double middle) {
  constexpr double kMany = 16.0;
  const bool is_endless = axis.period != 0.0 && std::isinf(axis.limit);
  return is_endless && std::fabs(middle) > kMany * axis.period ? std::remainder(middle, axis.period) : middle;
}

RepeatAxis repeat_axis(const Node& repeat, std::size_t axis) {
  const double period = repeat.parameter(axis);
  const double count = repeat.parameter(3 + axis);
  if (count == 0.0) return {period, 0.5, kInfinity};
  const bool even = std::fmod(count, 2.0) == 0.0;
  return {period, even ? 0.0 : 0.5, 0.5 * (count - 1.0)};
}

}  // namespace octomarch
