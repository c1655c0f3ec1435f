// Programs of shapes without number, for tests of chains.
#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "parts.hpp"

#include "octomarch/graph/builder.hpp"
#include "octomarch/program/program.hpp"

namespace octomarch {

/// Shapes all over a cube, one in each unit of volume.
inline std::shared_ptr<const Program> cloud(int count, const std::function<NodePtr(Random&)>& make,
                                            double smooth = 0.1) {
  Random random(31);  // NOLINT(bugprone-random-generator-seed): the same numbers each time
  const double half = 0.5 * std::cbrt(count);
  std::vector<NodePtr> shapes;
  for (int i = 0; i < count; ++i) {
    const double x = uniform(random, -half, half);
    const double y = uniform(random, -half, half);
    shapes.push_back(translate(make(random), {x, y, uniform(random, -half, half)}));
  }
  return compile(combine(NodeKind::kUnion, std::move(shapes), smooth));
}

inline NodePtr ball(Random& random) { return sphere(uniform(random, 0.1, 0.3)); }

inline std::shared_ptr<const Program> cloud(int count) { return cloud(count, ball); }

}  // namespace octomarch
