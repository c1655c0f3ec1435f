// Whole pictures by the reference, pixel after pixel, without GLM in its face. Shading comes before it; the bindings come
// after.
#pragma once

#include <cstdint>
#include <span>

#include "octomarch/graph/node.hpp"
#include "octomarch/graph/scene.hpp"
#include "octomarch/reference/compiled.hpp"
#include "octomarch/reference/poll.hpp"

namespace octomarch::reference {

/// Where the planes of a picture go, width × height of the crop, row 0 at the top, pixels of a row from the left. An empty span is a plane that
/// nobody wants.
template <class T>
struct Planes {
  std::span<T> color;     ///< height × width × 3, linear RGB
  std::span<T> depth;     ///< height × width, +inf where the ray hit nothing
  std::span<T> position;  ///< height × width × 3
  std::span<T> normal;    ///< height × width × 3
  std::span<std::int32_t> material_id;
  std::span<std::int32_t> steps;
  std::span<std::uint8_t> status;
};

/// How large a picture is, what of it the planes hold, and how many samples its colours take.
struct Extent {
  std::uint32_t width;
  std::uint32_t height;
  Crop crop;
  int samples;
};

/// Renders `root` under `scene` in T = float or double.
template <class T>
void render(const NodePtr& root, const Scene& scene, const Camera& camera, const March& march, const Shading& shading,
            const Extent& extent, const Compiled& compiled, const Planes<T>& planes, const Poll& poll);

}  // namespace octomarch::reference
