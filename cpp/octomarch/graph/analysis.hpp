// What is known of each node's field before it is lowered: Lipschitz bound, where its solid can be, its mirror
// symmetries. The lowering asks for symmetries, Program keeps the root's bounds.
#pragma once

#include <optional>
#include <unordered_map>

#include "octomarch/base/types.hpp"
#include "octomarch/graph/node.hpp"

namespace octomarch {

/// A box that holds the sub-level set {field ≤ c} for every c ≥ 0 when grown by c·growth on each side. At c = 0 an
/// axis may have lo > hi: empty there, yet a smooth union with a neighbour can still bring points back.
struct LevelBox {
  Vec3 lo{-kInfinity, -kInfinity, -kInfinity};
  Vec3 hi{kInfinity, kInfinity, kInfinity};
  Vec3 growth{1.0, 1.0, 1.0};
};

/// Bits of FieldFacts::symmetry: unchanged by mirroring x, y, z through the origin; by any rotation about it.
inline constexpr unsigned kMirrorX = 1U;
inline constexpr unsigned kMirrorAll = 7U;
inline constexpr unsigned kIsotropic = 8U;

struct FieldFacts {
  double lipschitz = 1.0;
  LevelBox level;                 ///< in the node's own coordinates
  std::optional<LevelBox> focus;  ///< the same of the bounded operands only; nothing when all are unbounded
  unsigned symmetry = 0;
};

/// Facts of a root, of what its repeats copy, and of every shape below it that has several owners. O(nodes + children),
/// constant stack.
using FactTable = std::unordered_map<const Node*, FieldFacts>;
FactTable analyse(const Node& root);

/// Is every row of the rotation a coordinate axis, up to sign? Then boxes, axes and repeats stay what they are.
bool is_signed_permutation(const Mat3& rotation);

}  // namespace octomarch
