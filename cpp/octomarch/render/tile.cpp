#include "octomarch/render/tile.hpp"

#include <chrono>

namespace octomarch {

namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// A pixel of the whole picture.
struct Pixel {
  std::uint32_t x, y;
};

Pixel pixel_of(const kernels::TileView& tile, std::size_t ray) {
  const std::size_t block = ray / kernels::kLanes;
  const std::size_t lane = ray % kernels::kLanes;
  const std::size_t x = tile.x + block % tile.blocks_across * kernels::kBlockEdge + kernels::lane_column(lane);
  const std::size_t y = tile.y + block / tile.blocks_across * kernels::kBlockEdge + kernels::lane_row(lane);
  return {static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)};
}

bool contains(const Crop& crop, const Pixel& pixel) {
  return pixel.x >= crop.x && pixel.x - crop.x < crop.width && pixel.y >= crop.y && pixel.y - crop.y < crop.height;
}

/// Index of a pixel in planes that hold a crop.
std::size_t index_in(const Crop& crop, const Pixel& pixel) {
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

}  // namespace

TileGrid::TileGrid(const Picture& picture)
    : crop(picture.crop),
      width(picture.width),
      height(picture.height),
      left(crop.x / kEdge),
      top(crop.y / kEdge),
      across((crop.x + crop.width - 1) / kEdge - left + 1),
      down((crop.y + crop.height - 1) / kEdge - top + 1) {}

kernels::TileView TileGrid::tile(std::size_t index) const {
  constexpr std::uint32_t kBlock = kernels::kBlockEdge;
  const auto range = [](std::uint32_t tile, std::uint32_t first, std::uint32_t count) {
    const std::uint32_t begin = std::max(tile * kEdge, first) / kBlock * kBlock;
    const std::uint32_t end = std::min(tile * kEdge + kEdge, first + count);
    return std::pair(begin, (end - begin + kBlock - 1) / kBlock);
  };
  const auto [x, blocks_across] = range(left + static_cast<std::uint32_t>(index % across), crop.x, crop.width);
  const auto [y, blocks_down] = range(top + static_cast<std::uint32_t>(index / across), crop.y, crop.height);
  return {x, y, blocks_across, blocks_down, width, height};
}

template <class Real>
TileRenderer<Real>::TileRenderer(const Picture& picture, Octree<Real>* octree, const Expressions& sky,
                                 const Planes<Real>& planes, const kernels::KernelTable<Real>& kernels,
                                 const TileGrid& grid)
    : picture_(picture),
      wanted_(planes),
      samples_(sample_points(picture.samples)),
      planes_(planes),
      kernels_(kernels),
      grid_(grid),
      frame_(frame(picture.camera, picture.width, picture.height)),
      batch_(kernels::padded_lanes(grid.rays())),
      steps_(batch_.t.size()),
      field_(*picture.program, octree, kernels, grid.rays()) {
  if (needs_surface()) surface_.emplace(field_, kernels, batch_.t.size());
  if (planes.color) radiance_.emplace(picture, sky, kernels, batch_.t.size());
  if (planes.color && samples_.size() > 1) sum_ = Buffer<double>(3 * batch_.t.size());

  const auto column = [](const Real* values, double value) {
    return kernels::Column<Real>{values, static_cast<Real>(value)};
  };
  const Vec3& fixed = frame_.fixed;
  const bool one_origin = frame_.one_origin();
  columns_.ox = one_origin ? column(nullptr, fixed.x) : column(batch_.origin.x.data(), 0);
  columns_.oy = one_origin ? column(nullptr, fixed.y) : column(batch_.origin.y.data(), 0);
  columns_.oz = one_origin ? column(nullptr, fixed.z) : column(batch_.origin.z.data(), 0);
  columns_.dx = one_origin ? column(batch_.direction.x.data(), 0) : column(nullptr, fixed.x);
  columns_.dy = one_origin ? column(batch_.direction.y.data(), 0) : column(nullptr, fixed.y);
  columns_.dz = one_origin ? column(batch_.direction.z.data(), 0) : column(nullptr, fixed.z);

  // hit epsilon: absolute, rounding error and pixel footprint (see March)
  const auto reach = [&](double Vec3::* axis) {
    if (one_origin) return std::fabs(fixed.*axis);
    return std::fabs(frame_.corner.*axis) + std::fabs(frame_.right.*axis) * picture.width +
           std::fabs(frame_.down.*axis) * picture.height;
  };
  const double farthest = std::max({reach(&Vec3::x), reach(&Vec3::y), reach(&Vec3::z)});
  const double floor = static_cast<double>(kUlpFloor<Real>);
  const double tolerance = picture.march.pixel_tolerance;
  columns_.epsilon.value =
      clamped<Real>(std::max({picture.march.least_epsilon(), floor * farthest, tolerance * frame_.pixel_radius}));
  columns_.epsilon_slope = clamped<Real>(std::max(floor, tolerance * frame_.pixel_slope));
}

