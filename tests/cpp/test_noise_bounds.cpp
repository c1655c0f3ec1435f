// The bounds of gradient noise that graph/expression_bounds.cpp states, proven by branch and bound over a cell. Noise is
// Σ w·(g·r) over the cell's corners, w the product of the fades, r the offset from the corner and g one of the twelve
// gradients (±1, ±1, 0), …; whichever it is, |g·r| is at most the sum of the two largest components of |r|.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <doctest/doctest.h>

#include "octomarch/base/types.hpp"
#include "octomarch/graph/builder.hpp"
#include "octomarch/graph/expression_bounds.hpp"

namespace octomarch {
namespace {

using Triple = std::array<double, 3>;

/// max over the twelve gradients of g·v.
double largest_product(const Triple& v) {
  const Triple size{std::fabs(v[0]), std::fabs(v[1]), std::fabs(v[2])};
  return size[0] + size[1] + size[2] - std::min({size[0], size[1], size[2]});
}

/// A cube of the cell.
struct Piece {
  Triple middle;
  double half;
};

/// The weight of a corner along one axis and its derivatives: in the middle of a piece, and the most they are over it.
struct Weight {
  Triple middle;
  Triple most;
};

Weight weight_of(double t, double half, bool far) {
  const double sign = far ? 1.0 : -1.0;
  const double fade = t * t * t * (t * (6.0 * t - 15.0) + 10.0);
  const Triple middle{far ? fade : 1.0 - fade, sign * 30.0 * t * t * (t - 1.0) * (t - 1.0),
                      sign * 60.0 * t * (2.0 * t - 1.0) * (t - 1.0)};
  // each derivative changes by at most the next one times the way; the third is at most 60
  Triple most{};
  double next = 60.0;
  for (const std::size_t order : {2U, 1U, 0U}) {
    constexpr Triple kEverywhere{1.0, 1.875, 5.774};
    most[order] = std::min(std::fabs(middle[order]) + half * next, kEverywhere[order]);
    next = most[order];
  }
  return {middle, most};
}

struct Corner {
  std::array<Weight, 3> weight;
  Triple offset;

