// Points by the cells of an octree that they lie in: each group is run with its cell's short program. Comes before field.hpp.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "octomarch/base/parallel.hpp"
#include "octomarch/kernels/block.hpp"
#include "octomarch/program/octree.hpp"
#include "octomarch/render/sorted_ways.hpp"
#include "octomarch/render/stages.hpp"

namespace octomarch {

/// Elements that lie in one cell: `count` places from `first` on, of an order in which groups follow each other, each beginning
/// where a batch does.
template <class Real>
struct CellGroup {
  const typename Octree<Real>::Cell* cell;
  Region<Real> region;  ///< in which the cell's part may be run
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
      : octree_(octree), maker_(octree, sampler), unpacker_(octree.tape()) {}

  /// Groups `count` elements, SortedWays::kMost at the most; point(i) returns the coordinates of the i-th as an array of three.
  /// Those that are NaN are left out. `evaluations`: of each element, as far as one can tell. Making cells can take
  /// long: where that is cancelled groups are as large as they are by then. Counts cells for `stage`.
  template <class Point>
  void sort(std::size_t count, double evaluations, const bool& cancelled, StageStats& stage, Point&& point) {
    cancelled_ = &cancelled;
    stage_ = &stage;
    evaluations_ = evaluations;
    groups_.clear();
    maker_.forget_passing();
    place_of_.clear();
    places_ = 0;
    ways_.clear();
    for (std::size_t i = 0; i < count; ++i) {
      const std::array<Real, 3> p = point(i);
      if (p[0] == p[0] && p[1] == p[1] && p[2] == p[2]) ways_.add(octree_.way_to(p[0], p[1], p[2]), i);
    }
    ways_.sort();
    std::size_t begin = 0;
    for (std::size_t i = 0; i < octree_.tops().size(); ++i) {
      const std::size_t end = ways_.end_of_top(begin, i);
      typename Octree<Real>::Top& top = octree_.tops()[i];
      if (end > begin) split(top.cell, {&top, 0, {}}, begin, end);
      begin = end;
    }
    if (begin < ways_.size()) add_group(octree_.outside(), kEverywhere, begin, ways_.size());
    stage.cells_visited += groups_.size();
  }

  const std::vector<CellGroup<Real>>& groups() const { return groups_; }
  /// What is to be run for a group, until the next call.
  TapePart part(const CellGroup<Real>& group) { return unpacker_.ready(group.cell->part); }
  /// Places that all groups take, with the gaps between them.
  std::size_t places() const { return places_; }
  /// Calls f(element, place) for each that is in a group.
  template <class Function>
  void for_each_place(Function&& f) const {
    for (std::size_t k = 0; k < place_of_.size(); ++k) f(ways_.element(k), std::size_t{place_of_[k]});
  }

 private:
  using Cell = typename Octree<Real>::Cell;
  using Place = typename Octree<Real>::Place;

  static constexpr Real kFar = std::numeric_limits<Real>::infinity();
  static constexpr Region<Real> kEverywhere = {{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}};

  // Nanoseconds, about:
  static constexpr double kGroupCost = 150.0;      ///< of a group by itself
  static constexpr double kInstructionCost = 1.0;  ///< of an instruction of an evaluation by itself
  static constexpr double kBatchCost = 1.6;        ///< and for each batch
  static constexpr double kLanesOfBatch = 16.0;
  /// What has to be gained for a child to be made, by itself and for each instruction of its parent. That is a half and a
  /// thirtieth of what it takes, since the smaller cells below it will gain more.
  static constexpr double kCellPrice = 2000.0;
  static constexpr double kPruningPrice = 1.0;
  /// What is hoped for from the smaller cells below one, beside its own program, and at the least.
  static constexpr double kHope = 0.4;
  static constexpr double kLeast = 8.0;

  double cost(double length, std::size_t count) const {
    const double batches = std::ceil(static_cast<double>(count) / kLanesOfBatch);
    return kGroupCost + evaluations_ * length * (kInstructionCost + batches * kBatchCost);
  }

  static double hoped_length(const Cell& cell) {
    const double length = cell.part.length;
    return cell.is_leaf ? length : std::max(kHope * length, std::min(kLeast, length));
  }

  /// Groups the elements of [begin, end), which lie in a cell.
  void split(Cell& cell, const Place& place, std::size_t begin, std::size_t end) {
    if (cell.is_leaf || is_set(*cancelled_)) return add_group(cell, place.region(), begin, end);
    std::array<std::size_t, 9> bounds;
    ways_.find_octants(place.level, begin, end, bounds);
    std::array<Cell*, 8> children;
    for (unsigned octant = 0; octant < 8; ++octant) {
      children[octant] = bounds[octant + 1] == bounds[octant] ? nullptr : cell.child(octant);
      if (children[octant] != nullptr) __builtin_prefetch(children[octant]);  // far apart in memory
    }
    double apart = 0.0;
    double price = 0.0;
    for (unsigned octant = 0; octant < 8; ++octant) {
      const std::size_t count = bounds[octant + 1] - bounds[octant];
      if (count == 0) continue;
      const Cell* const child = children[octant];
      apart += cost(hoped_length(child != nullptr ? *child : cell), count);
      if (child == nullptr) price += kCellPrice + kPruningPrice * cell.part.length;
    }
    if (!is_worth(cell, cost(cell.part.length, end - begin) - apart, price)) {
      return add_group(cell, place.region(), begin, end);
    }
    for (unsigned octant = 0; octant < 8; ++octant) {
      if (bounds[octant + 1] == bounds[octant]) continue;
      const Place below = place.child(octant);
      split(child_of(cell, below, octant), below, bounds[octant], bounds[octant + 1]);
    }
  }

  /// Are children worth their price? They are made when having done without them has cost as much, so that little is lost whether
  /// others come or not.
  static bool is_worth(Cell& cell, double gain, double price) {
    if (gain <= 0.0) return false;
    if (price == 0.0) return true;
    const double regret = static_cast<double>(cell.regret.load(std::memory_order_relaxed)) + gain;
    const bool is_due = regret >= price;
    // what threads add at the same time may get lost
    cell.regret.store(is_due ? 0.0F : static_cast<float>(regret), std::memory_order_relaxed);
    return is_due;
  }

  /// A child, until the next sort only where the octree is full.
  Cell& child_of(Cell& parent, const Place& place, unsigned octant) {
    Cell* const known = parent.child(octant);
    return known != nullptr ? *known : make_child(parent, place, octant);
  }

  Cell& make_child(Cell& parent, const Place& place, unsigned octant) {
    const ScopedTimer timer(stage_->cell_seconds);
    ++stage_->cells_made;
    return maker_.child(parent, place, octant);
  }

  void add_group(const Cell& cell, const Region<Real>& region, std::size_t begin, std::size_t end) {
    constexpr std::size_t kBatch = kernels::kAlignment / sizeof(float);  // the widest
    groups_.push_back({&cell, region, places_, end - begin});
    for (std::size_t k = begin; k < end; ++k) place_of_.push_back(static_cast<std::uint32_t>(places_ + (k - begin)));
    places_ += (end - begin + kBatch - 1) / kBatch * kBatch;
  }

  Octree<Real>& octree_;
  CellMaker<Real> maker_;
  Unpacker unpacker_;
  double evaluations_ = 1.0;
  const bool* cancelled_ = nullptr;  ///< during a sort
  StageStats* stage_ = nullptr;      ///< as well
  SortedWays ways_;
  std::vector<CellGroup<Real>> groups_;
  std::vector<std::uint32_t> place_of_;  ///< by the order
  std::size_t places_ = 0;
};

}  // namespace octomarch
