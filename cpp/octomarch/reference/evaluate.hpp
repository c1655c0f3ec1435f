// The field of a node graph, one point at a time: value, gradient and material by walking the nodes themselves. Samples,
// primitives and operators over points come before it; the reference's marcher and shading come after. Slow, plain, and
// the truth for tests.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "octomarch/graph/node.hpp"
#include "octomarch/reference/domain.hpp"
#include "octomarch/reference/expression.hpp"
#include "octomarch/reference/materials.hpp"
#include "octomarch/reference/poll.hpp"
#include "octomarch/reference/sample.hpp"

namespace octomarch::reference {

/// Evaluates one graph at points in float or double. Constant stack whatever the depth of the graph. A sub-shape that is
/// used several times is evaluated once per distinct point, so graphs that share much cost what they hold, not what they
/// unfold to. Not for use by several threads at once.
template <class T>
class Evaluator {
 public:
  /// Contract: `root` is not null. Points count from `anchor`.
  Evaluator(NodePtr root, Poll poll, const Vec3& anchor);

  /// NaN at points that have a NaN.
  T distance(const Vector<T>& p);
  /// Analytic; on ties (equal operands, faces of boxes) that of a side which has a gradient.
  Vector<T> gradient(const Vector<T>& p) { return walk(p, Ask::kGradient).gradient; }
  /// Index into materials() of the primitive that gives the value at p.
  int material(const Vector<T>& p);
  /// What the surface is made of at p, where its unit normal is `normal`: blended as materials() are not, never clamped.
  Slots<T> slots(const Vector<T>& p, const Vector<T>& normal);

  const std::vector<Material>& materials() const { return table_.materials; }
  /// Has some part no distances (kSolid)?
  bool is_solid() const { return is_solid_; }

 private:
  enum class Ask : std::uint8_t { kDistance, kGradient, kSlots };

  /// A node on the way down: where it is evaluated, how many visits it has made, and their fold so far.
  struct Frame {
    const Node* node;
    Spot<T> at;
    Vector<T> normal = Vector<T>(0);  // for kSlots
    std::size_t visits = 0;
    Sample<T> sample = {};
  };
  struct Place {
    const Node* node;
    std::array<std::uint64_t, 9> bits;
    friend bool operator==(const Place&, const Place&) = default;
  };
  struct PlaceHash {
    std::size_t operator()(const Place& place) const;
  };

  static Place place_of(const Frame& frame);
  Sample<T> walk(const Vector<T>& p, Ask ask, const Vector<T>& normal = Vector<T>(0));
  bool descend(Ask ask);
  void absorb(Frame& parent, const Sample<T>& child) const;
  Sample<T> finish(Frame& frame, Ask ask);
  Sample<T> primitive(const Frame& frame, Ask ask);
  void paint(Frame& frame, std::span<const NodePtr> slots);
  Expression<T>& ready(const Node& expression);
  void count_work(std::size_t amount);

  NodePtr root_;
  Poll poll_;
  Vec3 anchor_;
  bool is_solid_;
  MaterialTable table_;
  std::unordered_set<const Node*> shared_;  // what has several parents and is worth remembering
  std::unordered_map<Place, Sample<T>, PlaceHash> known_;
  std::unordered_map<const Node*, Expression<T>> expressions_;
  std::vector<Frame> stack_;
  std::uint64_t work_done_ = 0;
};

extern template class Evaluator<float>;
extern template class Evaluator<double>;

}  // namespace octomarch::reference
