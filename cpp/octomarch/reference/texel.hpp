// Bilinear lookup in an image. Expressions ask for it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "octomarch/graph/node.hpp"
#include "octomarch/reference/vector.hpp"

namespace octomarch::reference {

/// A channel at a point (u, v) of an image, and its derivatives along u and v.
template <class T>
struct TexelJet {
  T value;
  T du;
  T dv;
};

/// The texel that whole number `index` of `count` stands for; 0 for what is none.
template <class T>
std::size_t wrapped(T index, std::size_t count, bool repeats) {
  const T n = static_cast<T>(count);
  const T inside = repeats ? index - n * std::floor(index / n) : index;
  if (!(inside > T(0))) return 0;
  return inside < n ? static_cast<std::size_t>(inside) : count - 1;
}

/// Contract: `node` is a kTexel. Texel (i, j) has its centre at u = (i + ½)/width, v = 1 − (j + ½)/height.
template <class T>
TexelJet<T> texel_at(const Node& node, T u, T v) {
  const Node& image = node.child(0);
  const auto channel = static_cast<std::size_t>(node.parameter(0));
  const bool repeats_u = node.parameter(1) != 0.0;
  const bool repeats_v = node.parameter(1) == 1.0;
  const auto width = static_cast<std::size_t>(image.parameter(0));
  const auto height = static_cast<std::size_t>(image.parameter(1));
  const T column = u * static_cast<T>(width) - T(0.5);
  const T row = (T(1) - v) * static_cast<T>(height) - T(0.5);
  const T left = std::floor(column);
  const T top = std::floor(row);
  const auto texel = [&](T i, T j) {
    const std::size_t at = wrapped(j, height, repeats_v) * width + wrapped(i, width, repeats_u);
    return T(image.texels()[3 * at + channel]);
  };
  const T s = column - left;
  const T t = row - top;
  const T upper_left = texel(left, top);
  const T upper_right = texel(left + T(1), top);
  const T lower_left = texel(left, top + T(1));
  const T lower_right = texel(left + T(1), top + T(1));
  const T upper = glm::mix(upper_left, upper_right, s);
  const T lower = glm::mix(lower_left, lower_right, s);
  const T per_column = glm::mix(upper_right - upper_left, lower_right - lower_left, t);
  return {glm::mix(upper, lower, t), per_column * static_cast<T>(width), (upper - lower) * static_cast<T>(height)};
}

}  // namespace octomarch::reference
