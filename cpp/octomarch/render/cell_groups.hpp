// Points by the cells of an octree that they lie in: each group is run with its cell's short program. Comes before field.hpp.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "octomarch/base/parallel.hpp"
#include "octomarch/program/octree.hpp"
#include "octomarch/render/buffer.hpp"
#include "octomarch/render/stages.hpp"

namespace octomarch {

/// Elements that lie in one cell: `count` places from `first` on, of an order in which groups follow each other, each beginning
/// where a batch does.
template <class Real>
struct CellGroup {
  const typename Octree<Real>::Cell* cell;
  std::size_t first;
  std::size_t count;
};

/// Sorts elements by cells, as large ones as are worth it: many elements go to smaller cells with shorter programs, few stay
/// together. Keeps its memory from call to call; one for each thread.
template <class Real>
class CellGroups {
 public:
  /// Both must outlive this.
  CellGroups(Octree<Real>& octree, Sampler<Real>& sampler)
      : octree_(octree), pruner_(octree.tape(), octree.margins(), sampler) {}

  /// Groups `count` elements; point(i) returns the coordinates of the i-th as an array of three. Those that are NaN are left
  /// out. `evaluations`: of each element, as far as one can tell. Making cells can take
  /// long: where that is cancelled groups are as large as they are by then. Counts cells for `stage`.
  template <class Point>
  void sort(std::size_t count, double evaluations, const bool& cancelled, StageStats& stage, Point&& point) {
    cancelled_ = &cancelled;
    stage_ = &stage;
    evaluations_ = evaluations;
    groups_.clear();
    passing_.clear();
    order_.clear();
    place_of_.clear();
    places_ = 0;
    points_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      points_[i] = point(i);
      const bool is_number =
          points_[i][0] == points_[i][0] && points_[i][1] == points_[i][1] && points_[i][2] == points_[i][2];
      if (is_number) order_.push_back(static_cast<std::uint32_t>(i));
    }
    octants_.resize(order_.size());
    scratch_.resize(order_.size());
    std::size_t begin = 0;
    for (Cell& top : octree_.tops()) {
      const auto first = order_.begin() + static_cast<std::ptrdiff_t>(begin);
      const auto within = std::partition(first, order_.end(), [&](std::uint32_t i) {
        return contains(top.region, points_[i][0], points_[i][1], points_[i][2]);
      });
      const auto end = static_cast<std::size_t>(within - order_.begin());
      if (end > begin) split(top, begin, end);
      begin = end;
    }
    if (begin < order_.size()) add_group(octree_.outside(), begin, order_.size());
    stage.cells_visited += groups_.size();
  }

  const std::vector<CellGroup<Real>>& groups() const { return groups_; }
  /// Places that all groups take, with the gaps between them.
  std::size_t places() const { return places_; }
  /// Calls f(element, place) for each that is in a group.
  template <class Function>
  void for_each_place(Function&& f) const {
    for (std::size_t k = 0; k < place_of_.size(); ++k) f(std::size_t{order_[k]}, std::size_t{place_of_[k]});
  }

 private:
  using Cell = typename Octree<Real>::Cell;

  /// Nanoseconds, about: what a group costs by itself, and an instruction of an evaluation, by itself and for each batch.
  static constexpr double kGroupCost = 300.0;
  static constexpr double kInstructionCost = 7.0;
  static constexpr double kBatchCost = 1.5;
  static constexpr double kLanesOfBatch = 16.0;
  static constexpr double kPruningCost =
      4.0;  ///< of an instruction, when a child is made: a part of the whole, since it will serve others too
  /// A longer program is not run for the sake of few elements.
  static constexpr double kLongest = 512.0;
  /// Nor is one longer than this, though its cell hardly shortened it, as those do not that all of a polygon's edges matter in.
  static constexpr double kLongestStalled = 2048.0;
  /// What is expected of a child's program, beside its parent's.
  static constexpr double kChildLength = 0.4;

  double cost(double length, double count) const {
    const double blocks = std::ceil(count / static_cast<double>(kernels::kLanes));
    const double batches = std::ceil(count / kLanesOfBatch);
    return kGroupCost + evaluations_ * length * (blocks * kInstructionCost + batches * kBatchCost);
  }

