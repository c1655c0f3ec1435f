// The way down to the cells of an octree that are looked for one by one, shortened: a table of places, each with the smallest cell
// known there. The octree keeps it; chain_lanes.hpp goes by it.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace octomarch {

/// Safe from any thread. Cells know their `level`, halvings of the largest; kLevels is that of the smallest.
template <class Cell, unsigned kLevels>
class Shortcuts {
 public:
  using Place = std::array<std::uint32_t, 3>;  ///< in smallest cells

  /// None at all.
  Shortcuts() = default;
  /// One to eight for each of so many things that are to be told apart, but for very many.
  explicit Shortcuts(std::size_t things)
      : levels_(std::min(kMostLevels, static_cast<unsigned>(std::bit_width(kPlacesOfThing * things)) / 3)),
        cells_(std::size_t{1} << 3 * levels_) {}

  /// The level to which they lead at the most.
  unsigned levels() const { return levels_; }
  std::size_t bytes() const { return cells_.size() * sizeof(cells_[0]); }

  /// A cell that holds a place, or null; not where there are none at all.
  Cell* find(const Place& place) const { return cells_[index_of(place)].load(std::memory_order_acquire); }
  /// `cell`: holds the place, is no farther down than levels(), and lives as long as this.
  void remember(const Place& place, Cell& cell) { cells_[index_of(place)].store(&cell, std::memory_order_release); }

 private:
  static constexpr std::size_t kPlacesOfThing = 4;
  static constexpr unsigned kMostLevels = 7;

  std::size_t index_of(const Place& place) const {
    const unsigned below = kLevels - levels_;
    std::size_t index = 0;
    for (const std::uint32_t at : place) index = index << levels_ | at >> below;
    return index;
  }

  unsigned levels_ = 0;
  std::vector<std::atomic<Cell*>> cells_;
};

}  // namespace octomarch
