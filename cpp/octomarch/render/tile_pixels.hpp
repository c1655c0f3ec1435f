// From the rays of a tile, which go by blocks and packets, to pixels and planes, which go by rows. tile.cpp and camera.cpp use
// it.
#pragma once

#include <algorithm>
#include <cstdint>

#include "octomarch/graph/scene.hpp"
#include "octomarch/kernels/api.hpp"

namespace octomarch {

/// A pixel of the whole picture.
struct Pixel {
  std::uint32_t x, y;
};

/// The pixel of a tile's ray.
inline Pixel pixel_of(const kernels::TileView& tile, std::size_t ray) {
  const std::size_t block = ray / kernels::kLanes;
  const std::size_t lane = ray % kernels::kLanes;
  const std::size_t x = tile.x + block % tile.blocks_across * kernels::kBlockEdge + kernels::lane_column(lane);
  const std::size_t y = tile.y + block / tile.blocks_across * kernels::kBlockEdge + kernels::lane_row(lane);
  return {static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)};
}

inline bool contains(const Crop& crop, const Pixel& pixel) {
  return pixel.x >= crop.x && pixel.x - crop.x < crop.width && pixel.y >= crop.y && pixel.y - crop.y < crop.height;
}

/// Index of a pixel in planes that hold a crop.
inline std::size_t index_in(const Crop& crop, const Pixel& pixel) {
  return std::size_t{pixel.y - crop.y} * crop.width + (pixel.x - crop.x);
}

/// Calls f(pixel, ray, count) for each row of a packet that lies in the planes: `count` pixels side by side from index
/// `pixel` of the planes on, and as many rays from index `ray` of the tile on.
template <class Function>
void for_each_run(const kernels::TileView& tile, const Crop& crop, Function&& f) {
  for (std::size_t block = 0; block < tile.rays(); block += kernels::kLanes) {
    const Pixel corner = pixel_of(tile, block);
    const bool whole = contains(crop, corner) && contains(crop, pixel_of(tile, block + kernels::kLanes - 1));
    for (std::size_t lane = 0; lane < kernels::kLanes; lane += kernels::kPacketWidth) {
      const Pixel first{corner.x + static_cast<std::uint32_t>(kernels::lane_column(lane)),
                        corner.y + static_cast<std::uint32_t>(kernels::lane_row(lane))};
      if (whole) {  // the common case, in which the count is known
        f(index_in(crop, first), block + lane, kernels::kPacketWidth);
        continue;
      }
      if (first.y < crop.y || first.y - crop.y >= crop.height) continue;
      const std::uint32_t begin = std::max(first.x, crop.x);
      const std::uint32_t end = std::min(first.x + std::uint32_t{kernels::kPacketWidth}, crop.x + crop.width);
      if (begin < end) f(index_in(crop, {begin, first.y}), block + lane + (begin - first.x), std::size_t{end - begin});
    }
  }
}

/// Copies one number for each ray into a plane.
template <class T>
void write_plane(const kernels::TileView& tile, const Crop& crop, T* plane, const T* rays) {
  for_each_run(tile, crop, [&](std::size_t pixel, std::size_t ray, std::size_t count) {
    if (count == kernels::kPacketWidth) {  // the common case: a copy of known size is one move
      std::copy_n(rays + ray, kernels::kPacketWidth, plane + pixel);
    } else {
      std::copy_n(rays + ray, count, plane + pixel);
    }
  });
}

template <class Real>
void store(Real* plane, std::size_t pixel, Real x, Real y, Real z) {
  plane[pixel * 3] = x;
  plane[pixel * 3 + 1] = y;
  plane[pixel * 3 + 2] = z;
}

}  // namespace octomarch
