// Hashing of small records: what the compiler's tables of operations and placements share.
#pragma once

#include <cstdint>

namespace octomarch {

/// Takes one more word into a hash. The multiplier is 2⁶⁴ over the golden ratio (D. E. Knuth, TAOCP vol. 3, 6.4); the
/// shift feeds high bits back into the low ones that tables look at.
constexpr void mix(std::uint64_t& hash, std::uint64_t word) {
  hash = (hash ^ word) * 0x9E3779B97F4A7C15ULL;
  hash ^= hash >> 29U;
}

}  // namespace octomarch
