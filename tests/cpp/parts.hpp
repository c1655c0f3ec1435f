// What tests of tapes' parts share: regions and random points of them, tapes run by the one-lane kernels, a row of balls.
#pragma once

#include <algorithm>
#include <limits>
#include <random>
#include <type_traits>
#include <utility>
#include <vector>

#include "octomarch/graph/builder.hpp"
#include "octomarch/kernels/dispatch.hpp"
#include "octomarch/program/chain.hpp"
#include "octomarch/program/program.hpp"
#include "octomarch/program/prune.hpp"
#include "octomarch/render/buffer.hpp"

namespace octomarch {

constexpr std::size_t kPoints = 16;

using Random = std::mt19937_64;

inline double uniform(Random& random, double lo, double hi) {
  return std::uniform_real_distribution<double>(lo, hi)(random);
}

/// A box of any size, from points to all of space, its ends often on numbers where operators change.
template <class Real>
Region<Real> random_region(Random& random) {
  constexpr std::array<double, 9> kSizes = {0.0, 1e-30, 1e-5, 0.1, 0.5, 2.0, 1e4, 1e21, 1e38};
  constexpr std::array<double, 7> kPlaces = {0.0, 0.0, 0.25, 0.75, 3.0, 1e4, 1e21};
  Region<Real> region;
  const double common = kSizes[random() % kSizes.size()];
  const double place = kPlaces[random() % kPlaces.size()];
  for (unsigned axis = 0; axis < 3; ++axis) {
    const double size = random() % 4 == 0 ? kSizes[random() % kSizes.size()] : common;
    const double middle = random() % 2 == 0 ? place * static_cast<double>(random() % 3) - place
                                            : uniform(random, -1.0, 1.0) * (place + 1.0);
    region.lo[axis] = static_cast<Real>(middle);
    region.hi[axis] = static_cast<Real>(middle + size);
    if (random() % 16 == 0) region.lo[axis] = -std::numeric_limits<Real>::infinity();
    if (random() % 16 == 0) region.hi[axis] = std::numeric_limits<Real>::infinity();
  }
  return region;
}

/// The eighth part of a region, at random.
template <class Real>
Region<Real> part_of(const Region<Real>& region, Random& random) {
  Region<Real> part = region;
  for (unsigned axis = 0; axis < 3; ++axis) {
    const Real middle = region.lo[axis] + (region.hi[axis] - region.lo[axis]) * Real(0.5);
    if (middle != middle) continue;
    (random() % 2 == 0 ? part.lo : part.hi)[axis] = middle;
  }
  return part;
}

/// A number of [lo, hi], often an end of it.
template <class Real>
Real number_in(Real lo, Real hi, Random& random) {
  switch (random() % 4) {
    case 0: return lo;
    case 1: return hi;
    default: break;
  }
  constexpr double kLargest = static_cast<double>(std::numeric_limits<Real>::max());
  const double low = std::max(static_cast<double>(lo), -kLargest);
  const double high = std::min(static_cast<double>(hi), kLargest);
  const double part = uniform(random, 0.0, 1.0);
  return std::clamp(static_cast<Real>(low * (1.0 - part) + high * part), lo, hi);
}

template <class Real>
VectorBuffer<Real> points_in(const Region<Real>& region, Random& random) {
  VectorBuffer<Real> points(kernels::kLanes);
  for (std::size_t i = 0; i < kPoints; ++i) {
    points.x[i] = number_in(region.lo[0], region.hi[0], random);
    points.y[i] = number_in(region.lo[1], region.hi[1], random);
    points.z[i] = number_in(region.lo[2], region.hi[2], random);
  }
  return points;
}

/// Runs code of a tape over points by the one-lane kernels; fills rows by register.
template <class Real>
class Runner final : public Sampler<Real> {
 public:
  explicit Runner(const Tape& tape, std::size_t many_that_choose = Chain::kManyThatChoose) : tape_(tape) {
    std::uint32_t registers = tape.registers;
    if (const std::optional<Chain> chain = Chain::of(tape, many_that_choose)) {
      table_ = chain->template table<Real>(tape);
      registers = std::max(registers, chain->registers());
    }
    memory_ = Buffer<Real>(4 * std::size_t{registers} * kernels::kLanes);
    for (const NodePtr& node : tape.images) {
      const auto size = [&node](std::size_t i) { return static_cast<std::uint32_t>(node->parameter(i)); };
      images_.push_back({node->texels().data(), size(0), size(1), node->kind() == NodeKind::kGrid ? size(2) : 1U});
    }
  }

  /// Values of registers at all points, one after the other, after the first `length` instructions.
  std::vector<Real> values(const TapePart& part, std::size_t length, const VectorBuffer<Real>& points,
                           const std::vector<std::uint16_t>& registers) {
    std::vector<Buffer<Real>> rows;
    std::vector<Real*> outs;
    for (std::size_t i = 0; i < registers.size(); ++i) outs.push_back(rows.emplace_back(kernels::kLanes).data());
    const kernels::Vectors<const Real> normals = points.read();  // any numbers will do
    table().expressions(view(part, length), memory_.data(), points.read(), tape_.inputs == 6 ? &normals : nullptr,
                        kPoints, &never_, registers.data(), registers.size(), outs.data());
    std::vector<Real> all;
    for (const Buffer<Real>& row : rows) all.insert(all.end(), row.data(), row.data() + kPoints);
    return all;
  }

  std::vector<Real> results(const TapePart& part, const VectorBuffer<Real>& points) {
    return values(part, part.length, points, {part.results, part.results + part.result_count});
  }

  std::vector<Real> gradients(const TapePart& part, const VectorBuffer<Real>& points) {
    VectorBuffer<Real> out(kernels::kLanes);
    table().gradient(view(part, part.length), memory_.data(), points.read(), kPoints, &never_, out.view());
    std::vector<Real> all;
    for (const Buffer<Real>* row : {&out.x, &out.y, &out.z}) {
      all.insert(all.end(), row->data(), row->data() + kPoints);
    }
    return all;
  }

  void compare(const TapePart& part, const SamplePoints<Real>& points, const Margin* margins, TakenAt* taken) override {
    table().compare(view(part, part.length), memory_.data(), {points.x, points.y, points.z}, points.radius,
                    part.origins, margins, taken);
  }

 private:
  static const kernels::KernelTable<Real>& table() { return kernels::find_isa("scalar").table<Real>(); }
  kernels::TapeView<Real> view(const TapePart& part, std::size_t length) const {
    const Real* const constants = part.has_table() ? table_.data() : constants_of<Real>(tape_);
    return {part.code, length, constants, part.registers, part.result, images_.data()};
  }

  const Tape& tape_;
  std::vector<Real> table_;  ///< constants of lists
  bool never_ = false;
  std::vector<kernels::ImageView> images_;
  Buffer<Real> memory_;
};

/// A row of balls, farther and farther from the origin.
inline NodePtr row_of_balls(int count, double k) {
  std::vector<NodePtr> balls;
  for (int i = 0; i < count; ++i) balls.push_back(translate(sphere(0.25), {2.0 * i, 0.0, 0.0}));
  return combine(NodeKind::kUnion, std::move(balls), k);
}

}  // namespace octomarch
