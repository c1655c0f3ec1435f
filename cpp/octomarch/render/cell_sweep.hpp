// Rays through the cells of an octree from front to back, so that a cell is marched when all rays that pass through it have
// come. Comes before cell_march.hpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "octomarch/render/cell_choice.hpp"
#include "octomarch/render/way.hpp"

namespace octomarch {

/// Rays that wait in cells. Those that have to go back, since a step was too long, wait for the next sweep, and many of a cell
/// go on together: at once, each would run two programs for itself. Where a cell has a list, rays of which few share it leave the
/// sweep. Keeps its memory from march to march; one for each thread.
template <class Real>
class CellSweep {
 public:
  using Cell = typename Octree<Real>::Cell;
  using Place = typename Octree<Real>::Place;

  /// `choice` must outlive this.
  explicit CellSweep(CellChoice<Real>& choice)
      : choice_(choice), tops_(choice.octree().tops()), at_tops_(tops_.size() + 1) {}

  /// Lets a ray wait whose next sample is at a point; not where that is NaN. Rays are numbers below Way::kMost.
  void add(std::size_t ray, Real x, Real y, Real z) {
    if (x == x && y == y && z == z) arrived_.push({choice_.octree().way_to(x, y, z), ray});
  }

  /// Calls march(part, region, rays) for the rays of one cell after the other until none waits any more, and march_alone(rays) for
  /// those that had better run parts of their own; both add rays that have not ended. `nearest`: the octant that most rays come
  /// from. Where the choice is cancelled rays are left as they are.
  template <class March, class MarchAlone>
  void run(unsigned nearest, March&& march, MarchAlone&& march_alone) {
    nearest_ = nearest;
    for (bool goes_on = true; goes_on;) {
      goes_on = false;
      choice_.forget_passing();
      for (std::size_t top = at_tops_.size(); top-- > 0;) {  // the largest first, as rays come from afar
        for (const Way way : arrived_) at_tops_[way.top()].push(way);
        arrived_.clear();
        Ways& rays = at_tops_[top];
        if (rays.is_empty()) continue;
        goes_on = true;
        if (top == tops_.size()) {
          march_cell(choice_.octree().outside(), kAllPoints<Real>, rays, march);
        } else {
          visit(tops_[top].cell, {&tops_[top], 0, {}}, rays, march);
        }
      }
      for (const Way way : gone_back_) arrived_.push(way);
      gone_back_.clear();
      if (alone_.is_empty()) continue;
      goes_on = true;
      if (!choice_.is_cancelled()) march_alone(std::span(alone_.begin(), alone_.size()));
      alone_.clear();
    }
  }

 private:
  /// Marches the rays of a cell, or of its octants from front to back.
  template <class March>
  void visit(Cell& cell, const Place& place, Ways& rays, March&& march) {
    if (choice_.go_alone(cell, rays.size())) {
      for (const Way way : rays) alone_.push(way);
      return rays.clear();
    }
    if (cell.is_leaf) return march_cell(cell, place.region(), rays, march);
    const unsigned level = place.level;
    std::array<std::uint32_t, 8> counts{};
    for (const Way way : rays) ++counts[way.octant(level)];
    if (!choice_.goes_deeper(cell, counts)) return march_cell(cell, place.region(), rays, march);
    std::array<Ways, 8>& octants = levels_[level];
    const Way any = *rays.begin();
    divide(rays, level, counts, octants);
    std::size_t elsewhere = arrived_.size();
    for (unsigned i = 0; i < 8; ++i) {
      const unsigned octant = i ^ nearest_;
      if (octants[octant].is_empty()) continue;
      if (choice_.is_cancelled()) {
        octants[octant].clear();
        continue;
      }
      const Place below = place.child(octant);
      visit(choice_.child(cell, below, octant), below, octants[octant], march);
      for (std::size_t k = elsewhere; k < arrived_.size(); ++k) {
        const Way way = arrived_[k];
        if (!way.is_with(any, level)) {
          arrived_[elsewhere++] = way;
        } else if ((way.octant(level) ^ nearest_) > i) {
          octants[way.octant(level)].push(way);
        } else {
          gone_back_.push(way);
        }
      }
      arrived_.keep_first(elsewhere);
    }
  }

  /// Moves the rays of a cell to its octants.
  static void divide(Ways& rays, unsigned level, const std::array<std::uint32_t, 8>& counts,
                     std::array<Ways, 8>& octants) {
    const unsigned first = rays.begin()->octant(level);
    if (counts[first] == rays.size()) return std::swap(rays, octants[first]);
    std::array<Way*, 8> next;
    for (unsigned octant = 0; octant < 8; ++octant) next[octant] = octants[octant].append(counts[octant]);
    for (const Way way : rays) *next[way.octant(level)]++ = way;
    rays.clear();
  }

  template <class March>
  void march_cell(const Cell& cell, const Region<Real>& region, Ways& rays, March&& march) {
    choice_.count_visits(1);
    if (!choice_.is_cancelled()) march(choice_.part(cell), region, std::span(rays.begin(), rays.size()));
    rays.clear();
  }

  CellChoice<Real>& choice_;
  std::vector<typename Octree<Real>::Top>& tops_;
  unsigned nearest_ = 0;
  Ways arrived_;               ///< in no list yet
  Ways alone_;                 ///< where only a few rays share a cell
  Ways gone_back_;             ///< to cells that this sweep has left behind
  std::vector<Ways> at_tops_;  ///< by tops, then those outside of all
  std::array<std::array<Ways, 8>, Octree<Real>::kLevels>
      levels_;  ///< octants of the cell that is visited at each level
};

}  // namespace octomarch