  /// Groups the elements of order_[begin, end), which lie in a cell.
  void split(Cell& cell, std::size_t begin, std::size_t end) {
    if (is_set(*cancelled_)) return add_group(cell, begin, end);
    Cell* const smallest = descend(cell, begin, end);
    if (smallest->is_leaf) return add_group(*smallest, begin, end);
    std::array<std::size_t, 8> counts{};
    for (std::size_t k = begin; k < end; ++k) {
      const std::array<Real, 3>& p = points_[order_[k]];
      octants_[k] = static_cast<std::uint8_t>(smallest->octant_of(p[0], p[1], p[2]));
      ++counts[octants_[k]];
    }
    const auto length = static_cast<double>(smallest->part->code.size());
    double apart = 0.0;
    for (unsigned octant = 0; octant < 8; ++octant) {
      if (counts[octant] == 0) continue;
      apart += cost(length * kChildLength, static_cast<double>(counts[octant]));
      if (smallest->children[octant].load(std::memory_order_relaxed) == nullptr) apart += length * kPruningCost;
    }
    const double together = cost(length, static_cast<double>(end - begin));
    const double longest = smallest->is_shorter ? kLongest : kLongestStalled;
    if (together <= apart && length <= longest) return add_group(*smallest, begin, end);
    std::array<std::size_t, 9> bounds{begin};
    for (std::size_t octant = 0; octant < 8; ++octant) bounds[octant + 1] = bounds[octant] + counts[octant];
    std::array<std::size_t, 9> next = bounds;
    for (std::size_t k = begin; k < end; ++k) scratch_[next[octants_[k]]++] = order_[k];
    std::copy(scratch_.begin() + static_cast<std::ptrdiff_t>(begin),
              scratch_.begin() + static_cast<std::ptrdiff_t>(end), order_.begin() + static_cast<std::ptrdiff_t>(begin));
    for (unsigned octant = 0; octant < 8; ++octant) {
      if (counts[octant] == 0) continue;
      split(child_of(*smallest, octant), bounds[octant], bounds[octant + 1]);
    }
  }

  /// A child, until the next sort only where the octree is full.
  Cell& child_of(Cell& parent, unsigned octant) {
    Cell* const known = parent.children[octant].load(std::memory_order_acquire);
    return known != nullptr ? *known : make_child(parent, octant);
  }

  Cell& make_child(Cell& parent, unsigned octant) {
    const ScopedTimer timer(stage_->cell_seconds);
    ++stage_->cells_made;
    if (Cell* const child = octree_.child(parent, octant, pruner_)) return *child;
    passing_.push_back(octree_.make_apart(parent, octant, pruner_));
    return *passing_.back();
  }

  /// The smallest cell below that holds all of the elements.
  Cell* descend(Cell& cell, std::size_t begin, std::size_t end) {
    std::array<Real, 3> lo = points_[order_[begin]];
    std::array<Real, 3> hi = lo;
    for (std::size_t k = begin + 1; k < end; ++k) {
      const std::array<Real, 3>& p = points_[order_[k]];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        lo[axis] = std::min(lo[axis], p[axis]);
        hi[axis] = std::max(hi[axis], p[axis]);
      }
    }
    Cell* result = &cell;
    while (!result->is_leaf && !is_set(*cancelled_)) {
      const unsigned octant = result->octant_of(lo[0], lo[1], lo[2]);
      if (octant != result->octant_of(hi[0], hi[1], hi[2])) break;
      result = &child_of(*result, octant);
    }
    return result;
  }

  void add_group(const Cell& cell, std::size_t begin, std::size_t end) {
    constexpr std::size_t kBatch = kernels::kAlignment / sizeof(float);  // the widest
    groups_.push_back({&cell, places_, end - begin});
    for (std::size_t k = begin; k < end; ++k) place_of_.push_back(static_cast<std::uint32_t>(places_ + (k - begin)));
    places_ += (end - begin + kBatch - 1) / kBatch * kBatch;
  }

  Octree<Real>& octree_;
  Pruner<Real> pruner_;
  double evaluations_ = 1.0;
  const bool* cancelled_ = nullptr;  ///< during a sort
  StageStats* stage_ = nullptr;      ///< as well
  std::vector<std::array<Real, 3>> points_;
  std::vector<std::uint32_t> order_;  ///< elements, group after group
  std::vector<std::uint32_t> scratch_;
  std::vector<std::uint8_t> octants_;
  std::vector<CellGroup<Real>> groups_;
  std::vector<std::unique_ptr<Cell>> passing_;
  std::vector<std::uint32_t> place_of_;  ///< by the order
  std::size_t places_ = 0;
};

}  // namespace octomarch
