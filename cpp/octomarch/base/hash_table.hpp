// A table of small values under hashes that its user computes: one array, no allocation for each value. The table of nodes
// and the compiler's table of operations come after it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace octomarch {

/// Values under hashes, of which the low 32 bits count, several under one where they have it in common. Value{} means that
/// there is none, and cannot be kept. Open addressing with linear probing; what is erased leaves no mark behind (D. E. Knuth, TAOCP vol. 3, 6.4,
/// algorithm R). All operations are O(1) expected where hashes are spread over these bits, up to 2³² values.
template <class Value>
class HashTable {
 public:
  std::size_t size() const { return size_; }

  /// The first value under `hash` that is wanted, or Value{}.
  template <class IsWanted>
  Value find(std::uint64_t hash, const IsWanted& is_wanted) const {
    return slots_.empty() ? Value{} : slots_[place_of(low(hash), is_wanted)].value;
  }

  void insert(std::uint64_t hash, Value value) {
    if (4 * (size_ + 1) > 3 * slots_.size()) resize(slots_.empty() ? kLeast : 2 * slots_.size());
    slots_[place_of(low(hash), [](const Value&) { return false; })] = {low(hash), std::move(value)};
    ++size_;
  }

  /// Takes out the first value under `hash` that is wanted, if there is one.
  template <class IsWanted>
  void erase(std::uint64_t hash, const IsWanted& is_wanted) {
    if (slots_.empty()) return;
    std::size_t hole = place_of(low(hash), is_wanted);
    if (slots_[hole].value == Value{}) return;
    for (std::size_t i = next(hole); slots_[i].value != Value{}; i = next(i)) {
      // what began its search at or before the hole moves into it, else it would not be found any more
      if (distance(home(slots_[i].hash), i) < distance(hole, i)) continue;
      slots_[hole] = std::move(slots_[i]);
      hole = i;
    }
    slots_[hole] = {};
    --size_;
    if (slots_.size() > kLeast && 8 * size_ < slots_.size()) resize(slots_.size() / 2);
  }

 private:
  /// As small as can be, since each look-up is one into memory that no cache holds.
  struct Slot {
    std::uint32_t hash = 0;
    Value value{};
  };
  static constexpr std::size_t kLeast = 16;  // a power of two, as every size is

  static constexpr std::uint32_t low(std::uint64_t hash) { return static_cast<std::uint32_t>(hash); }
  std::size_t home(std::uint32_t hash) const { return hash & (slots_.size() - 1); }
  std::size_t next(std::size_t i) const { return (i + 1) & (slots_.size() - 1); }
  std::size_t distance(std::size_t from, std::size_t to) const { return (to - from) & (slots_.size() - 1); }

  /// Where a wanted value is, or could be put.
  template <class IsWanted>
  std::size_t place_of(std::uint32_t hash, const IsWanted& is_wanted) const {
    std::size_t i = home(hash);
    while (slots_[i].value != Value{} && !(slots_[i].hash == hash && is_wanted(slots_[i].value))) i = next(i);
    return i;
  }

  void resize(std::size_t count) {
    std::vector<Slot> before = std::exchange(slots_, std::vector<Slot>(count));
    for (Slot& slot : before) {
      if (slot.value != Value{}) slots_[place_of(slot.hash, [](const Value&) { return false; })] = std::move(slot);
    }
  }

  std::vector<Slot> slots_;
  std::size_t size_ = 0;
};

}  // namespace octomarch
