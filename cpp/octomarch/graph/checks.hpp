// What builders ask of arguments. Each throws ArgumentError that names the argument and the value.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>

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

/// Rows of samples have numbers that floats hold, see ops/grid.hpp.
inline void require_grid(const std::array<std::size_t, 3>& size, std::span<const float> values) {
  constexpr std::size_t kMostRows = std::size_t{1} << 24U;
  constexpr std::size_t kMost = std::size_t{1} << 31U;
  const std::string shape =
      "(" + std::to_string(size[0]) + ", " + std::to_string(size[1]) + ", " + std::to_string(size[2]) + ")";
  require(size[0] >= 2 && size[1] >= 2 && size[2] >= 2, "values", "an array with 2 or more along each axis", shape);
  const bool is_small = size[0] <= kMostRows && size[1] <= kMostRows && size[0] * size[1] <= kMostRows &&
                        size[2] <= kMostRows && size[0] * size[1] * size[2] < kMost;
  require(is_small, "values", "an array of fewer than 2^31 numbers, 2^24 of them along the first two axes at most",
          shape);
  require(size[0] * size[1] * size[2] == values.size(), "values", "as many as its size says", values.size());
  const auto is_finite_number = [](float value) { return std::isfinite(value); };
  const auto wrong = std::ranges::find_if_not(values, is_finite_number);
  if (wrong == values.end()) return;
  const auto index = static_cast<std::size_t>(wrong - values.begin());
  require(false,
          "values[" + std::to_string(index / (size[1] * size[2])) + ", " + std::to_string(index / size[2] % size[1]) +
              ", " + std::to_string(index % size[2]) + "]",
          "finite in 32 bits", text(static_cast<double>(*wrong)));
}

inline void require_grid_box(const Aabb& box) {
  const bool is_box =
      is_finite(box.lo) && is_finite(box.hi) && box.lo.x < box.hi.x && box.lo.y < box.hi.y && box.lo.z < box.hi.z;
  require(is_box && is_finite(box.hi - box.lo), "bounds", "two finite corners, the first below the second on each axis",
          text(box.lo) + " and " + text(box.hi));
}

inline void require_axis_number(int axis) { require(axis >= 0 && axis <= 2, "axis", "0, 1 or 2", axis); }

}  // namespace octomarch
