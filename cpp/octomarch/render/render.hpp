// Rendering: a program, a scene, a camera and settings become the planes that were asked for, tile by tile over all
// cores. Compilation comes before; the bindings hand the planes to numpy.
#pragma once

#include <cstdint>

#include "octomarch/base/parallel.hpp"
#include "octomarch/graph/scene.hpp"
#include "octomarch/kernels/dispatch.hpp"
#include "octomarch/program/program.hpp"

namespace octomarch {

/// Where each plane goes, width × height of the crop, row 0 at the top; null for a plane that is not wanted and will not be computed.
template <class Real>
struct Planes {
  Real* color = nullptr;     ///< (height, width, 3), linear
  Real* depth = nullptr;     ///< t along the unit direction; +inf on a miss
  Real* position = nullptr;  ///< (height, width, 3)
  Real* normal = nullptr;    ///< (height, width, 3)
  std::int32_t* object_id = nullptr;
  std::int32_t* material_id = nullptr;
  std::int32_t* steps = nullptr;
  std::uint8_t* status = nullptr;

  friend bool operator==(const Planes&, const Planes&) = default;
};

struct Picture {
  const Program* program;
  const Scene* scene;
  Camera camera;
  March march;
  Shading shading;
  std::uint32_t width;  ///< of the whole picture
  std::uint32_t height;
  Crop crop;    ///< what the planes hold of it
  int samples;  ///< of each pixel's colour, ≥ 1; other planes are of its centre
};

inline void add(kernels::Counters& sum, const kernels::Counters& part) {
  sum.evaluations += part.evaluations;
  sum.lane_slots += part.lane_slots;
  sum.instructions += part.instructions;
  sum.packets += part.packets;
}

/// Exact counts of the work, and seconds summed over the workers.
struct RenderStats {
  std::uint64_t rays = 0;   ///< primary ones
  kernels::Counters cones;  ///< marched for the primary ones
  kernels::Counters primary;
  kernels::Counters shadow;
  kernels::Counters reflection;
  std::uint64_t shadow_rays = 0;
  std::uint64_t reflection_rays = 0;
  std::uint64_t gradient_evaluations = 0;
  std::uint64_t occlusion_evaluations = 0;
  std::uint64_t attribute_evaluations = 0;  ///< of object ids
  std::uint64_t surface_evaluations = 0;    ///< of materials that differ from point to point
  std::uint64_t sky_evaluations = 0;        ///< of a sky that differs from direction to direction
  std::uint64_t cells = 0;                  ///< of the octree that were made
  std::uint64_t cell_bytes = 0;             ///< of memory that they take
  double seconds_march = 0.0;
  double seconds_shade = 0.0;    ///< of what camera rays found
  double seconds_reflect = 0.0;  ///< marching and shading of mirror rays
};

/// Contract: width, height ≥ 1; the crop lies within them and is not empty; planes are as large as it. Throws what the listener throws.
template <class Real>
RenderStats render(const Picture& picture, const Planes<Real>& planes, const kernels::Isa& isa, unsigned threads,
                   const Listener& listener);

}  // namespace octomarch
