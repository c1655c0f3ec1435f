// Between Python's numbers and names and the core's vectors and enumerations. Every registration that binds plain data
// uses it; arrays.hpp does the same for numpy arrays.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include "octomarch/base/error.hpp"
#include "octomarch/base/types.hpp"

namespace octomarch {

using Triple = std::array<double, 3>;

inline Vec3 vec3(const Triple& v) { return {v[0], v[1], v[2]}; }

/// Getter of a Vec3 member as a tuple of three floats.
template <class Owner>
auto triple_of(Vec3 Owner::* member) {
  return [member](const Owner& owner) {
    const Vec3& v = owner.*member;
    return std::tuple{v.x, v.y, v.z};
  };
}

/// The names by which Python knows the values of an enumeration.
template <class Value, std::size_t count>
using Names = std::array<std::pair<std::string_view, Value>, count>;

/// The value called `text`, or an ArgumentError that lists the names there are.
template <class Value, std::size_t count>
Value parse(const char* argument, std::string_view text, const Names<Value, count>& names) {
  std::string known;
  for (const auto& [name, value] : names) {
    if (text == name) return value;
    known.append(known.empty() ? "'" : ", '").append(name).append("'");
  }
  throw ArgumentError(std::string(argument) + " must be one of " + known + ", got '" + std::string(text) + "'");
}

/// Getter of an enumeration member by name. `names` must outlive it.
template <class Owner, class Value, std::size_t count>
auto name_of(Value Owner::* member, const Names<Value, count>& names) {
  return [member, &names](const Owner& owner) {
    for (const auto& [name, value] : names) {
      if (owner.*member == value) return name;
    }
    return std::string_view("unknown");
  };
}

}  // namespace octomarch
