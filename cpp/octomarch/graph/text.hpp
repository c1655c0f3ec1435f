// Numbers as they appear in error messages. The builder and the schema use it.
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <string>

#include "octomarch/base/types.hpp"

namespace octomarch {

/// Shortest text that reads back as `value`; NaN without a sign.
inline std::string text(double value) {
  if (std::isnan(value)) return "nan";
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

inline std::string text(const Vec3& v) { return "(" + text(v.x) + ", " + text(v.y) + ", " + text(v.z) + ")"; }

}  // namespace octomarch
