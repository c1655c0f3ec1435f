// What builders ask of arguments. Each throws ArgumentError that names the argument and the value.
#pragma once

#include <cmath>

#include "octomarch/base/error.hpp"
#include "octomarch/graph/node.hpp"
#include "octomarch/graph/schema.hpp"
#include "octomarch/graph/text.hpp"

namespace octomarch {

inline bool is_length(double value) { return std::isfinite(value) && value >= 0.0; }

inline bool is_length(const Vec3& value) { return is_length(value.x) && is_length(value.y) && is_length(value.z); }

inline void require_length(double value, std::string_view argument) {
  require(is_length(value), argument, "finite and >= 0", text(value));
}

inline void require_lengths(const Vec3& value, std::string_view argument) {
  require(is_length(value), argument, "finite and >= 0 on every axis", text(value));
}

inline void require_finite(const Vec3& value, std::string_view argument) {
  require(is_finite(value), argument, "finite", text(value));
}

inline void require_direction(const Vec3& value, std::string_view argument) {
  require(is_finite(value) && value != Vec3{}, argument, "finite and not zero", text(value));
}

inline void require_shape(const NodePtr& shape, std::string_view argument = "shape") {
  require(shape != nullptr && is_shape(shape->kind()), argument, "a shape", shape ? name(shape->kind()) : "none");
}

inline void require_expression(const NodePtr& node, std::string_view argument = "expression") {
  require(node != nullptr && is_expression(node->kind()), argument, "an expression",
          node ? name(node->kind()) : "none");
}

/// Shapes ask what lies at a point before there is a surface: their expressions have no normal to look at.
inline void require_field_expression(const NodePtr& node) {
  require_expression(node);
  require(!node->uses_normal(), "expression", "without the normal, which only materials have", "one with it");
}

inline void require_field_bounds(const Aabb& box) {
  const auto proper = [](double lo, double hi) { return lo < hi && std::isfinite(lo) == std::isfinite(hi); };
  require(proper(box.lo.x, box.hi.x) && proper(box.lo.y, box.hi.y) && proper(box.lo.z, box.hi.z), "bounds",
          "two corners, the first below the second on each axis and both finite or infinite there",
          text(box.lo) + " and " + text(box.hi));
}

inline void require_axis_number(int axis) { require(axis >= 0 && axis <= 2, "axis", "0, 1 or 2", axis); }

}  // namespace octomarch
