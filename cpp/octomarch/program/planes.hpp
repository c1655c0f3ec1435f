// Planes that a shape is united with, such as a floor, apart from all the rest: rays meet them in closed form, and only the
// rest has to be marched, which then often has bounds. Works on the node graph; lowering comes after.
#pragma once

#include <array>
#include <vector>

#include "octomarch/base/types.hpp"
#include "octomarch/graph/node.hpp"

namespace octomarch {

/// Normal, of unit length, and h: the distance is n·p + h.
using Plane = std::array<double, 4>;

/// The shape's field is the least of the planes' and the rest's.
struct Separated {
  std::vector<Plane> planes;
  NodePtr rest;  ///< without its paints; null where nothing is left
};

/// Takes the planes out of unions that do not blend, under transforms and paints too, but not where the graph is deeper than a
/// scene that somebody wrote. The planes are counted from `anchor`, the rest is not moved. O(nodes above them).
Separated separate_planes(const NodePtr& root, const Vec3& anchor);

}  // namespace octomarch
