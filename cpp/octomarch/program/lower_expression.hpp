// From expression nodes to data flow, at given coordinates. Lowering of shapes and of skies comes to it for numbers.
#pragma once

#include <array>
#include <map>
#include <unordered_map>

#include "octomarch/graph/node.hpp"
#include "octomarch/program/dataflow.hpp"

namespace octomarch {

/// Values of an expression's coordinates: x, y, z, and the normal's components (kNoNormal where there is none).
using Coordinates = std::array<ValueId, 6>;
inline constexpr ValueId kNoNormal = UINT32_MAX;

/// Remembers what it has lowered, so that what expressions share is computed once.
class ExpressionLowering {
 public:
  /// O(nodes) expected, constant stack.
  ValueId lower(const Node& expression, const Coordinates& coordinates, DataFlow& flow);

 private:
  using Values = std::unordered_map<const Node*, ValueId>;
  std::map<Coordinates, Values> values_;
};

}  // namespace octomarch
