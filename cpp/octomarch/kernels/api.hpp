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
#include "octomarch/program/ball_node.hpp"
#include "octomarch/program/choices.hpp"
#include "octomarch/program/instruction.hpp"
#include "octomarch/program/region.hpp"

namespace octomarch::kernels {

constexpr std::size_t packets_of(std::size_t count) { return (count + kPacketLanes - 1) / kPacketLanes; }
constexpr std::size_t padded_lanes(std::size_t count) { return (count + kLanes - 1) / kLanes * kLanes; }

/// Lanes of a batch of the widest instruction set.
inline constexpr std::size_t kWidestBatch = kAlignment / sizeof(float);
constexpr std::size_t padded_batches(std::size_t count) {
  return (count + kWidestBatch - 1) / kWidestBatch * kWidestBatch;
}

/// Texels of an image, RGB after RGB, row 0 at the top; or samples of a grid, width × height × depth along x, y and z, the
/// last changing fastest.
struct ImageView {
  const float* texels;
  std::uint32_t width;
  std::uint32_t height;
  std::uint32_t depth;
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
  const AxisStep* axes = nullptr;  ///< for gradients, see axis_steps(); where null, all derivatives are computed with
};

/// One input of a ray: an array, or one value for all.
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

/// Rays o + t·d, d of unit length, searched on [start, t_max]; eps(t) = max(epsilon, slope·t). A ray whose origin or
/// direction holds a NaN or an infinity is invalid; callers make directions without a length NaN.
template <class Real>
struct RayView {
  Column<Real> ox, oy, oz;
  Column<Real> dx, dy, dz;
  Column<Real> start;    ///< t of the first sample, ≥ 0
  Column<Real> t_max;    ///< finite
  Column<Real> epsilon;  ///< absolute part of the hit epsilon
  std::size_t count;

  /// `number` rays from the i-th on.
  RayView from(std::size_t i, std::size_t number) const {
    const auto moved = [i](const Column<Real>& column) {
      return Column<Real>{column.values == nullptr ? nullptr : column.values + i, column.value};
    };
    return {moved(ox), moved(oy),    moved(oz),    moved(dx),      moved(dy),
            moved(dz), moved(start), moved(t_max), moved(epsilon), number};
  }
};

/// How rays are stepped.
enum class Stepping : std::uint8_t {
  kPlain,      ///< by the whole field
  kBiased,     ///< by the field less a bias
  kRelaxed,    ///< by 1.6 times the field until that was too much, and the ray had to go back
  kEnhanced,   ///< by what the field's slope along the ray lets hope, and back where that was too much
  kShadow,     ///< the same for shadow rays, but by the whole field in and near penumbras
  kFixed,      ///< by the field less a bias, but `step` and the hit epsilon at the least, into the solid
  kCertified,  ///< as kEnhanced, by what the field proves in spite of its roundings; see CertifiedSteps
  kCone,       ///< by the field less a cone's width, the ray being its axis; see ConeSteps
};

template <class Real>
struct MarchParameters {
  Real step_scale;     ///< 1 / Lipschitz bound
  Real epsilon_slope;  ///< growth of the hit epsilon with t
  int max_steps;
  bool finish;            ///< refine hits: by the secant, for kFixed by bisection
  const bool* cancelled;  ///< polled at every block step; a cancelled kernel returns early with partial output
  Stepping stepping;
  Real t_min;  ///< a ray that has arrived there is inside
  Real bias;   ///< for kBiased and kFixed
  Real step;   ///< for kFixed
  Real k;      ///< of soft shadows, for shadow rays: the visibility is the least of k·r/t and 1; +inf for hard ones
  Real doubt;  ///< for kCertified, with the next: the field over its Lipschitz bound is off by no more than
  Real doubt_slope;  ///< doubt + doubt_slope·(|o|∞ + t), the place of its sample included, where the sum is at most
  Real doubt_reach;  ///< doubt_reach; what lies beyond is not known
};

/// The bracket of a certified hit in doubts, at the least.
inline constexpr int kDoubtsOfBracket = 16;

/// Work done, for image.stats: exact counts.
struct Counters {
  std::uint64_t evaluations = 0;   ///< of the field, at live lanes
  std::uint64_t lane_slots = 0;    ///< lanes that were computed for them, live or not; alone, for the longest part
  std::uint64_t packets = 0;       ///< packets that were loaded; eight rays that go alone count as one
  std::uint64_t refills = 0;       ///< those of them that took the slot of one that had ended
  std::uint64_t instructions = 0;  ///< at those lanes; counted by whoever knows how long the tape is

