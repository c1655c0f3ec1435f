#include "octomarch/render/tile.hpp"

#include <array>

#include "octomarch/render/tile_pixels.hpp"

namespace octomarch {

static_assert(TileGrid::rays() <= Way::kMost);

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
TileRenderer<Real>::TileRenderer(const Picture& picture, const SharedField<Real>& field, const Expressions& sky,
                                 const Planes<Real>& planes, const kernels::KernelTable<Real>& kernels,
                                 const TileGrid& grid)
    : picture_(picture),
      wanted_(planes),
      samples_(sample_points(picture.samples)),
      planes_(planes),
      kernels_(kernels),
      grid_(grid),
      frame_(frame(picture.camera, picture.width, picture.height)),
      lead_(lead_of(frame_, picture.program->site(), picture.march.min_distance)),
      batch_(kernels::padded_lanes(grid.rays())),
      epsilon_(lead_ > 0.0 ? batch_.t.size() : 0),
      steps_(batch_.t.size()),
      field_(field, kernels, grid.rays()) {
  if (needs_surface()) surface_.emplace(field_, kernels, batch_.t.size());
  if (planes.color) radiance_.emplace(picture, sky, kernels, batch_.t.size());
  if (planes.color && samples_.size() > 1) sum_ = Buffer<double>(3 * batch_.t.size());
  set_columns();
}

/// Columns of rays that share an origin or a direction, or, where they are moved along, have both to themselves.
template <class Real>
void TileRenderer<Real>::set_columns() {
  const bool is_moved = lead_ > 0.0;
  const auto columns = [](const VectorBuffer<Real>& rows, const Vec3& all, bool is_one) {
    const auto column = [is_one](const Buffer<Real>& values, double value) {
      return is_one ? kernels::Column<Real>{nullptr, static_cast<Real>(value)}
                    : kernels::Column<Real>{values.data(), 0};
    };
    return std::array{column(rows.x, all.x), column(rows.y, all.y), column(rows.z, all.z)};
  };
  const Vec3& fixed = frame_.fixed;
  const bool one_origin = frame_.one_origin();
  const auto [ox, oy, oz] = columns(batch_.origin, fixed, one_origin && !is_moved);
  const auto [dx, dy, dz] = columns(batch_.direction, fixed, !one_origin);

  // hit epsilon: absolute, rounding error and pixel footprint (see March)
  const auto reach = [&](double Vec3::* axis) {
    if (one_origin) return std::fabs(fixed.*axis);
    return std::fabs(frame_.corner.*axis) + std::fabs(frame_.right.*axis) * picture_.width +
           std::fabs(frame_.down.*axis) * picture_.height;
  };
  const double farthest =
      std::max({reach(&Vec3::x), reach(&Vec3::y), reach(&Vec3::z), picture_.program->site().inner_offset});
  const double floor = static_cast<double>(kUlpFloor<Real>);
  const double tolerance = picture_.march.pixel_tolerance;
  const double least = std::max({picture_.march.least_epsilon(), floor * farthest, tolerance * frame_.pixel_radius});
  const kernels::Column<Real> epsilon{is_moved ? epsilon_.data() : nullptr, clamped<Real>(least)};
  columns_ = {ox, oy, oz, dx, dy, dz, epsilon, clamped<Real>(std::max(floor, tolerance * frame_.pixel_slope))};
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
  {
    const ScopedTimer timer(stats_.seconds_march);
    cast(tile, point);
    march(tile, cancelled);
  }
  if (is_set(cancelled)) return;
  {
    const ScopedTimer timer(stats_.seconds_shade);
    shade(tile, cancelled);
  }
  if (!planes_.color || is_set(cancelled)) return;
  const ScopedTimer timer(stats_.seconds_reflect);
  radiance_->follow_mirrors(*surface_, cancelled, stats_);
  write_color(tile);
}

/// Writes what is known of camera rays, and finds out about the surfaces that they met what the planes want.
template <class Real>
void TileRenderer<Real>::shade(const kernels::TileView& tile, const bool& cancelled) {
  write_rays(tile);
  if (needs_points()) clear(tile);
  if (needs_surface()) {
    surface_->gather(batch_, columns_, rays_);
    const bool lit = planes_.color && (radiance_->needs_normals() || surface_->has_candidates());
    if (lit || planes_.normal) surface_->find_normals(picture_.shading, cancelled, stats_.normals);
    if (planes_.object_id || planes_.material_id) surface_->find_objects(cancelled, stats_.objects);
    if (needs_points()) write_surfaces(tile);
  }
  if (planes_.color) radiance_->light(batch_, columns_, rays_, *surface_, cancelled, stats_);
}

/// Rays through one point of each pixel of a tile.
template <class Real>
void TileRenderer<Real>::cast(const kernels::TileView& tile, const PixelPoint& point) {
  rays_ = tile.rays();
  if (lead_ > 0.0) {
    leading_rays(frame_, tile, point, lead_, batch_.origin, batch_.direction);
    const double pixel = picture_.march.pixel_tolerance * (frame_.pixel_radius + frame_.pixel_slope * lead_);
    set_epsilons(picture_.march, picture_.program->site(), pixel, batch_.origin, rays_, epsilon_);
  } else if (frame_.kind == CameraKind::kPanoramic) {
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
  stats_.primary.count += kept;
  for (std::size_t ray = 0; kept < rays_ && ray < rays_; ++ray) {
    if (!contains(grid_.crop, pixel_of(tile, ray))) component[ray] = std::numeric_limits<Real>::quiet_NaN();
  }
}

template <class Real>
void TileRenderer<Real>::march(const kernels::TileView& tile, const bool& cancelled) {
  const kernels::Column<Real> t_max{nullptr, clamped<Real>(picture_.march.max_distance - lead_)};
  const kernels::MarchParameters<Real> parameters =
      march_parameters(*picture_.program, picture_.march, columns_.epsilon_slope, cancelled);
  kernels::Column<Real> start{nullptr, parameters.t_min};
  if (lead_ > 0.0) start.value = clamped<Real>(picture_.march.min_distance + picture_.program->site().radius);
  const kernels::RayView<Real> rays = columns_.view(start, t_max, rays_);
  const bool together = picture_.march.method == Method::kAuto;
  if (together) {
    const ScopedTimer timer(stats_.cones.seconds);
    field_.advance_together(rays, parameters, batch_, stats_.cones);
  }
  const ScopedTimer timer(stats_.primary.seconds);
  keep_rays_of_crop(tile);
  field_.march(rays, parameters, batch_, planes_.steps ? steps_.data() : nullptr, stats_.primary, together);
}

template <class Real>
void TileRenderer<Real>::write_rays(const kernels::TileView& tile) {
  if (planes_.depth && lead_ > 0.0) {
    for_each_run(tile, grid_.crop, [&](std::size_t pixel, std::size_t ray, std::size_t count) {
      for (std::size_t i = 0; i < count; ++i) planes_.depth[pixel + i] = from_far(lead_, batch_.t[ray + i]);
    });
  } else if (planes_.depth) {
    write_plane(tile, grid_.crop, planes_.depth, batch_.t.data());
  }
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
  const Vec3& anchor = picture_.program->site().anchor;
  for (std::size_t i = 0; i < s.count(); ++i) {
    const std::size_t pixel = index_in(grid_.crop, pixel_of(tile, s.ray(i)));
    if (p.position) {
      store(p.position, pixel, from_far(anchor.x, s.position.x[i]), from_far(anchor.y, s.position.y[i]),
            from_far(anchor.z, s.position.z[i]));
    }
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
