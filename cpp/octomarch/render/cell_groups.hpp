// Points by the cells of an octree that they lie in: each group is run with its cell's short program. Comes before field.hpp.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "octomarch/render/cell_choice.hpp"
#include "octomarch/render/sorted_ways.hpp"

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

/// What becomes of elements of which few share a cell with a list.
enum class Few : std::uint8_t {
  kInGroups,  ///< the same as of all others
  kAlone,     ///< they are in no group, for they had better run parts of their own
};

/// Sorts elements by cells, as large ones as are worth it: many elements go to smaller cells with shorter programs, few stay
/// together. Keeps its memory from call to call; one for each thread.
template <class Real>
class CellGroups {
 public:
  /// `choice` must outlive this.
  explicit CellGroups(CellChoice<Real>& choice) : choice_(choice) {}

  /// Groups `count` elements, Way::kMost at the most; point(i) returns the coordinates of the i-th as an array of three.
  /// Those that are NaN are left out. Making cells can take long: where that is cancelled groups are as large as they
  /// are by then. Counts cells for `stage`.
  template <class Point>
  void sort(std::size_t count, Few few, const bool& cancelled, StageStats& stage, Point&& point) {
    choice_.begin(kStayOfPoint, cancelled, stage);
    Octree<Real>& octree = choice_.octree();
    groups_.clear();
    place_of_.clear();
    alone_.clear();
    few_ = few;
    places_ = 0;
    ways_.clear();
    for (std::size_t i = 0; i < count; ++i) {
      const std::array<Real, 3> p = point(i);
      if (p[0] == p[0] && p[1] == p[1] && p[2] == p[2]) ways_.add({octree.way_to(p[0], p[1], p[2]), i});
    }
    ways_.sort();
    std::size_t begin = 0;
    for (std::size_t i = 0; i < octree.tops().size(); ++i) {
      const std::size_t end = ways_.end_of_top(begin, i);
      typename Octree<Real>::Top& top = octree.tops()[i];
      if (end > begin) split(top.cell, {&top, 0, {}}, begin, end);
      begin = end;
    }
    if (begin < ways_.size()) add_group(octree.outside(), kAllPoints<Real>, begin, ways_.size());
    choice_.count_visits(groups_.size());
  }

  const std::vector<CellGroup<Real>>& groups() const { return groups_; }
  /// In no group.
  std::span<const std::uint32_t> alone() const { return alone_; }
  /// What is to be run for a group, until the next call.
  TapePart part(const CellGroup<Real>& group) { return choice_.part(*group.cell); }
  /// Places that all groups take, with the gaps between them.
  std::size_t places() const { return places_; }
  /// Calls f(element, place) for each that is in a group.
  template <class Function>
  void for_each_place(Function&& f) const {
    for (std::size_t k = 0; k < place_of_.size(); ++k) {
      if (place_of_[k] != kNowhere) f(ways_.element(k), std::size_t{place_of_[k]});
    }
  }

 private:
  using Cell = typename Octree<Real>::Cell;
  using Place = typename Octree<Real>::Place;
  static constexpr std::uint32_t kNowhere = ~std::uint32_t{0};

  /// Groups the elements of [begin, end), which lie in a cell.
  void split(Cell& cell, const Place& place, std::size_t begin, std::size_t end) {
    if (few_ == Few::kAlone && choice_.go_alone_as_points(cell, end - begin)) {
      for (std::size_t k = begin; k < end; ++k) alone_.push_back(static_cast<std::uint32_t>(ways_.element(k)));
      place_of_.insert(place_of_.end(), end - begin, kNowhere);
      return;
    }
    if (cell.is_leaf) return add_group(cell, place.region(), begin, end);
    std::array<std::size_t, 9> bounds;
    ways_.find_octants(place.level, begin, end, bounds);
    std::array<std::uint32_t, 8> counts;
    for (unsigned octant = 0; octant < 8; ++octant) {
      counts[octant] = static_cast<std::uint32_t>(bounds[octant + 1] - bounds[octant]);
    }
    if (!choice_.goes_deeper(cell, counts)) return add_group(cell, place.region(), begin, end);
    for (unsigned octant = 0; octant < 8; ++octant) {
      if (bounds[octant + 1] == bounds[octant]) continue;
      const Place below = place.child(octant);
      if (choice_.is_cancelled()) {
        add_group(cell, place.region(), bounds[octant], bounds[octant + 1]);
        continue;
      }
      split(choice_.child(cell, below, octant), below, bounds[octant], bounds[octant + 1]);
    }
  }

  void add_group(const Cell& cell, const Region<Real>& region, std::size_t begin, std::size_t end) {
    groups_.push_back({&cell, region, places_, end - begin});
    for (std::size_t k = begin; k < end; ++k) place_of_.push_back(static_cast<std::uint32_t>(places_ + (k - begin)));
    places_ += kernels::padded_batches(end - begin);
  }

  CellChoice<Real>& choice_;
  SortedWays ways_;
  std::vector<CellGroup<Real>> groups_;
  std::vector<std::uint32_t> place_of_;  ///< by the order
  std::vector<std::uint32_t> alone_;
  Few few_ = Few::kInGroups;
  std::size_t places_ = 0;
};

}  // namespace octomarch
