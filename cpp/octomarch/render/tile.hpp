// One tile of a picture: rays, march, surfaces, shading, and the planes it fills. Each worker keeps one TileRenderer
// and with it all scratch memory. Called by render.cpp.
#pragma once

#include <optional>
#include <vector>

#include "octomarch/render/camera.hpp"
#include "octomarch/render/radiance.hpp"
#include "octomarch/render/render.hpp"
#include "octomarch/render/surface_pass.hpp"

namespace octomarch {

/// Tiles of what is computed of a picture, row by row. Tiles and the blocks in them lie where they would lie in the whole
/// picture, so that a crop has the same cones, and with them the same bits.
struct TileGrid {
  TileGrid(const Picture& picture);

  std::size_t count() const { return std::size_t{across} * down; }
  static constexpr std::size_t rays() { return std::size_t{kEdge} * kEdge; }
  kernels::TileView tile(std::size_t index) const;

  static constexpr std::uint32_t kEdge = 64;  ///< of a tile, pixels; large ones keep blocks full for longer

  Crop crop;
  std::uint32_t width, height;  ///< of the whole picture
  std::uint32_t left, top;      ///< column and row of the first tile in the whole picture
  std::uint32_t across, down;
};

template <class Real>
class TileRenderer {
 public:
  /// `sky`: the scene's, compiled; used where colour is wanted. `field`: shared by all.
  TileRenderer(const Picture& picture, const SharedField<Real>& field, const Expressions& sky,
               const Planes<Real>& planes, const kernels::KernelTable<Real>& kernels, const TileGrid& grid);

  /// Fills the planes of a tile. Colours of several samples take a pass for each, and the other planes one of their own
  /// through the pixels' centres.
  void render(std::size_t tile, const bool& cancelled);
  const RenderStats& stats() const { return stats_; }

 private:
  void set_columns();
  void pass(const kernels::TileView& tile, const PixelPoint& point, const Planes<Real>& planes, const bool& cancelled);
  void cast(const kernels::TileView& tile, const PixelPoint& point);
  void march(const kernels::TileView& tile, const bool& cancelled);
  void shade(const kernels::TileView& tile, const bool& cancelled);
  void keep_rays_of_crop(const kernels::TileView& tile);
  void clear(const kernels::TileView& tile);
  void write_rays(const kernels::TileView& tile);
  void write_surfaces(const kernels::TileView& tile);
  void write_color(const kernels::TileView& tile);
  void add_sample(const kernels::TileView& tile, std::size_t sample);
  bool needs_points() const;
  bool needs_surface() const;

  const Picture& picture_;
  const Planes<Real> wanted_;
  const std::vector<PixelPoint> samples_;
  Planes<Real> planes_;  ///< of the current pass
  const kernels::KernelTable<Real>& kernels_;
  const TileGrid& grid_;
  const CameraFrame frame_;
  const double lead_;  ///< by which rays are moved along at once
  RayBatch<Real> batch_;
  Buffer<Real> epsilon_;  ///< of rays that are moved, which have one each
  RayColumns<Real> columns_{};
  std::size_t rays_ = 0;  ///< of the current tile
  Buffer<std::int32_t> steps_;
  Field<Real> field_;
  std::optional<SurfacePass<Real>> surface_;
  std::optional<Radiance<Real>> radiance_;
  Buffer<double> sum_;  ///< of the colours of a tile's samples so far, in double so that equal ones have their own mean
  RenderStats stats_;
};

}  // namespace octomarch
