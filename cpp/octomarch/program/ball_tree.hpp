// Where crowds of shapes may have a surface at all. Rays find the first such place by a square root a shape, where steps would take many
// evaluations. ball_reader.hpp comes before, kernels/balls.hpp after.
#pragma once

#include <cstddef>
#include <mutex>
#include <optional>
#include <type_traits>
#include <vector>

#include "octomarch/program/ball_node.hpp"
#include "octomarch/program/program.hpp"

namespace octomarch {

/// Balls about all places where a field may be at most some epsilon: where it is, the distance to one of them is at most that epsilon,
/// or where that is more than trusted_epsilon(), at most the epsilon and blend().
template <class Real>
class BallTree {
 public:
  /// Of a crowd (ball_reader.hpp) of kFewest shapes at least, of which little is between them and the balls about them, neither of huge
  /// numbers nor of tiny ones alone; else nothing. O(n log n). Cancelled, it returns anything, soon.
  static std::optional<BallTree> of(const Tape& tape, const bool& cancelled);
  static constexpr std::size_t kFewest = 16;

  const std::vector<BallNode<Real>>& nodes() const { return nodes_; }
  const std::vector<BallLeaf<Real>>& leaves() const { return leaves_; }
  Real blend() const { return blend_; }  ///< the largest k of all blends, 0 where balls are united
  Real trusted_epsilon() const { return trusted_epsilon_; }

 private:
  BallTree() = default;

  std::vector<BallNode<Real>> nodes_;
  std::vector<BallLeaf<Real>> leaves_;
  Real blend_ = 0;
  Real trusted_epsilon_ = 0;
};

/// What a program keeps of them.
struct BallTrees {
  template <class Real>
  struct Once {
    std::mutex mutex;
    bool is_made = false;
    std::optional<BallTree<Real>> tree;
  };
  template <class Real>
  Once<Real>& of() {
    if constexpr (std::is_same_v<Real, float>) {
      return f32;
    } else {
      return f64;
    }
  }
  Once<float> f32;
  Once<double> f64;
};

}  // namespace octomarch
