// What a picture is of and how it is wanted: materials, lights, sky, camera and settings, as plain data in double
// precision. Python validates and fills these; render/ and reference/ read them. Colours are linear RGB.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "octomarch/base/types.hpp"
#include "octomarch/graph/node.hpp"

namespace octomarch {

/// Surface under Lambert and Phong: expressions of the position in the painted shape's own coordinates, and of its
/// normal there. Children of a kPaint node in this order. diffuse = (1 − metallic)·color·(n·l); highlight colour =
/// mix(specular·white, color, metallic); Phong exponent from roughness: see phong_exponent(). Outside of their ranges
/// values are clamped where they are used.
struct Material {
  static constexpr std::size_t kSlots = 7;
  /// red, green, blue ≥ 0 (linear); roughness 0 (mirror-like highlight) … 1 (dull); specular (strength of the highlight
  /// of a non-metal), metallic and reflectivity (share of the mirror image in what is seen), each 0 … 1.
  std::array<NodePtr, kSlots> slots;

  friend bool operator==(const Material&, const Material&) = default;
};

/// What shapes without paint are made of.
const Material& default_material();

/// Phong exponent of a roughness: 2/α² − 2 with α = roughness², clamped to [1, 8192] (B. Karis, "Specular BRDF
/// reference", 2013, for the map from roughness to a power).
double phong_exponent(double roughness);

enum class LightKind : std::uint8_t { kDirectional, kPoint, kSpot };

struct Light {
  LightKind kind = LightKind::kDirectional;
  Vec3 vector{0.0, -1.0, 0.0};     ///< directional: unit direction in which light travels; else: position
  Vec3 color{1.0, 1.0, 1.0};       ///< irradiance on a surface that faces the light (else: at unit distance)
  int decay = 2;                   ///< all but directional: irradiance = color / distance^decay; 0, 1 or 2
  Vec3 direction{0.0, -1.0, 0.0};  ///< spot: unit direction in which its middle shines
  double inner_cosine = 1.0;       ///< spot: full strength where the angle's cosine is above
  double outer_cosine = 0.0;       ///< spot: none below; between, smoothstep of the cosine. < inner_cosine
};

/// Radiance of a ray that hits nothing: three expressions (red, green, blue ≥ 0) of the ray's unit direction, which
/// stands in the place of the point.
struct Sky {
  std::array<NodePtr, 3> color;
};

enum class CameraKind : std::uint8_t { kPerspective, kOrthographic, kPanoramic };

/// Look-at camera: w = unit(target − eye), u = unit(w × up), v = u × w. Pixel (i, j) of width × height has its centre
/// at s = (2(i + ½)/width − 1)·aspect, r = 1 − 2(j + ½)/height. Perspective: origin eye, direction
/// unit(w + tan(fov/2)·(s·u + r·v)). Orthographic: origin eye + height/2·(s·u + r·v), direction w. Panoramic
/// (equirectangular): origin eye, direction cos φ·(cos λ·w + sin λ·u) + sin φ·v with the longitude
/// λ = fov_across·((i + ½)/width − ½) and the latitude φ = fov·(½ − (j + ½)/height).
struct Camera {
  CameraKind kind = CameraKind::kPerspective;
  Vec3 eye{0.0, 0.0, 1.0};
  Vec3 target{0.0, 0.0, 0.0};
  Vec3 up{0.0, 1.0, 0.0};
  double fov = 45.0;          ///< vertical, degrees: in (0, 180) perspective, in (0, 180] panoramic
  double fov_across = 360.0;  ///< horizontal, degrees, in (0, 360]; panoramic only
  double height = 2.0;        ///< of the picture in scene units; orthographic only
};

/// A point in a pixel, from its upper left corner; the centre by default.
struct PixelPoint {
  double x = 0.5;
  double y = 0.5;
};

/// Where `count` samples of a pixel lie, the same in every pixel: sample k at x = (k + ½)/count, y = (rank + ½)/count, the
/// rank being that of frac(½ + k/φ) among all `count` of them, φ the golden ratio. So each lies in a column and a row of
/// its own (n-rooks: P. Shirley, "Discrepancy as a quality measure for sample distributions", Eurographics 1991), their
/// mean is the centre, and neighbours are far apart (Kronecker sequence: L. Kuipers, H. Niederreiter, "Uniform
/// Distribution of Sequences", 1974, ch. 2.3). One sample is the centre, four are a rotated grid.
std::vector<PixelPoint> sample_points(int count);

/// Pixels of a picture that are computed: those from (x, y) on, width × height of them, inside the whole.
struct Crop {
  std::uint32_t x, y;
  std::uint32_t width, height;
};

enum class Method : std::uint8_t { kAuto, kPlain, kRelaxed, kEnhanced, kFixed, kCertified };

/// Do a method's steps have a least length, and end in the solid?
constexpr bool is_fixed(Method method) { return method == Method::kFixed; }

/// How rays are marched; r is the field over its Lipschitz bound. Plain: a ray has hit where r ≤ eps(t), else it goes on
/// by r, or with a bias by max(r − bias, r/2). Relaxed, enhanced, auto: without a bias farther than r, and back where that
/// was too much; auto: camera rays begin where cones end. Fixed: a ray has hit where r ≤ 0, else it goes on by
/// max(r − bias, step, eps(t)). Certified: see Doubt. `hit epsilon` at parameter t of a ray with origin o, the same for every marcher:
///   eps(t) = max(epsilon, 16u·max(|o|∞, t), pixel_tolerance·pixel_radius(t)),
/// u = 2⁻²⁴ in float, 2⁻⁵³ in double: at least four units in the last place of |p|∞ and of t, since |p|∞ ≤ |o|∞ + t.
/// pixel_radius(t) is half the height of a pixel at parameter t (0 for queries, where there is no pixel). Where steps are
/// fixed, a step's accuracy() stands in for a smaller epsilon, so that rays that leave a surface leave it.
struct March {
  Method method = Method::kAuto;
  int max_steps = 256;           ///< evaluations per ray at the most, ≥ 1
  double epsilon = 1e-4;         ///< absolute, scene units, ≥ 0
  double pixel_tolerance = 0.1;  ///< in pixel radii, ≥ 0
  double max_distance = 1e3;     ///< farthest t, > 0
  double min_distance = 0.0;     ///< where t begins, ≥ 0
  double bias = 0.0;             ///< by how much a step stays short of the field, ≥ 0
  double step = 1e-3;            ///< least step, > 0; fixed only
  /// Refine hits: by the secant through the last two samples, unless it leaves eps/16, and a second one through its end.
  /// Fixed: by ten halvings of the last step.
  bool finish = true;
  bool prune = true;  ///< run long programs in parts, cell by cell: to the same results