/// Is a plane wanted that says something of surface points?
template <class Real>
bool TileRenderer<Real>::needs_points() const {
  return planes_.position || planes_.normal || planes_.object_id || planes_.material_id;
}

template <class Real>
bool TileRenderer<Real>::needs_surface() const {
  return planes_.color || needs_points();
}

template <class Real>
void TileRenderer<Real>::render(std::size_t index, const bool& cancelled) {
  const kernels::TileView tile = grid_.tile(index);
  if (samples_.size() == 1 || !wanted_.color) return pass(tile, PixelPoint{}, wanted_, cancelled);
  Planes<Real> centre = wanted_;
  centre.color = nullptr;
  if (!(centre == Planes<Real>{})) pass(tile, PixelPoint{}, centre, cancelled);
  for (std::size_t sample = 0; sample < samples_.size() && !is_set(cancelled); ++sample) {
    pass(tile, samples_[sample], {.color = wanted_.color}, cancelled);
    add_sample(tile, sample);
  }
}

/// Marches and shades one ray per pixel.
template <class Real>
void TileRenderer<Real>::pass(const kernels::TileView& tile, const PixelPoint& point, const Planes<Real>& planes,
                              const bool& cancelled) {
  planes_ = planes;
  const auto start = std::chrono::steady_clock::now();
  cast(tile, point);
  march(tile, cancelled);
  stats_.seconds_march += seconds_since(start);
  if (is_set(cancelled)) return;

  const auto shading_start = std::chrono::steady_clock::now();
  write_rays(tile);
  if (needs_points()) clear(tile);
  if (needs_surface()) {
    surface_->gather(batch_, columns_, rays_);
    const bool lit = planes_.color && (radiance_->needs_normals() || surface_->has_candidates());
    if (lit || planes_.normal) stats_.gradient_evaluations += surface_->find_normals(picture_.shading, cancelled);
    if (planes_.object_id || planes_.material_id) stats_.attribute_evaluations += surface_->find_objects(cancelled);
    if (needs_points()) write_surfaces(tile);
  }
  if (planes_.color) radiance_->light(batch_, columns_, rays_, *surface_, cancelled, stats_);
  stats_.seconds_shade += seconds_since(shading_start);
  if (!planes_.color || is_set(cancelled)) return;

  const auto mirror_start = std::chrono::steady_clock::now();
  radiance_->follow_mirrors(*surface_, cancelled, stats_);
  stats_.seconds_reflect += seconds_since(mirror_start);
  write_color(tile);
}

/// Rays through one point of each pixel of a tile.
template <class Real>
void TileRenderer<Real>::cast(const kernels::TileView& tile, const PixelPoint& point) {
  rays_ = tile.rays();
  if (frame_.kind == CameraKind::kPanoramic) {
    panoramic_rays(frame_, tile, point, batch_.direction);
  } else {
    kernels_.camera_rays(view<Real>(frame_, point), tile,
                         frame_.one_origin() ? batch_.direction.view() : batch_.origin.view());
  }
}

/// Rays of pixels that are not in the crop were there for the cones alone: they become invalid. Counts the others.
template <class Real>
void TileRenderer<Real>::keep_rays_of_crop(const kernels::TileView& tile) {
  Buffer<Real>& component = frame_.one_origin() ? batch_.direction.x : batch_.origin.x;
  std::size_t kept = 0;
  for_each_run(tile, grid_.crop, [&](std::size_t, std::size_t, std::size_t count) { kept += count; });
  stats_.rays += kept;
  for (std::size_t ray = 0; kept < rays_ && ray < rays_; ++ray) {
    if (!contains(grid_.crop, pixel_of(tile, ray))) component[ray] = std::numeric_limits<Real>::quiet_NaN();
  }
}

