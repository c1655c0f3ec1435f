// Lowering: from the node graph to data flow. Transforms do not become instructions where they can be folded into a
// primitive's constants; a shape used twice in one place is computed once. After it comes the allocator.
#pragma once

#include "octomarch/graph/analysis.hpp"
#include "octomarch/program/dataflow.hpp"
#include "octomarch/program/program.hpp"

namespace octomarch {

struct Lowered {
  DataFlow flow;
  ValueId distance = 0;
  ValueId object = 0;                             ///< value that holds the object id; attributes only
  std::vector<Object> objects;                    ///< attributes only
  std::vector<Material> materials;                ///< attributes only
  std::array<ValueId, Material::kSlots> slots{};  ///< what the surface is made of; surface only
};

enum class LoweringOf : std::uint8_t { kDistance, kAttributes, kSurface };

/// O(n) expected in the distinct (node, placement) pairs, constant stack. `facts`: of every node below `root`. `anchor`: where
/// the coordinates x, y, z are counted from.
Lowered lower(const Node& root, const FactTable& facts, LoweringOf what, const Vec3& anchor);

}  // namespace octomarch