  /// How far off hits of fixed steps lie; else 0.
  double accuracy() const { return !is_fixed(method) ? 0.0 : (finish ? step / 1024.0 : step); }
  /// The absolute part of the hit epsilon.
  double least_epsilon() const { return epsilon > accuracy() ? epsilon : accuracy(); }
};

/// What certified marches allow for: r and the place of its sample are off by no more than d = offset + slope·(|o|∞ + t),
/// where |o|∞ + t ≤ reach; beyond nothing is known. A sample then proves its sign in the ball of radius |r| − d about it. A ray
/// is free as far as overlapping balls outside of the solid cover it, and hits where one in the solid begins no more than a
/// bracket, max(eps(t), 16·d), past that. Rays for which neither that nor a miss can be shown are kStepLimit.
struct Doubt {
  double offset = 0.0;
  double slope = 0.0;
  double reach = 0.0;
};

enum class Normals : std::uint8_t { kExact, kCentral, kTetrahedron };
enum class Shadows : std::uint8_t { kNone, kHard, kSoft };

struct Shading {
  Normals normals = Normals::kExact;
  double normal_step = 1e-3;  ///< of differences and of the estimate for solids; scene units, > 0
  Shadows shadows = Shadows::kSoft;
  double shadow_k = 32.0;           ///< sharpness of soft shadows, > 0
  int occlusion = 5;                ///< samples along the normal; 0 = none
  double occlusion_distance = 0.1;  ///< of the farthest sample, scene units, > 0
  int bounces = 0;                  ///< reflections that are followed
  double reflection_cutoff = 1e-3;  ///< a reflection whose weight in the picture is below is not followed, ≥ 0
  double reflection_offset = 1e-3;  ///< mirror rays leave from here above the surface (at least 2·hit epsilon), ≥ 0
};

/// Per-ray outcome. Values are part of the file format.
enum class Status : std::uint8_t {
  kHit = 0,
  kMiss = 1,
  kStepLimit = 2,  ///< max_steps spent, or undecided; t is the candidate: no surface lies before it
  kInside = 3,     ///< the ray begins in the solid, or nearer than epsilon to it; t = min_distance
  kInvalid = 4,    ///< NaN field, or a direction that is zero or not finite
};

struct Scene {
  std::vector<Light> lights;
  Sky sky;
  Vec3 ambient{0.1, 0.1, 0.1};
};

/// The same as seen from another origin.
Scene counted_from(const Vec3& origin, Scene scene);
Camera counted_from(const Vec3& origin, Camera camera);

}  // namespace octomarch
