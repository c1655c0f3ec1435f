// The first root along rays, proven: interval evaluation of the node graph, without steps that trust a Lipschitz bound. Traces
// of fields come before it; the bindings come after. What it finds holds for the field over real numbers, rounding left out.
#pragma once

#include <cstdint>
#include <span>

#include "octomarch/graph/node.hpp"
#include "octomarch/graph/scene.hpp"
#include "octomarch/reference/poll.hpp"
#include "octomarch/reference/trace_field.hpp"

namespace octomarch::reference {

/// What is proven of a ray, between its start and its end. Numbers are those of Status where the meanings meet.
enum class Verdict : std::uint8_t {
  kHit = 0,        ///< f > 0 before t_lo, f ≤ 0 at t_hi, and both are as near as was asked for
  kMiss = 1,       ///< f > 0 everywhere; t_lo = t_hi = +inf
  kUndecided = 2,  ///< f > 0 before t_lo; f ≤ 0 at t_hi, or t_hi = +inf where no such point was found
  kInside = 3,     ///< f ≤ 0 at the start; t_lo = t_hi = the start
  kInvalid = 4,    ///< a direction that is zero, or a ray that is not finite; t_lo = t_hi = +inf
};

struct Bracket {
  Verdict verdict;
  double t_lo;
  double t_hi;
};

/// The points origin + t·direction, t ≥ 0; t counts in lengths of the direction.
struct Line {
  Vec3 origin;
  Vec3 direction;
};

struct SearchLimits {
  double t_min;         ///< where rays start, ≥ 0, in lengths of the direction
  double max_distance;  ///< where they end, in scene units; +inf for as far as squares of numbers go
  double tolerance;     ///< of hits: t_hi − t_lo ≤ tolerance·t_hi
  int max_evaluations;  ///< of the field over pieces of one ray, ≥ 1
};

/// Searches one ray. Roots that only touch 0 from above, and places where the field may be no number, are kUndecided.
Bracket first_root(FieldTracer& field, const Line& line, const SearchLimits& limits);

/// The field along pieces of lines, from t = 0 to 1.
PointTrace piece_of(const Line& line, double t_first, double t_last);

/// Where brackets go; each span holds one element per ray.
struct Brackets {
  std::span<double> t_lo;
  std::span<double> t_hi;
  std::span<std::uint8_t> verdict;
};

/// Rays from `origins` along `directions` (n × 3 each), on several threads; 0 for all cores.
void certified(const NodePtr& root, std::span<const double> origins, std::span<const double> directions,
               const SearchLimits& limits, unsigned threads, const Brackets& brackets, const Poll& poll);

/// The rays through the centres of a picture's pixels, made in double; row after row from the top. `crop`: of a picture of
/// width × height.
void certified_picture(const NodePtr& root, const Camera& camera, std::uint32_t width, std::uint32_t height,
                       const Crop& crop, const SearchLimits& limits, unsigned threads, const Brackets& brackets,
                       const Poll& poll);

}  // namespace octomarch::reference
