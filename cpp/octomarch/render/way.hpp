// An element (a ray or a point of a batch) and where it is in an octree, in one number. Comes before sorted_ways.hpp and
// cell_sweep.hpp.
#pragma once

#include <cstddef>
#include <cstdint>

#include "octomarch/program/octree.hpp"

namespace octomarch {

/// Numbers are in the order of the ways (Octree::way_to), then of the elements.
class Way {
  static constexpr unsigned kElementBits = 20;
  static constexpr unsigned kTopShift = Octree<float>::kWayBits + kElementBits;

 public:
  /// Elements are numbers below this.
  static constexpr std::size_t kMost = std::size_t{1} << kElementBits;

  Way(std::uint64_t way, std::size_t element) : bits_(way << kElementBits | element) {}

  std::size_t element() const { return bits_ & (kMost - 1); }
  std::size_t top() const { return bits_ >> kTopShift; }
  unsigned octant(unsigned level) const { return static_cast<unsigned>(bits_ >> (kTopShift - 3 * (level + 1))) & 7U; }
  /// Do both go through the same cell of a level?
  bool is_with(const Way& other, unsigned level) const { return (bits_ ^ other.bits_) >> (kTopShift - 3 * level) == 0; }

  /// Bytes that ways differ in, the last first.
  static constexpr unsigned kBytes = (64 - kElementBits + 7) / 8;
  std::size_t byte(unsigned index) const { return bits_ >> (kElementBits + 8 * index) & 0xFFU; }

  friend auto operator<=>(const Way&, const Way&) = default;

 private:
  std::uint64_t bits_;
};

}  // namespace octomarch
