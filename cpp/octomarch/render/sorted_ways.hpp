// Ways down an octree in their order, with the elements that go them. Comes before cell_groups.hpp.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "octomarch/render/way.hpp"

namespace octomarch {

class SortedWays {
 public:
  void clear() { ways_.clear(); }
  void add(Way way) { ways_.push_back(way); }
  std::size_t size() const { return ways_.size(); }
  std::size_t element(std::size_t k) const { return ways_[k].element(); }

  /// Sorts by ways, then by elements: by bytes from the last, where there are enough of them. O(size).
  void sort() {
    constexpr std::size_t kEnough = 96;
    if (ways_.size() < kEnough) return std::sort(ways_.begin(), ways_.end());
    for (auto& count : counts_) count.fill(0);
    for (const Way way : ways_) {
      for (unsigned byte = 0; byte < Way::kBytes; ++byte) ++counts_[byte][way.byte(byte)];
    }
    scratch_.resize(ways_.size());
    for (unsigned byte = 0; byte < Way::kBytes; ++byte) {
      std::array<std::uint32_t, 256>& next = counts_[byte];
      if (next[ways_.front().byte(byte)] == ways_.size()) continue;  // the same everywhere
      std::uint32_t sum = 0;
      for (std::uint32_t& count : next) sum += std::exchange(count, sum);
      for (const Way way : ways_) scratch_[next[way.byte(byte)]++] = way;
      ways_.swap(scratch_);
    }
  }

  /// Where those from `begin` on end that go below a top.
  std::size_t end_of_top(std::size_t begin, std::size_t top) const {
    return end_of(begin, ways_.size(), [top](const Way& way) { return way.top() <= top; });
  }

  /// Where the octants of a cell at a level begin and end, of the elements [begin, end) that go through it.
  void find_octants(unsigned level, std::size_t begin, std::size_t end, std::array<std::size_t, 9>& bounds) const {
    bounds[0] = begin;
    for (unsigned octant = 0; octant < 8; ++octant) {
      bounds[octant + 1] = end_of(bounds[octant], end, [&](const Way& way) { return way.octant(level) <= octant; });
    }
  }

 private:
  /// The first of [begin, end) that is not below.
  template <class IsBelow>
  std::size_t end_of(std::size_t begin, std::size_t end, IsBelow&& is_below) const {
    constexpr std::size_t kFew = 16;
    if (end - begin <= kFew) {
      while (begin < end && is_below(ways_[begin])) ++begin;
      return begin;
    }
    const auto past = std::partition_point(ways_.begin() + static_cast<std::ptrdiff_t>(begin),
                                           ways_.begin() + static_cast<std::ptrdiff_t>(end), is_below);
    return static_cast<std::size_t>(past - ways_.begin());
  }

  std::vector<Way> ways_;
  std::vector<Way> scratch_;
  std::array<std::array<std::uint32_t, 256>, Way::kBytes> counts_;
};

}  // namespace octomarch
