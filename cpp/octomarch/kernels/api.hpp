// What the rest of the program may ask of the kernels: plain data in, plain data out, one table of functions per ISA
// and precision. No class with code crosses this border, since code compiled for one ISA must not reach another.
//
// Arrays are structures of arrays, one number per ray or point. Unless a function says otherwise they are aligned to
// kAlignment and their allocation reaches to a whole number of blocks (padded_lanes), of which lanes past `count` may
// be read and overwritten, but never affect the lanes before.
#pragma once

#include <cstddef>
#include <cstdint>

#include "octomarch/kernels/block.hpp"
#include "octomarch/program/instruction.hpp"

namespace octomarch::kernels {

constexpr std::size_t padded_lanes(std::size_t count) { return (count + kLanes - 1) / kLanes * kLanes; }

/// Texels of an image: RGB after RGB, row 0 at the top.
struct ImageView {
  const float* texels;
  std::uint32_t width;
  std::uint32_t height;
};

/// A tape as kernels see it. Its register file has kLanes numbers per register, aligned; gradients need one four times as
/// large, marches two files and kMarchRows rows more, in one piece.
template <class Real>
struct TapeView {
  const Instruction* code;
  std::size_t length;
  const Real* constants;
  std::uint32_t registers;
  std::uint16_t result;
  const ImageView* images;
};

/// One input of a ray: an array (any alignment, exactly `count` long), or one value for all.
template <class Real>
struct Column {
  const Real* values = nullptr;
  Real value = 0;
};

template <class Real>
struct Vectors {
  Real* x;
  Real* y;
  Real* z;
};

/// Rays o + t·d, d of unit length, searched on [t_min, t_max]; eps(t) = max(epsilon, slope·t). A ray whose origin or
/// direction holds a NaN or an infinity is invalid; callers make directions without a length NaN.
template <class Real>
struct RayView {
  Column<Real> ox, oy, oz;
  Column<Real> dx, dy, dz;
  Column<Real> t_max;    ///< finite
  Column<Real> epsilon;  ///< absolute part of the hit epsilon
  std::size_t count;
};

/// How rays are stepped.
enum class Stepping : std::uint8_t {
  kPlain,   ///< from t = 0 by the whole field
  kBiased,  ///< from t_min by the field less a bias
  kFixed,   ///< from t_min by the field less a bias, but `step` and the hit epsilon at the least, into the solid
};

template <class Real>
struct MarchParameters {
  Real step_scale;     ///< 1 / Lipschitz bound
  Real epsilon_slope;  ///< growth of the hit epsilon with t
  int max_steps;
  bool finish;            ///< refine hits: by the secant, for kFixed by bisection
  const bool* cancelled;  ///< polled at every block step; a cancelled kernel returns early with partial output
  Stepping stepping;
  Real t_min;  ///< 0 for kPlain
  Real bias;   ///< 0 for kPlain
  Real step;   ///< for kFixed
};

/// Work done, for image.stats: exact counts.
struct Counters {
  std::uint64_t evaluations = 0;  ///< of the field, at live lanes
  std::uint64_t lane_slots = 0;   ///< lanes that were computed for them, live or not
  std::uint64_t packets = 0;      ///< packets that were loaded
};

template <class Real>
struct MarchOutput {
  Real* t;               ///< see Status; +inf for misses and invalid rays. Any alignment, exactly `count` long
  Real* unfinished;      ///< scratch for the finish, `count` long; may be null without it
  std::uint8_t* status;  ///< octomarch::Status; null when not wanted
  std::int32_t* steps;   ///< evaluations of each ray; null when not wanted
};

/// A pinhole or parallel camera: pixel (i, j) looks along, or from, corner + (i + point₀)·right + (j + point₁)·down.
template <class Real>
struct CameraView {
  bool perspective;  ///< true: the sum is the direction (to be normalised); false: the origin
  Real corner[3];
  Real right[3];
  Real down[3];
  Real point[2];  ///< in the pixel, from its upper left corner; (½, ½) is its centre
};

/// A rectangle of pixels, in packets of kPacketWidth × kPacketHeight, row by row: ray (packet·8 + lane) is pixel
/// (x + lane % 4, y + lane / 4) of its packet. Rays of pixels outside width × height are NaN.
struct TileView {
  std::uint32_t x, y;  ///< first pixel, in the planes
  std::uint32_t packets_across, packets_down;
  std::uint32_t width, height;  ///< of the planes
  std::uint32_t left, top;      ///< where the planes begin in the whole picture
};

/// Where the field is sampled around a point: at point + step·offset for each offset. The direction found is the sum of
/// the offsets, each times the field there, or where `counted`, times −1 where that is negative and else 0.
template <class Real>
struct StencilView {
  const Real* offsets;  ///< x y z after x y z
  std::size_t count;
  Real step;
  bool counted;
};

/// Surface points to be shaded, with what the kernels fill in.
template <class Real>
struct SurfaceView {
  std::size_t count;
  Vectors<Real> position;
  Vectors<Real> direction;  ///< of the ray that found the point, unit
  Vectors<Real> normal;     ///< unit, outward
  Vectors<Real> facing;     ///< the normal to shade with: never away from the ray
  Vectors<Real> origin;     ///< position moved off the surface along it
  Real* epsilon;            ///< hit epsilon at the point
};

template <class Real>
struct LightView {
  bool directional;
  Real vector[3];  ///< directional: unit vector to the light; else: position
  Real color[3];
  int decay;
  Real max_distance;  ///< directional: how far occluders are searched
  bool spot;
  Real axis[3];       ///< spot: unit direction in which its middle shines
  Real outer_cosine;  ///< spot: none below
  Real cone_scale;    ///< spot: 1 / (inner cosine − outer cosine)
};

/// One light's part at every point: unit vector to it, distance, cosine to the normal, and how strong it is there.
template <class Real>
struct LightSamples {
  Vectors<Real> toward;
  Real* distance;
  Real* cosine;
  Real* strength;    ///< fall with the distance, times what a spot's cone lets out
  Real* visibility;  ///< 0 … 1; read by add_light
};

/// What every point is made of: the slots of a Material, and what follows from them.
template <class Real>
struct MaterialView {
  Vectors<Real> albedo;
  Real* roughness;
  Real* specular;
  Real* metallic;
  Real* reflectivity;
  Real* exponent;  ///< Phong's; filled by clamp_materials
};

template <class Real>
struct KernelTable {
  void (*camera_rays)(const CameraView<Real>&, const TileView&, const Vectors<Real>& out);
  /// Marches any number of rays in refilled blocks.
  void (*march)(const TapeView<Real>&, Real* memory, const RayView<Real>&, const MarchParameters<Real>&,
                const MarchOutput<Real>&, Counters&);
  /// Visibility of each ray's far end: 0 where something is hit, else min over samples of k·r/t, at most 1
  /// (k = +inf: hard shadows). `visibility`: exactly `count` long. Nothing is finished.
  void (*shadow)(const TapeView<Real>&, Real* memory, const RayView<Real>&, const MarchParameters<Real>&, Real k,
                 Real* visibility, Counters&);
  /// The tape's result at points; NaN at NaN points. This and the next two poll `cancelled` at every block.
  void (*distance)(const TapeView<Real>&, Real* registers, const Vectors<const Real>& points, std::size_t count,
                   const bool* cancelled, Real* out);
  /// Several results of a tape at points: outs[i] gets that of register results[i]. `normals`: inputs 3, 4, 5 of tapes that
  /// have them, else null.
  void (*expressions)(const TapeView<Real>&, Real* registers, const Vectors<const Real>& points,
                      const Vectors<const Real>* normals, std::size_t count, const bool* cancelled,
                      const std::uint16_t* results, std::size_t result_count, Real* const* outs);
  /// The exact gradient at points; the register file is four times as large.
  void (*gradient)(const TapeView<Real>&, Real* registers, const Vectors<const Real>& points, std::size_t count,
                   const bool* cancelled, const Vectors<Real>& out);
  /// A direction across the surface from the field around each point, by differences or by counting. Its length means
  /// nothing.
  void (*sample_around)(const TapeView<Real>&, Real* registers, const Vectors<const Real>& points, std::size_t count,
                        const StencilView<Real>&, const bool* cancelled, const Vectors<Real>& out);
  /// Gradients in surface.normal become unit normals, −direction where there is none.
  void (*normalize)(const SurfaceView<Real>&);
  /// Fills facing and origin = position + 2·epsilon·facing. A normal that faces away, where a ray grazes an edge
  /// within the hit epsilon, is turned until it is square to the ray.
  void (*face_rays)(const SurfaceView<Real>&);
  /// Ambient visibility from `samples` points along the normal, up to `distance` away. `cancelled` is polled at each.
  void (*occlusion)(const TapeView<Real>&, Real* registers, const SurfaceView<Real>&, int samples, Real distance,
                    const bool* cancelled, Real* out);
  /// Brings slots into their ranges: albedo ≥ 0, the others 0 … 1, NaN to 0. Fills exponent.
  void (*clamp_materials)(const MaterialView<Real>&, std::size_t count);
  /// Colours ≥ 0, NaN to 0.
  void (*clamp_colors)(const Vectors<Real>&, std::size_t count);
  /// Rays that leave each point like light that is mirrored there: direction d − 2(d·n)n, n the facing normal; origin
  /// max(offset, 2·epsilon) above the point.
  void (*mirror_rays)(const SurfaceView<Real>&, Real offset, const Vectors<Real>& origin,
                      const Vectors<Real>& direction);
  void (*light_samples)(const SurfaceView<Real>&, const LightView<Real>&, const LightSamples<Real>&);
  /// color += visibility·strength·irradiance·(Lambert + Phong), where the surface faces the light.
  void (*add_light)(const SurfaceView<Real>&, const LightView<Real>&, const LightSamples<Real>&,
                    const MaterialView<Real>&, const Vectors<Real>& color);
};

}  // namespace octomarch::kernels