template <class Real>
void TileRenderer<Real>::march(const kernels::TileView& tile, const bool& cancelled) {
  const kernels::Column<Real> t_max{nullptr, clamped<Real>(picture_.march.max_distance)};
  const kernels::MarchParameters<Real> parameters =
      march_parameters(*picture_.program, picture_.march, columns_.epsilon_slope, cancelled);
  kernels::Column<Real> start{nullptr, parameters.t_min};
  if (picture_.march.method == Method::kAuto) {
    field_.advance_together(columns_.view(start, t_max, rays_), parameters, batch_.start, stats_.cones);
    start.values = batch_.start.data();
  }
  keep_rays_of_crop(tile);
  field_.march(columns_.view(start, t_max, rays_), parameters, batch_, planes_.steps ? steps_.data() : nullptr,
               stats_.primary);
}

template <class Real>
void TileRenderer<Real>::write_rays(const kernels::TileView& tile) {
  if (planes_.depth) write_plane(tile, grid_.crop, planes_.depth, batch_.t.data());
  if (planes_.status) write_plane(tile, grid_.crop, planes_.status, batch_.status.data());
  if (planes_.steps) write_plane(tile, grid_.crop, planes_.steps, steps_.data());
}

/// Values of pixels where no surface is; surfaces overwrite them.
template <class Real>
void TileRenderer<Real>::clear(const kernels::TileView& tile) {
  const Planes<Real>& p = planes_;
  for_each_run(tile, grid_.crop, [&](std::size_t pixel, std::size_t, std::size_t count) {
    if (p.position) std::fill_n(p.position + 3 * pixel, 3 * count, Real(0));
    if (p.normal) std::fill_n(p.normal + 3 * pixel, 3 * count, Real(0));
    if (p.object_id) std::fill_n(p.object_id + pixel, count, -1);
    if (p.material_id) std::fill_n(p.material_id + pixel, count, -1);
  });
}

template <class Real>
void TileRenderer<Real>::write_surfaces(const kernels::TileView& tile) {
  const auto& p = planes_;
  const SurfacePass<Real>& s = *surface_;
  for (std::size_t i = 0; i < s.count(); ++i) {
    const std::size_t pixel = index_in(grid_.crop, pixel_of(tile, s.ray(i)));
    if (p.position) store(p.position, pixel, s.position.x[i], s.position.y[i], s.position.z[i]);
    if (p.normal) store(p.normal, pixel, s.normal.x[i], s.normal.y[i], s.normal.z[i]);
    if (p.object_id) p.object_id[pixel] = s.object(i);
    if (p.material_id) {
      p.material_id[pixel] = picture_.program->attributes().objects[static_cast<std::size_t>(s.object(i))].material;
    }
  }
}

template <class Real>
void TileRenderer<Real>::write_color(const kernels::TileView& tile) {
  VectorBuffer<Real>& color = radiance_->color;
  kernels_.clamp_colors(color.view(), rays_);  // sums beyond all numbers
  for_each_run(tile, grid_.crop, [&](std::size_t pixel, std::size_t ray, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      store(planes_.color, pixel + i, color.x[ray + i], color.y[ray + i], color.z[ray + i]);
    }
  });
}

/// Adds what the colour plane holds to the sum over samples; the last leaves their mean there.
template <class Real>
void TileRenderer<Real>::add_sample(const kernels::TileView& tile, std::size_t sample) {
  const auto count = static_cast<double>(samples_.size());
  for_each_run(tile, grid_.crop, [&](std::size_t first_pixel, std::size_t first_ray, std::size_t pixels) {
    for (std::size_t i = 0; i < 3 * pixels; ++i) {
      Real& color = wanted_.color[3 * first_pixel + i];
      double& sum = sum_[3 * first_ray + i];
      sum = sample == 0 ? static_cast<double>(color) : sum + static_cast<double>(color);
      if (sample + 1 == samples_.size()) color = static_cast<Real>(sum / count);
    }
  });
}

template class TileRenderer<float>;
template class TileRenderer<double>;

}  // namespace octomarch
