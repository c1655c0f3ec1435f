// Builders of many shapes at once, from arrays. They give each row to the builder of one shape, and join what comes out.
#include <string>
#include <utility>

#include "octomarch/graph/builder.hpp"
#include "octomarch/graph/checks.hpp"
#include "octomarch/graph/motion.hpp"

namespace octomarch {
namespace {

Vec3 row_of(std::span<const double> numbers, std::size_t i) {
  return {numbers[3 * i], numbers[3 * i + 1], numbers[3 * i + 2]};
}

/// The union of `make(i)` for every i below `count`.
template <class Make>
NodePtr union_of(std::size_t count, double smooth, const Make& make) {
  std::vector<NodePtr> shapes;
  shapes.reserve(count);
  for (std::size_t i = 0; i < count; ++i) shapes.push_back(make(i));
  return combine(NodeKind::kUnion, std::move(shapes), smooth);
}

std::string row_name(std::string_view argument, std::size_t i) {
  return std::string(argument) + "[" + std::to_string(i) + "]";
}

void require_rows(std::span<const double> rows, std::string_view argument, std::size_t count) {
  require(rows.size() == 3 * count, argument, "three numbers for each shape", rows.size());
}

void require_finite_row(const Vec3& row, std::string_view argument, std::size_t i) {
  if (!is_finite(row)) require_finite(row, row_name(argument, i));
}

void require_length_at(double length, std::string_view argument, std::size_t i) {
  if (!is_length(length)) require_length(length, row_name(argument, i));
}

}  // namespace

NodePtr spheres(std::span<const double> centers, std::span<const double> radii, double smooth) {
  require_rows(centers, "centers", radii.size());
  return union_of(radii.size(), smooth, [&](std::size_t i) {
    const Vec3 center = row_of(centers, i);
    require_finite_row(center, "centers", i);
    require_length_at(radii[i], "radii", i);
    return translate(sphere(radii[i]), center);
  });
}

NodePtr boxes(std::span<const double> centers, std::span<const double> sizes, double smooth) {
  require_rows(sizes, "sizes", centers.size() / 3);
  return union_of(sizes.size() / 3, smooth, [&](std::size_t i) {
    const Vec3 center = row_of(centers, i);
    const Vec3 size = row_of(sizes, i);
    require_finite_row(center, "centers", i);
    if (!is_length(size)) require_lengths(size, row_name("sizes", i));
    return translate(box(size), center);
  });
}

NodePtr capsules(std::span<const double> a, std::span<const double> b, std::span<const double> radii, double smooth) {
  require_rows(a, "a", radii.size());
  require_rows(b, "b", radii.size());
  return union_of(radii.size(), smooth, [&](std::size_t i) {
    require_finite_row(row_of(a, i), "a", i);
    require_finite_row(row_of(b, i), "b", i);
    require_length_at(radii[i], "radii", i);
    return capsule(row_of(a, i), row_of(b, i), radii[i]);
  });
}

NodePtr instances(const NodePtr& shape, std::span<const double> matrices, double rounding, double smooth) {
  require_shape(shape);
  require(matrices.size() % Motion::kNumbers == 0, "matrices", "twelve numbers for each copy", matrices.size());
  return union_of(matrices.size() / Motion::kNumbers, smooth, [&](std::size_t i) {
    const auto matrix = matrices.subspan(Motion::kNumbers * i).first<Motion::kNumbers>();
    const Motion motion = motion_of(matrix, rounding, row_name("matrices", i));
    return translate(rotate(scale(shape, motion.factor), motion.rotation), motion.offset);
  });
}

}  // namespace octomarch