  Counters& operator+=(const Counters& part) {
    evaluations += part.evaluations;
    lane_slots += part.lane_slots;
    packets += part.packets;
    refills += part.refills;
    instructions += part.instructions;
    return *this;
  }
};

/// What stopped a ray that is being marched.
enum class Pause : std::uint8_t {
  kEnded,  ///< it has arrived at t ≤ t_max, or is past t_max, or t is NaN
  kLeft,   ///< its next sample, at t, is outside of the region
  kSpent,  ///< its steps
};

/// What r of the sample before the first and the step from it are set to: any sphere touches that one, and the slope from it
/// is −1.
template <class Real>
inline constexpr Real kNothingBefore = Real(1e30);

/// Rays in the course of a march, one element a ray: begin_march fills it, march goes on with it, conclude reads it.
template <class Real>
struct MarchState {
  Real* t;         ///< of the next sample, or of the last
  Real* radius;    ///< the field at the last sample
  Real* before;    ///< what the task carries: r of the sample before, or its t, or a visibility; see CertifiedSteps too
  Real* stride;    ///< the last step; for relaxed steps only, as the next
  Real* boldness;  ///< see LongSteps
  std::uint8_t* pause;  ///< Pause
  std::int32_t* steps;  ///< evaluations of each ray, exactly `count` long, any alignment; null when not wanted
};

/// What operands of a chain (program/chain.hpp) are alike in, as kernels see it.
template <class Real>
struct KindView {
  const Instruction* body;
  std::size_t length;
  Instruction combine;
  const Real* combine_constants;
};

/// A chain as kernels see it.
template <class Real>
struct ChainView {
  const KindView<Real>* kinds;
  std::size_t kind_count;
  std::size_t columns;   ///< of each operand: see Chain::columns()
  std::size_t taken_up;  ///< the register of what has been taken up
};

/// Up to kLanes rays, each with the operands that decide in a region of its own: rows of kLanes.
template <class Real>
struct ChainBlock {
  Vectors<Real> origin, direction;
  Real* t_max;
  Real* epsilon;
  Real* t;  ///< this and the next three as in MarchState
  Real* before;
  Real* stride;
  Real* boldness;
  Vectors<Real> lo, hi;  ///< of each ray's region
  Real* operands;        ///< how many there are in it, at least one
  Real* columns;      ///< of the first of them, row by row, then of the second …; behind the last, kNoKind for its kind
  Real* registers;    ///< of the chain; the first three hold the rays' next samples
  std::size_t lanes;  ///< in use, the first ones
};

/// Of operands that a lane has not.
template <class Real>
inline constexpr Real kNoKind = Real(-1);

/// Which rays of a block go on in their regions, and which left them: their next samples are outside.
struct ChainStep {
  std::uint64_t live;
  std::uint64_t left;
};

/// Cones about neighbouring rays: points o + t·d, from which none of its rays is farther than width + t·spread.
template <class Real>
struct ConeView {
  Vectors<Real> origin;
  Vectors<Real> direction;
  Real* width;
  Real* spread;
  Real* epsilon;  ///< the largest of the rays'
  Real* t_max;    ///< likewise
};

/// Rays whose hit epsilon grows with t by more than this may be within it of a ball wherever they are.
template <class Real>
inline constexpr Real kSteepestOfBalls = Real(0.5);

/// A tree of balls, see BallTree.
template <class Real>
struct BallsView {
  const BallNode<Real>* nodes;
  const BallLeaf<Real>* leaves;
  Real blend;
  Real trusted_epsilon;
};

/// Half-spaces: the distance is x·e₀ + y·e₁ + z·e₂ + e₃, e₀ … e₂ being a unit normal.
template <class Real>
struct PlanesView {
  const Real* equations;  ///< four numbers after four numbers
  std::size_t count;
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

/// A rectangle of pixels in blocks of kBlockEdge × kBlockEdge, row by row, each block in packets, each packet in pixels
/// likewise. Rays of pixels outside of the picture are NaN.
struct TileView {
  std::uint32_t x, y;  ///< first pixel; multiples of kBlockEdge
  std::uint32_t blocks_across, blocks_down;
  std::uint32_t width, height;  ///< of the picture

