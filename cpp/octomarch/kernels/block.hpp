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

}  // namespace octomarch::kernels
