// The field of a node graph, one point at a time: value, gradient and material by walking the nodes themselves. The
// node graph comes before it; the reference's marcher and shading come after. Slow, plain, and the truth for tests.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "octomarch/graph/node.hpp"
#include "octomarch/reference/materials.hpp"
#include "octomarch/reference/poll.hpp"
#include "octomarch/reference/primitives.hpp"

namespace octomarch::reference {

/// What a node says about one point. The gradient is zero unless asked for; the material is that of the primitive
/// that gave the value, as an index, or kUnpainted while no paint has been met.
template <class T>
struct Sample {
  T value = T(0);
  Vector<T> gradient = Vector<T>(0);
  int material = 0;
};

/// Evaluates one graph at points in float or double. Constant stack whatever the depth of the graph. A sub-shape that is
/// used several times is evaluated once per distinct point, so graphs that share much cost what they hold, not what they
/// unfold to. Not for use by several threads at once.
template <class T>
class Evaluator {
 public:
  /// Contract: `root` is not null.
  Evaluator(NodePtr root, Poll poll);

  /// NaN at points that have a NaN.
  T distance(const Vector<T>& p);
  /// Analytic; on ties (equal operands, faces of boxes) that of a side which has a gradient.
  Vector<T> gradient(const Vector<T>& p) { return walk(p, true).gradient; }
  /// Index into materials() of the primitive that gives the value at p.
  int material(const Vector<T>& p);

  const std::vector<Material>& materials() const { return table_.materials; }

 private:
  /// A node on the way down: where it is evaluated, how many visits it has made, and their fold so far.
  struct Frame {
    const Node* node;
    Vector<T> p;
    std::size_t visits = 0;
    Sample<T> sample = {};
  };
  struct Place {
    const Node* node;
    std::array<std::uint64_t, 3> bits;
    friend bool operator==(const Place&, const Place&) = default;
  };
  struct PlaceHash {
    std::size_t operator()(const Place& place) const;
  };

  static Place place_of(const Frame& frame);
  Sample<T> walk(const Vector<T>& p, bool with_gradient);
  bool descend();
  void absorb(Frame& parent, const Sample<T>& child) const;
  Sample<T> finish(const Frame& frame, bool with_gradient);

  NodePtr root_;
  Poll poll_;
  MaterialTable table_;
  std::unordered_set<const Node*> shared_;  // combinations and transforms that have several parents
  std::unordered_map<Place, Sample<T>, PlaceHash> known_;
  std::vector<Frame> stack_;
  std::uint64_t visits_ = 0;
};

extern template class Evaluator<float>;
extern template class Evaluator<double>;

}  // namespace octomarch::reference
