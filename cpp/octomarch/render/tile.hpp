// One tile of a picture: rays, march, surfaces, shading, and the planes it fills. Each worker keeps one TileRenderer
// and with it all scratch memory. Called by render.cpp.
#pragma once

#include <optional>

#include "octomarch/render/camera.hpp"
#include "octomarch/render/illumination.hpp"
#include "octomarch/render/render.hpp"
#include "octomarch/render/surface_pass.hpp"

namespace octomarch {

/// Tiles of what is computed of a picture, row by row; edges are whole packets.
struct TileGrid {
  TileGrid(const Picture& picture);

  std::size_t count() const { return std::size_t{across} * down; }
  std::size_t rays() const { return std::size_t{edge} * edge; }
  kernels::TileView tile(std::size_t index) const;

  Crop crop;
  std::uint32_t edge;  ///< of a tile, pixels
  std::uint32_t across, down;
};

template <class Real>
class TileRenderer {
 public:
  TileRenderer(const Picture& picture, const Planes<Real>& planes, const kernels::KernelTable<Real>& kernels,
               const TileGrid& grid);

  void render(std::size_t tile, const bool& cancelled);
  const RenderStats& stats() const { return stats_; }

 private:
  void cast(const kernels::TileView& tile, const PixelPoint& point);
  void march(const bool& cancelled);
  void clear(const kernels::TileView& tile);
  void write_rays(const kernels::TileView& tile);
  void write_surfaces(const kernels::TileView& tile);
  void write_sky(const kernels::TileView& tile);

  const Picture& picture_;
  const Planes<Real> planes_;
  const kernels::KernelTable<Real>& kernels_;
  const TileGrid& grid_;
  const CameraFrame frame_;
  RayBatch<Real> batch_;
  RayColumns<Real> columns_{};
  kernels::Column<Real> epsilon_{};
  std::size_t rays_ = 0;  ///< of the current tile
  Buffer<Real> registers_;
  std::optional<SurfacePass<Real>> surface_;
  std::optional<Illumination<Real>> illumination_;
  RenderStats stats_;
};

}  // namespace octomarch