  /// Product of one derivative's order per axis, in the middle or at most.
  double product(Triple Weight::* of, std::size_t x, std::size_t y, std::size_t z) const {
    return (weight[0].*of)[x] * (weight[1].*of)[y] * (weight[2].*of)[z];
  }
};

Corner corner_of(const Piece& piece, unsigned which) {
  Corner corner{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool far = (which >> axis & 1U) != 0;
    corner.weight[axis] = weight_of(piece.middle[axis], piece.half, far);
    corner.offset[axis] = piece.middle[axis] - (far ? 1.0 : 0.0);
  }
  return corner;
}

/// Bound of |noise| over a piece.
double largest_value(const Piece& piece) {
  double sum = 0.0;
  for (unsigned which = 0; which < 8; ++which) {
    const Corner corner = corner_of(piece, which);
    const auto most = [&](std::size_t x, std::size_t y, std::size_t z) {
      return corner.product(&Weight::most, x, y, z);
    };
    const double product = largest_product(corner.offset);
    const double change = most(1, 0, 0) + most(0, 1, 0) + most(0, 0, 1);
    sum += corner.product(&Weight::middle, 0, 0, 0) * product +
           piece.half * (change * product + 2.0 * most(0, 0, 0));  // of the two components
  }
  return sum;
}

/// Bound of |∂ noise/∂u| over a piece: of Σ g·v with v = w·u + (∇w·u)·r.
double largest_slope(const Piece& piece, const Triple& u) {
  double sum = 0.0;
  for (unsigned which = 0; which < 8; ++which) {
    const Corner corner = corner_of(piece, which);
    const auto along_u = [&](Triple Weight::* of) {
      return std::array{u[0] * corner.product(of, 1, 0, 0), u[1] * corner.product(of, 0, 1, 0),
                        u[2] * corner.product(of, 0, 0, 1)};
    };
    const auto most = [&](std::size_t x, std::size_t y, std::size_t z) {
      return corner.product(&Weight::most, x, y, z);
    };
    const Triple terms = along_u(&Weight::middle);
    const Triple largest = along_u(&Weight::most);
    const double w = corner.product(&Weight::middle, 0, 0, 0);
    const double slope = terms[0] + terms[1] + terms[2];
    const double largest_slope = largest[0] + largest[1] + largest[2];
    const double weight_change = most(1, 0, 0) + most(0, 1, 0) + most(0, 0, 1);
    const double slope_change = u[0] * (most(2, 0, 0) + most(1, 1, 0) + most(1, 0, 1)) +
                                u[1] * (most(1, 1, 0) + most(0, 2, 0) + most(0, 1, 1)) +
                                u[2] * (most(1, 0, 1) + most(0, 1, 1) + most(0, 0, 2));
    Triple v{};
    Triple change{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      v[axis] = w * u[axis] + slope * corner.offset[axis];
      const double largest_offset = std::fabs(corner.offset[axis]) + piece.half;
      change[axis] = piece.half * (weight_change * u[axis] + slope_change * largest_offset + largest_slope);
    }
    sum += largest_product(v) + largest_product(change);
  }
  return sum;
}

/// Is the function below `limit` everywhere in a cube? `over` bounds it over a piece, at a point where half is 0.
template <class Function>
bool stays_below(double limit, const Piece& cube, const Function& over) {
  constexpr double kRounding = 1e-9;
  std::vector<Piece> work{cube};
  while (!work.empty()) {
    const Piece piece = work.back();
    work.pop_back();
    if (over(Piece{piece.middle, 0.0}) > limit) return false;
    if (over(piece) < limit - kRounding) continue;
    for (unsigned part = 0; part < 8; ++part) {
      Piece next{piece.middle, 0.5 * piece.half};
      for (std::size_t axis = 0; axis < 3; ++axis)
        next.middle[axis] += (part >> axis & 1U) != 0 ? next.half : -next.half;
      work.push_back(next);
    }
  }
  return true;
}

/// Directions u with u.x ≥ u.y ≥ u.z ≥ 0; the other 47 parts of the sphere are mirror images of this one, as the cell is.
constexpr int kDivisions = 6;

Vec3 direction(int i, int j) {
  return normalized({1.0, static_cast<double>(i) / kDivisions, static_cast<double>(j) / kDivisions});
}

/// Distance from the sphere's centre of the plane through three directions.
double height(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = cross(b - a, c - a);
  return std::fabs(dot(normal, a)) / length(normal);
}

/// The least height of the triangles of neighbours.
double least_height() {
  double least = 1.0;
  for (int i = 0; i < kDivisions; ++i) {
    for (int j = 0; j <= i; ++j) {
      const Vec3 a = direction(i, j);
      const Vec3 b = direction(i + 1, j + 1);
      least = std::min(least, height(a, b, direction(i + 1, j)));
      if (j < i) least = std::min(least, height(a, b, direction(i, j + 1)));
    }
  }
  return least;
}

ExpressionBounds bounds_of_noise() {
  return expression_bounds(*noise(coordinate(0), coordinate(1), coordinate(2), 0), {});
}

}  // namespace

TEST_CASE("noise stays within its bound") {
  const ExpressionBounds bounds = bounds_of_noise();
  CHECK(bounds.lo == -bounds.hi);
  constexpr Piece kEighth{{0.25, 0.25, 0.25}, 0.25};  // the others are its mirror images
  CHECK(stays_below(bounds.hi, kEighth, largest_value));
  CHECK(largest_value({{0.5, 0.35525669, 0.48149221}, 0.0}) > 1.0363);
}

TEST_CASE("the slope of noise stays within its bound") {
  // convex in u, so that the corners of a triangle bound what is on the sphere above it
  constexpr Piece kCell{{0.5, 0.5, 0.5}, 0.5};
  const double limit = bounds_of_noise().slope * least_height();
  for (int i = 0; i <= kDivisions; ++i) {
    for (int j = 0; j <= i; ++j) {
      const Vec3 u = direction(i, j);
      CHECK(stays_below(limit, kCell, [&u](const Piece& piece) { return largest_slope(piece, {u.x, u.y, u.z}); }));
    }
  }
  CHECK(largest_slope({{0.5, 0.5, 0.5}, 0.0}, {1.0, 0.0, 0.0}) == 3.75);
}

}  // namespace octomarch
