// Small value types that every layer speaks: points, boxes and 3×3 matrices in double precision. Nothing comes before
// this file; the node graph, the compiler and the host side of rendering come after it. Kernels use lanes instead.
#pragma once

#include <array>
#include <cmath>
#include <limits>

namespace octomarch {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A point, vector or colour. Scene units for points; linear RGB for colours.
struct Vec3 {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;

  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
  friend constexpr Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator*(const Vec3& a, double s) { return {a.x * s, a.y * s, a.z * s}; }
};

constexpr double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

constexpr Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Euclidean length without overflow or underflow on the way.
inline double length(const Vec3& a) { return std::hypot(a.x, a.y, a.z); }

inline bool is_finite(const Vec3& a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

/// Unit vector along `a`. Contract: `a` is finite and not zero.
inline Vec3 normalized(const Vec3& a) {
  const double largest = std::fmax(std::fabs(a.x), std::fmax(std::fabs(a.y), std::fabs(a.z)));
  const Vec3 scaled{a.x / largest, a.y / largest, a.z / largest};
  const double norm = std::sqrt(dot(scaled, scaled));
  return {scaled.x / norm, scaled.y / norm, scaled.z / norm};
}

/// Row-major 3×3 matrix; `destination_from_source` in names.
using Mat3 = std::array<double, 9>;

inline constexpr Mat3 kIdentity3 = {1, 0, 0, 0, 1, 0, 0, 0, 1};

constexpr Vec3 operator*(const Mat3& m, const Vec3& v) {
  return {m[0] * v.x + m[1] * v.y + m[2] * v.z, m[3] * v.x + m[4] * v.y + m[5] * v.z,
          m[6] * v.x + m[7] * v.y + m[8] * v.z};
}

constexpr Mat3 operator*(const Mat3& a, const Mat3& b) {
  Mat3 product{};
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      product[row * 3 + column] =
          a[row * 3] * b[column] + a[row * 3 + 1] * b[3 + column] + a[row * 3 + 2] * b[6 + column];
    }
  }
  return product;
}

constexpr Mat3 transposed(const Mat3& m) { return {m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]}; }

/// Axis-aligned box [lo, hi] in scene units. Default: the whole space.
struct Aabb {
  Vec3 lo{-kInfinity, -kInfinity, -kInfinity};
  Vec3 hi{kInfinity, kInfinity, kInfinity};
};

/// True when `box` contains no point at all, on some axis lo > hi.
constexpr bool is_empty(const Aabb& box) { return box.lo.x > box.hi.x || box.lo.y > box.hi.y || box.lo.z > box.hi.z; }

constexpr bool contains(const Aabb& box, const Vec3& p) {
  return box.lo.x <= p.x && p.x <= box.hi.x && box.lo.y <= p.y && p.y <= box.hi.y && box.lo.z <= p.z && p.z <= box.hi.z;
}

/// A box as it is seen from another origin.
constexpr Aabb counted_from(const Vec3& origin, const Aabb& box) { return {box.lo - origin, box.hi - origin}; }

inline bool is_bounded(const Aabb& box) { return is_finite(box.lo) && is_finite(box.hi); }

}  // namespace octomarch
