// Sizes that every kernel and every caller of one agrees on.
#pragma once

#include <cstddef>

namespace octomarch::kernels {

inline constexpr std::size_t kPacketWidth = 4;   ///< pixels across
inline constexpr std::size_t kPacketHeight = 2;  ///< pixels down
inline constexpr std::size_t kPacketLanes = kPacketWidth * kPacketHeight;
inline constexpr std::size_t kPackets = 8;                      ///< slots of a block
inline constexpr std::size_t kLanes = kPackets * kPacketLanes;  ///< of a block, and of a register
inline constexpr std::size_t kBlockEdge = 8;                    ///< pixels, of a block of camera rays
inline constexpr std::size_t kPacketsAcross = kBlockEdge / kPacketWidth;
inline constexpr std::size_t kAlignment = 64;  ///< bytes: one AVX-512 batch, one cache line

/// Where the pixel of a lane lies in a block of camera rays, from its upper left corner.
constexpr std::size_t lane_column(std::size_t lane) {
  return lane / kPacketLanes % kPacketsAcross * kPacketWidth + lane % kPacketWidth;
}
constexpr std::size_t lane_row(std::size_t lane) {
  return lane / kPacketLanes / kPacketsAcross * kPacketHeight + lane / kPacketWidth % kPacketHeight;
}

/// Cones of 4×4 and of 2×2 pixels in a block of camera rays.
inline constexpr std::size_t kSmallCones = 4, kSmallestCones = 16;
/// Of a block's smallest cones, the one about a lane. The k-th of those in small cone c has the index c + kSmallCones·k.
constexpr std::size_t smallest_cone_about(std::size_t lane) {
  const std::size_t column = lane_column(lane);
  const std::size_t row = lane_row(lane);
  return column / 4 + row / 4 * 2 + kSmallCones * (column / 2 % 2 + row / 2 % 2 * 2);
}

/// Rows of kLanes that a march needs beside its two register files: five busy and five quiet ones for each of two blocks,
/// and two more where steps are relaxed. All lie in one piece, the busy rows of both blocks and the files first: rows a
/// multiple of 4 KiB apart make loads wait for stores that have nothing to do with them, and while a small program's busy
/// rows fit into 4 KiB there are none. With files and state wherever the heap and the stack had them, equal runs differed
/// by 20 % from process to process.
inline constexpr std::size_t kBusyRows = 5;
inline constexpr std::size_t kQuietRows = 5;
inline constexpr std::size_t kRelaxationRows = 2;
inline constexpr std::size_t kMarchRows = 2 * (kBusyRows + kQuietRows + kRelaxationRows);

}  // namespace octomarch::kernels
