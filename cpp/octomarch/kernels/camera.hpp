// The rays of a tile, in lanes, for cameras whose rays are an affine map of the pixel; render/camera.cpp makes those of
// others. march.hpp follows them.
#pragma once

#include "octomarch/kernels/api.hpp"
#include "octomarch/kernels/lanes.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

/// Columns and rows of a block's pixels, lane by lane.
template <class Real>
struct BlockPixels {
  alignas(kAlignment) Real column[kLanes];
  alignas(kAlignment) Real row[kLanes];

  constexpr BlockPixels() : column{}, row{} {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      column[lane] = static_cast<Real>(lane_column(lane));
      row[lane] = static_cast<Real>(lane_row(lane));
    }
  }
};

template <class Real>
void camera_rays(const CameraView<Real>& camera, const TileView& tile, const Vectors<Real>& out) {
  using T = Lanes<Real>;
  static constexpr BlockPixels<Real> kPixels;
  const T none = std::numeric_limits<Real>::quiet_NaN();
  std::size_t first = 0;
  for (std::size_t block = 0; block < std::size_t{tile.blocks_across} * tile.blocks_down; ++block, first += kLanes) {
    const std::size_t left = tile.x + block % tile.blocks_across * kBlockEdge;
    const std::size_t top = tile.y + block / tile.blocks_across * kBlockEdge;
    const T x = static_cast<Real>(left);
    const T y = static_cast<Real>(top);
    for (std::size_t lane = 0; lane < kLanes; lane += kWidth<Real>) {
      const T column = x + T::load(kPixels.column + lane);
      const T row = y + T::load(kPixels.row + lane);
      const Mask<Real> in_picture =
          (column < T(static_cast<Real>(tile.width))) & (row < T(static_cast<Real>(tile.height)));
      const T s = select(in_picture, column + T(camera.point[0]), none);
      const T r = row + T(camera.point[1]);
      const T rx = T(camera.corner[0]) + s * T(camera.right[0]) + r * T(camera.down[0]);
      const T ry = T(camera.corner[1]) + s * T(camera.right[1]) + r * T(camera.down[1]);
      const T rz = T(camera.corner[2]) + s * T(camera.right[2]) + r * T(camera.down[2]);
      const T length = camera.perspective ? sqrt(rx * rx + ry * ry + rz * rz) : T(Real(1));
      const T scale = T(Real(1)) / length;
      (rx * scale).store(out.x + first + lane);
      (ry * scale).store(out.y + first + lane);
      (rz * scale).store(out.z + first + lane);
    }
  }
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
