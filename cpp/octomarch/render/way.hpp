// An element (a ray or a point of a batch) and where it is in an octree, in one number. Comes before sorted_ways.hpp and
// cell_sweep.hpp.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "octomarch/program/octree.hpp"

namespace octomarch {

/// Numbers are in the order of the ways (Octree::way_to), then of the elements.
class Way {
  static constexpr unsigned kElementBits = 20;
  static constexpr unsigned kTopShift = Octree<float>::kWayBits + kElementBits;
  static_assert(Octree<float>::kTops < std::size_t{1} << (64 - kTopShift));

 public:
  /// Elements are numbers below this.
  static constexpr std::size_t kMost = std::size_t{1} << kElementBits;

  Way() = default;
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
  std::uint64_t bits_ = 0;
};

/// Ways in a row, whose memory stays when they are cleared.
class Ways {
 public:
  bool is_empty() const { return size_ == 0; }
  std::size_t size() const { return size_; }
  const Way* begin() const { return ways_.data(); }
  Way& operator[](std::size_t k) { return ways_[k]; }
  const Way* end() const { return ways_.data() + size_; }

  void clear() { size_ = 0; }
  void push(Way way) { *append(1) = way; }
  /// Room for so many more, which are to be written.
  Way* append(std::size_t count) {
    if (size_ + count > ways_.size()) ways_.resize(2 * (size_ + count));
    size_ += count;
    return ways_.data() + size_ - count;
  }
  void keep_first(std::size_t count) { size_ = count; }

 private:
  std::vector<Way> ways_;
  std::size_t size_ = 0;
};

}  // namespace octomarch
