// Ways down an octree (Octree::way_to) in their order, with the elements that go them. Comes before cell_groups.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "octomarch/program/octree.hpp"

namespace octomarch {

class SortedWays {
  static constexpr unsigned kElementBits = 20;

 public:
  /// Elements are numbers below this.
  static constexpr std::size_t kMost = std::size_t{1} << kElementBits;

  void clear() { ways_.clear(); }
  void add(std::uint64_t way, std::size_t element) { ways_.push_back(way << kElementBits | element); }
  std::size_t size() const { return ways_.size(); }
  std::size_t element(std::size_t k) const { return ways_[k] & (kMost - 1); }

  /// Sorts by ways, then by elements: by bytes from the last, where there are enough of them. O(size).
  void sort() {
    constexpr std::size_t kEnough = 96;
    if (ways_.size() < kEnough) return std::sort(ways_.begin(), ways_.end());
    for (auto& count : counts_) count.fill(0);
    for (const std::uint64_t way : ways_) {
      for (unsigned byte = 0; byte < kBytes; ++byte) ++counts_[byte][byte_of(way, byte)];
    }
    scratch_.resize(ways_.size());
    for (unsigned byte = 0; byte < kBytes; ++byte) {
      std::array<std::uint32_t, 256>& next = counts_[byte];
      if (next[byte_of(ways_.front(), byte)] == ways_.size()) continue;  // the same everywhere
      std::uint32_t sum = 0;
      for (std::uint32_t& count : next) sum += std::exchange(count, sum);
      for (const std::uint64_t way : ways_) scratch_[next[byte_of(way, byte)]++] = way;
      ways_.swap(scratch_);
    }
  }

  /// Where those from `begin` on end that go below a top.
  std::size_t end_of_top(std::size_t begin, std::size_t top) const {
    return end_of(begin, ways_.size(), kTopShift, top);
  }

  /// Where the octants of a cell at a level begin and end, of the elements [begin, end) that go through it.
  void find_octants(unsigned level, std::size_t begin, std::size_t end, std::array<std::size_t, 9>& bounds) const {
    const unsigned shift = kTopShift - 3 * (level + 1);
    const std::uint64_t first = ways_[begin] >> shift & ~std::uint64_t{7};
    bounds[0] = begin;
    for (unsigned octant = 0; octant < 8; ++octant) {
      bounds[octant + 1] = end_of(bounds[octant], end, shift, first | octant);
    }
  }

 private:
  static constexpr unsigned kTopShift = Octree<float>::kWayBits + kElementBits;
  static constexpr unsigned kBytes = (64 - kElementBits + 7) / 8;

  static std::size_t byte_of(std::uint64_t way, unsigned byte) { return way >> (kElementBits + 8 * byte) & 0xFFU; }

  /// The first of [begin, end) that is past all whose upper bits are `value`.
  std::size_t end_of(std::size_t begin, std::size_t end, unsigned shift, std::uint64_t value) const {
    constexpr std::size_t kFew = 16;
    if (end - begin <= kFew) {
      while (begin < end && ways_[begin] >> shift <= value) ++begin;
      return begin;
    }
    const auto past = std::partition_point(ways_.begin() + static_cast<std::ptrdiff_t>(begin),
                                           ways_.begin() + static_cast<std::ptrdiff_t>(end),
                                           [&](std::uint64_t way) { return way >> shift <= value; });
    return static_cast<std::size_t>(past - ways_.begin());
  }

  std::vector<std::uint64_t> ways_;
  std::vector<std::uint64_t> scratch_;
  std::array<std::array<std::uint32_t, 256>, kBytes> counts_;
};

}  // namespace octomarch
