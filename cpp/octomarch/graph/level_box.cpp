#include "octomarch/graph/level_box.hpp"

#include <algorithm>
#include <cmath>

namespace octomarch {
namespace {

template <class Function>
Vec3 per_axis(const Vec3& a, const Vec3& b, Function&& f) {
  return {f(a.x, b.x), f(a.y, b.y), f(a.z, b.z)};
}

}  // namespace

Vec3 smaller(const Vec3& a, const Vec3& b) {
  return per_axis(a, b, [](double u, double v) { return std::min(u, v); });
}
Vec3 larger(const Vec3& a, const Vec3& b) {
  return per_axis(a, b, [](double u, double v) { return std::max(u, v); });
}

bool is_bounded(const LevelBox& box) { return is_finite(box.lo) && is_finite(box.hi); }

LevelBox hull(const LevelBox& a, const LevelBox& b) {
  return {smaller(a.lo, b.lo), larger(a.hi, b.hi), larger(a.growth, b.growth)};
}

LevelBox overlap(const LevelBox& a, const LevelBox& b) {
  return {larger(a.lo, b.lo), smaller(a.hi, b.hi), larger(a.growth, b.growth)};
}

LevelBox grown(const LevelBox& box, double level) {
  return {box.lo - box.growth * level, box.hi + box.growth * level, box.growth};
}

LevelBox moved(const LevelBox& box, const Vec3& offset) { return {box.lo + offset, box.hi + offset, box.growth}; }

LevelBox scaled(const LevelBox& box, double factor) { return {box.lo * factor, box.hi * factor, box.growth}; }

LevelBox rotated(const LevelBox& box, std::span<const double> rotation) {
  const Axis3 lo = array_of(box.lo);
  const Axis3 hi = array_of(box.hi);
  const Axis3 growth = array_of(box.growth);
  Axis3 new_lo{};
  Axis3 new_hi{};
  Axis3 new_growth{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      const double weight = rotation[row * 3 + column];
      if (weight == 0.0) continue;  // 0·∞ is no bound
      const double low = std::min(lo[column], hi[column]) * weight;
      const double high = std::max(lo[column], hi[column]) * weight;
      new_lo[row] += std::min(low, high);
      new_hi[row] += std::max(low, high);
      new_growth[row] += std::fabs(weight) * growth[column];
    }
  }
  return {vector_of(new_lo), vector_of(new_hi), vector_of(new_growth)};
}

LevelBox stretched(const LevelBox& box, const Vec3& factors) {
  const double least = std::min({factors.x, factors.y, factors.z});
  const auto times = [](double a, double b) { return a * b; };
  return {per_axis(box.lo, factors, times), per_axis(box.hi, factors, times),
          per_axis(box.growth, factors * (1.0 / least), times)};
}

LevelBox mirrored(const LevelBox& box, double axis) {
  Axis3 lo = array_of(box.lo);
  const Axis3 hi = array_of(box.hi);
  const auto i = static_cast<std::size_t>(axis);
  lo[i] = -hi[i];
  return {vector_of(lo), box.hi, box.growth};
}

LevelBox within_cylinder(const LevelBox& box, double radius, std::size_t axis) {
  Axis3 lo{-radius, -radius, -radius};
  Axis3 hi{radius, radius, radius};
  Axis3 growth{1.0, 1.0, 1.0};
  lo[axis] = array_of(box.lo)[axis];
  hi[axis] = array_of(box.hi)[axis];
  growth[axis] = array_of(box.growth)[axis];
  return {vector_of(lo), vector_of(hi), vector_of(growth)};
}

LevelBox between(const LevelBox& box, double half_height) {
  return {{box.lo.x, box.lo.y, -half_height}, {box.hi.x, box.hi.y, half_height}, {box.growth.x, box.growth.y, 1.0}};
}

LevelBox revolved(const LevelBox& box, double offset) {
  const double radius = box.hi.x + offset;
  return {{-radius, box.lo.y, -radius}, {radius, box.hi.y, radius}, {box.growth.x, box.growth.y, box.growth.x}};
}

LevelBox repeated(const LevelBox& box, const Node& node) {
  Axis3 lo = array_of(box.lo);
  Axis3 hi = array_of(box.hi);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const RepeatAxis repeat = repeat_axis(node, axis);
    if (repeat.period == 0.0) continue;
    lo[axis] -= repeat.limit * repeat.period;
    hi[axis] += repeat.limit * repeat.period;
  }
  return {vector_of(lo), vector_of(hi), box.growth};
}

}  // namespace octomarch