  std::size_t rays() const { return std::size_t{blocks_across} * blocks_down * kLanes; }
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
  /// Puts a cone about each block of kLanes rays. Rays that are NaN count for nothing; without any a cone is NaN.
  void (*fit_cones)(const RayView<Real>&, const ConeView<Real>&);
  /// The same for each 4×4 and each 2×2 pixels of one block of camera rays, its kSmallCones and kSmallestCones.
  void (*fit_small_cones)(const RayView<Real>&, std::size_t block, const ConeView<Real>& small,
                          const ConeView<Real>& smallest);
  /// Where each ray of a block, about which a cone has been put, comes within reach of the first ball; `end` is set to −1 where it
  /// never does. Both are those of the block. epsilon_slope < kSteepestOfBalls.
  void (*enter_balls)(const BallsView<Real>&, const RayView<Real>&, std::size_t block, const ConeView<Real>&,
                      Real epsilon_slope, Real* start, Real* end);
  /// `met`: the t at which each ray enters the first of the planes: t_min where it begins within the hit epsilon of one, +∞
  /// where it enters none. `end`: the lesser of that and its t_max. rays.start is not read.
  void (*meet_planes)(const PlanesView<Real>&, const RayView<Real>&, const MarchParameters<Real>&, Real* met,
                      Real* end);
  /// Misses that have met a plane by their t_max become hits there. rays.start is not read.
  void (*take_planes)(const RayView<Real>&, const MarchParameters<Real>&, const Real* met, const MarchState<Real>&,
                      std::uint8_t* status);
  /// Lessens what shadow rays let through by what the planes do: the distance over t is the least at the far end.
  void (*dim_by_planes)(const PlanesView<Real>&, const RayView<Real>&, const MarchParameters<Real>&, Real* visibility);
  /// Where rays are within 4 hit epsilons of a box, and `widening` times t more; end = −1 for those that never are.
  void (*clip_rays)(const Region<Real>& box, Real widening, Real epsilon_slope, const RayView<Real>&, Real* start,
                    Real* end);
  /// Rays at their start; t is NaN where anything of the ray is not finite, and past the end. `carried`: what `before` holds
  /// at first; where steps are long that is always kNothingBefore, and for kShadow `boldness` holds it.
  void (*begin_march)(const RayView<Real>&, const MarchParameters<Real>&, Real carried, const MarchState<Real>&);
  /// Marches rays in refilled blocks until each is paused. `region`: of the tape, in which all next samples lie; null where
  /// it may be run everywhere. rays.start is not read.
  void (*march)(const TapeView<Real>&, Real* memory, const RayView<Real>&, const MarchParameters<Real>&,
                const Region<Real>* region, const MarchState<Real>&, Counters&);
  /// The same for shadow rays: `before`, or for kShadow `boldness`, is the visibility of each ray's far end so far, over its
  /// samples. No other long steps.
  void (*march_shadow)(const TapeView<Real>&, Real* memory, const RayView<Real>&, const MarchParameters<Real>&,
                       const Region<Real>* region, const MarchState<Real>&, Counters&);
  /// Leaves the field at the samples of all lanes in the register `taken_up` of the chain.
  void (*run_chain)(const ChainView<Real>&, const ChainBlock<Real>&, Counters&);
  /// The same, and steps rays once, those of `live`: bit = lane. What other lanes hold may be overwritten.
  ChainStep (*step_chain)(const ChainView<Real>&, const ChainBlock<Real>&, std::uint64_t live,
                          const MarchParameters<Real>&, Counters&);
  ChainStep (*step_chain_shadow)(const ChainView<Real>&, const ChainBlock<Real>&, std::uint64_t live,
                                 const MarchParameters<Real>&, Counters&);
  /// What shadow rays let through: 0 where they met something.
  void (*visibility)(const RayView<Real>&, const MarchParameters<Real>&, const MarchState<Real>&, Real* out);
  /// What became of rays that have ended or are spent: octomarch::Status, and t, +inf for misses and invalid rays.
  void (*conclude)(const RayView<Real>&, const MarchParameters<Real>&, const MarchState<Real>&, std::uint8_t* status);
  /// Ends of the secants of hits, and the points there; NaN for other rays and for hits that have been followed. Returns
  /// whether there are any, and counts the evaluations that they take.
  bool (*secants)(const RayView<Real>&, const MarchParameters<Real>&, const MarchState<Real>&,
                  const std::uint8_t* status, Real* ends, const Vectors<Real>& points, Counters&);
  /// Moves hits to those ends, or a little farther, where the field there says that they are better. Some are to be followed
  /// once more.
  void (*follow_secants)(const RayView<Real>&, const MarchParameters<Real>&, const MarchState<Real>&,
                         const std::uint8_t* status, const Real* ends, const Real* field);
  /// Halves the last step of hits of fixed steps.
  void (*bisect)(const TapeView<Real>&, Real* memory, const RayView<Real>&, const MarchParameters<Real>&,
                 const MarchState<Real>&, const std::uint8_t* status, Counters&);
  /// The tape's result at points; NaN at NaN points, of which whole blocks cost nothing. This and the next two poll `cancelled` at every block.
  void (*distance)(const TapeView<Real>&, Real* registers, const Vectors<const Real>& points, std::size_t count,
                   const bool* cancelled, Real* out);
  /// Where, of a block of kLanes points, each instruction takes which operand all over the balls of a radius about them.
  /// `origins`: of the instructions in the tape that the margins are of. Arrays as long as the tape.
  void (*compare)(const TapeView<Real>&, Real* registers, const Vectors<const Real>& points, double radius,
                  const std::uint32_t* origins, const Margin* margins, TakenAt* taken);
  /// Several results of a tape at points: outs[i] gets that of register results[i]. `normals`: inputs 3, 4, 5 of tapes that
  /// have them, else null.
  void (*expressions)(const TapeView<Real>&, Real* registers, const Vectors<const Real>& points,
                      const Vectors<const Real>* normals, std::size_t count, const bool* cancelled,
                      const std::uint16_t* results, std::size_t result_count, Real* const* outs);
  /// The exact gradient at points, NaN where these are not finite; the register file is four times as large.
  void (*gradient)(const TapeView<Real>&, Real* registers, const Vectors<const Real>& points, std::size_t count,
                   const bool* cancelled, const Vectors<Real>& out);
  /// A direction across the surface from the field around each point, by differences or by counting. Its length means
  /// nothing.
  void (*sample_around)(const TapeView<Real>&, Real* registers, const Vectors<const Real>& points, std::size_t count,
                        const StencilView<Real>&, const bool* cancelled, const Vectors<Real>& out);
  /// Fills position, direction and epsilon of surface points: point i is that of ray indices[i] at t[indices[i]].
  void (*surface_points)(const RayView<Real>&, Real epsilon_slope, const Real* t, const std::uint32_t* indices,
                         const SurfaceView<Real>&);
  /// Gradients in surface.normal become unit normals, −direction where there is none; returns how many those are.
  std::size_t (*normalize)(const SurfaceView<Real>&);
  /// Fills facing and origin = position + 2·epsilon·facing. A normal that faces away, where a ray grazes an edge
  /// within the hit epsilon, is turned until it is square to the ray.
  void (*face_rays)(const SurfaceView<Real>&);
  /// Points at a height above the surface, where its occlusion is sampled.
  void (*occlusion_points)(const SurfaceView<Real>&, Real height, const Vectors<Real>& points);
  /// Adds weight times what the field there lacks of the height.
  void (*add_occlusion)(const Real* field, std::size_t count, Real height, Real weight, Real* occlusion);
  /// Turns such a sum, of which `most` is the largest, into ambient visibility.
  void (*ambient_visibility)(std::size_t count, Real most, Real* occlusion);
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
