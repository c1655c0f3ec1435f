// Sizes that every kernel and every caller of one agrees on.
#pragma once

#include <cstddef>

namespace octomarch::kernels {

inline constexpr std::size_t kPacketWidth = 4;   ///< pixels across
inline constexpr std::size_t kPacketHeight = 2;  ///< pixels down
inline constexpr std::size_t kPacketLanes = kPacketWidth * kPacketHeight;
inline constexpr std::size_t kPackets = 8;                      ///< slots of a block
inline constexpr std::size_t kLanes = kPackets * kPacketLanes;  ///< of a block, and of a register
inline constexpr std::size_t kAlignment = 64;                   ///< bytes: one AVX-512 batch, one cache line

/// Rows between the two register files of a march. Side by side, the same register of both lay a power of two apart for
/// some programs, and loads waited for stores to the other: 12.8 ms instead of 11.3 for one scene of the benchmarks.
inline constexpr std::size_t kFileGap = 1;

}  // namespace octomarch::kernels
