// A tree of balls as kernels walk it. ball_tree.hpp makes them.
#pragma once

#include <cstddef>
#include <cstdint>

namespace octomarch {

/// Nodes are in depth-first order: an inner one's first child comes right behind it.
template <class Real>
struct BallNode {
  Real center[3];
  Real radius;          ///< about all of its balls
  std::uint32_t other;  ///< an inner node's second child; a leaf's number
  bool is_leaf;
};

inline constexpr std::size_t kBallsOfLeaf = 16;

/// The balls of a leaf, a row of each number. Places that are left have a radius of −∞.
template <class Real>
struct BallLeaf {
  alignas(64) Real x[kBallsOfLeaf];
  alignas(64) Real y[kBallsOfLeaf];
  alignas(64) Real z[kBallsOfLeaf];
  alignas(64) Real radius[kBallsOfLeaf];
};

/// The deepest tree: parts are halved, and there are less than 2³² balls.
inline constexpr int kDeepestBallTree = 32;

}  // namespace octomarch
