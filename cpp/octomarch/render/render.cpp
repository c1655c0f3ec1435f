#include "octomarch/render/render.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <vector>

#include "octomarch/render/tile.hpp"

namespace octomarch {

namespace {

void add_all(RenderStats& sum, const RenderStats& part) {
  for (const NamedStage& stage : kStages) sum.*stage.stats += part.*stage.stats;
  sum.seconds_march += part.seconds_march;
  sum.seconds_shade += part.seconds_shade;
  sum.seconds_reflect += part.seconds_reflect;
}

/// A picture with everything in it counted from its program's anchor.
struct Anchored {
  /// `rounding`: the relative part of the hit epsilon.
  Anchored(const Picture& whole, double rounding)
      : anchor(anchor_seen_from(whole.program->site(), whole.camera.eye, rounding, whole.march.least_epsilon())),
        scene(counted_from(anchor, *whole.scene)),
        picture(whole) {
    if (!(anchor == whole.program->site().anchor)) picture.program = &program.emplace(whole.program->root(), anchor);
    picture.scene = &scene;
    picture.camera = counted_from(anchor, whole.camera);
  }
  Anchored(const Anchored&) = delete;
  Anchored& operator=(const Anchored&) = delete;

  Vec3 anchor;
  std::optional<Program> program;  ///< where the picture's own has another anchor
  Scene scene;
  Picture picture;
};

}  // namespace

template <class Real>
RenderStats render(const Picture& whole, const Planes<Real>& planes, const kernels::Isa& isa, unsigned threads,
                   const Listener& listener) {
  const Anchored anchored(whole, static_cast<double>(kUlpFloor<Real>));
  const Picture& picture = anchored.picture;
  const TileGrid grid(picture);
  const Expressions sky = planes.color ? compile_expressions(picture.scene->sky.color) : Expressions{};
  // mirror and shadow rays go as far from what camera rays have met
  const SharedField<Real> field = share_field<Real>(*picture.program, picture.march, true);
  const unsigned workers = thread_count(threads);
  std::vector<std::unique_ptr<TileRenderer<Real>>> renderers(std::min<std::size_t>(workers, grid.count()));
  parallel_for(
      grid.count(), workers,
      [&](std::size_t tile, std::size_t worker, const bool& cancelled) {
        auto& renderer = renderers[worker];
        if (!renderer) {
          renderer = std::make_unique<TileRenderer<Real>>(picture, field, sky, planes, isa.table<Real>(), grid);
        }
        renderer->render(tile, cancelled);
      },
      listener);
  RenderStats stats;
  for (const auto& renderer : renderers) {
    if (renderer) add_all(stats, renderer->stats());
  }
  if (field.octree) stats.cell_bytes += picture.program->octrees().template bytes<Real>();
  if (field.rest_octree) stats.cell_bytes += field.split->rest->octrees().template bytes<Real>();
  return stats;
}

template RenderStats render<float>(const Picture&, const Planes<float>&, const kernels::Isa&, unsigned,
                                   const Listener&);
template RenderStats render<double>(const Picture&, const Planes<double>&, const kernels::Isa&, unsigned,
                                    const Listener&);

}  // namespace octomarch
