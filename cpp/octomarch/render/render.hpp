// Rendering: a program, a scene, a camera and settings become the planes that were asked for, tile by tile over all
// cores. Compilation comes before; the bindings hand the planes to numpy.
#pragma once

#include <cstdint>

#include "octomarch/base/parallel.hpp"
#include "octomarch/graph/scene.hpp"
#include "octomarch/kernels/dispatch.hpp"
#include "octomarch/program/program.hpp"
#include "octomarch/render/stages.hpp"

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

/// Seconds are summed over the workers.
struct RenderStats {
  StageStats cones;              ///< about blocks of camera rays
  StageStats primary;            ///< camera rays, of pixels that are in the crop
  StageStats normals;            ///< of what camera and mirror rays met
  StageStats objects;            ///< object ids
  StageStats materials;          ///< that differ from point to point
  StageStats occlusion;          ///< samples along normals
  StageStats shadow;             ///< rays to lights
  StageStats reflection;         ///< mirror rays
  StageStats sky;                ///< where it differs from direction to direction
  std::uint64_t cell_bytes = 0;  ///< of memory that the octrees' cells take
  double seconds_march = 0.0;
  double seconds_shade = 0.0;    ///< of what camera rays found
  double seconds_reflect = 0.0;  ///< marching and shading of mirror rays
};

struct NamedStage {
  const char* name;
  StageStats RenderStats::* stats;
};

/// In the order in which a picture has them.
inline constexpr NamedStage kStages[] = {
    {"cones", &RenderStats::cones},
    {"primary", &RenderStats::primary},
    {"normals", &RenderStats::normals},
    {"objects", &RenderStats::objects},
    {"materials", &RenderStats::materials},
    {"occlusion", &RenderStats::occlusion},
    {"shadow", &RenderStats::shadow},
    {"reflection", &RenderStats::reflection},
    {"sky", &RenderStats::sky},
};

/// Contract: width, height ≥ 1; the crop lies within them and is not empty; planes are as large as it. Throws what the listener throws.
template <class Real>
RenderStats render(const Picture& picture, const Planes<Real>& planes, const kernels::Isa& isa, unsigned threads,
                   const Listener& listener);

}  // namespace octomarch
