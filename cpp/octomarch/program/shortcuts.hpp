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
  /// As many as there are things to be told apart, or a few times more.
  explicit Shortcuts(std::size_t things)
      : levels_(std::min(kMostLevels, static_cast<unsigned>(std::bit_width(kPlacesOfThing * things) - 1) / 3)),
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

  /// Eight places that make a cube are a cache line.
  std::size_t index_of(const Place& place) const {
    const unsigned below = kLevels - levels_;
    std::size_t cube = 0;
    std::size_t in_cube = 0;
    for (unsigned axis = 3; axis-- > 0;) {
      const std::size_t at = place[axis] >> below;
      cube = cube << (levels_ - 1) | at >> 1U;
      in_cube = in_cube << 1U | (at & 1U);
    }
    return cube << 3U | in_cube;
  }

  unsigned levels_ = 0;
  std::vector<std::atomic<Cell*>> cells_;
};

}  // namespace octomarch
