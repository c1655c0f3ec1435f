// The rays of a tile, in lanes, for cameras whose rays are an affine map of the pixel; render/camera.cpp makes those of
// others. march.hpp follows them.
#pragma once

#include "octomarch/kernels/api.hpp"
#include "octomarch/kernels/lanes.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

template <class Real>
void camera_rays(const CameraView<Real>& camera, const TileView& tile, const Vectors<Real>& out) {
  using T = Lanes<Real>;
  constexpr Real kNone = std::numeric_limits<Real>::quiet_NaN();
  alignas(kAlignment) Real columns[kLanes];
  alignas(kAlignment) Real rows[kLanes];
  const std::size_t packets = std::size_t{tile.packets_across} * tile.packets_down;
  std::size_t i = tile.x;
  std::size_t j = tile.y;
  for (std::size_t first = 0; first < packets; first += kPackets) {
    // Points of the pixels of a block of packets; those outside the planes become NaN, and so does their ray.
    for (std::size_t slot = 0; slot < kPackets; ++slot) {
      Real across[kPacketWidth];
      Real down[kPacketHeight];
      for (std::size_t x = 0; x < kPacketWidth; ++x) {
        across[x] = i + x < tile.width ? static_cast<Real>(tile.left + i + x) + camera.point[0] : kNone;
      }
      for (std::size_t y = 0; y < kPacketHeight; ++y) {
        down[y] = j + y < tile.height ? static_cast<Real>(tile.top + j + y) + camera.point[1] : kNone;
      }
      for (std::size_t lane = 0; lane < kPacketLanes; ++lane) {
        columns[slot * kPacketLanes + lane] = across[lane % kPacketWidth];
        rows[slot * kPacketLanes + lane] = down[lane / kPacketWidth];
      }
      i += kPacketWidth;
      if (i >= tile.x + tile.packets_across * kPacketWidth) {
        i = tile.x;
        j += kPacketHeight;
      }
    }
    for (std::size_t lane = 0; lane < kLanes; lane += kWidth<Real>) {
      const T s = T::load(columns + lane);
      const T r = T::load(rows + lane);
      const T x = T(camera.corner[0]) + s * T(camera.right[0]) + r * T(camera.down[0]);
      const T y = T(camera.corner[1]) + s * T(camera.right[1]) + r * T(camera.down[1]);
      const T z = T(camera.corner[2]) + s * T(camera.right[2]) + r * T(camera.down[2]);
      const T length = camera.perspective ? sqrt(x * x + y * y + z * z) : T(Real(1));
      const T scale = T(Real(1)) / length;
      const std::size_t ray = first * kPacketLanes + lane;
      (x * scale).store(out.x + ray);
      (y * scale).store(out.y + ray);
      (z * scale).store(out.z + ray);
    }
  }
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
