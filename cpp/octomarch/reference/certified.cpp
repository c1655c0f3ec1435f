// Pieces of a ray, nearest first. One over which the field is proven positive is passed, and the next is longer; one that is
// not is shortened, from both ends by what its rates prove (an interval Newton step: R. E. Moore, R. B. Kearfott, M. J. Cloud,
// "Introduction to Interval Analysis", SIAM 2009, ch. 8), else to its first half. See certified.hpp.
#include "octomarch/reference/certified.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <functional>
#include <optional>
#include <vector>

#include "octomarch/base/parallel.hpp"
#include "octomarch/reference/lens.hpp"

namespace octomarch::reference {
namespace {

constexpr std::size_t kRaysPerTask = 16;

double largest_magnitude(const Vec3& v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

/// A part of a ray.
struct Piece {
  double lo;
  double hi;

  double width() const { return hi - lo; }
  /// Bounds of the parameter at a share of the way from lo to hi.
  Interval at(const Interval& share) const { return Interval(lo) + share * (Interval(hi) - Interval(lo)); }
};

/// Up to here the field stays above 0, if it is so at the start: it falls no faster than its rise says.
double positive_up_to(const Piece& piece, const Trace& f) {
  const double start = f.first.lo();
  const double fall = -f.rise.lo();
  if (!(start > 0.0)) return piece.lo;
  if (!(fall > start)) return piece.hi;
  return std::clamp(piece.at(Interval(start) / Interval(fall)).lo(), piece.lo, piece.hi);
}

/// Where the field is at most 0 too, nearer to the start than at the end. Contract: there it is.
double inside_from(const Piece& piece, const Trace& f) {
  if (f.first.hi() <= 0.0) return piece.lo;
  double from = piece.hi;
  const double depth = -f.last.hi();
  const double fall = -f.rise.lo();  // back from the end the field rises no faster
  if (fall > depth) from = std::min(from, piece.at(Interval(1.0) - Interval(depth) / Interval(fall)).hi());
  const double sure_fall = -f.rise.hi();  // from the start it falls at least as fast
  if (sure_fall > f.first.hi()) {
    from = std::min(from, piece.at(Interval(f.first.hi()) / Interval(sure_fall)).hi());
  }
  return std::max(from, piece.lo);
}

class Search {
 public:
  Search(FieldTracer& field, const Line& line, const SearchLimits& limits)
      : field_(field), line_(line), limits_(limits), speed_(length(line.direction)), lo_(limits.t_min) {
    constexpr double kFarthest = 1e150;  // beyond, squares of coordinates are infinite
    end_ = std::min({limits.max_distance, kFarthest, kFarthest * speed_}) / speed_;
  }

  Bracket run() {
    if (!(lo_ <= end_)) return miss();
    const Trace start = along({lo_, lo_});
    if (!start.is_undefined && start.first.hi() <= 0.0) return {Verdict::kInside, lo_, lo_};
    double width = std::max({4.0 * start.first.lo(), largest_magnitude(line_.origin) / 64.0}) / speed_;
    double growth = 2.0;
    while (evaluations_ < limits_.max_evaluations) {
      const Piece piece{lo_, std::min(lo_ + width, end_)};
      const Trace f = along(piece);
      if (!f.is_undefined && f.over.lo() > 0.0) {
        if (piece.hi == end_) return miss();
        lo_ = piece.hi;
        growth *= 2.0;
        width *= growth;
        continue;
      }
      growth = 2.0;
      narrow(piece, f);
      if (is_near_enough(end_)) return {Verdict::kHit, lo_, end_};
      if (piece.width() <= least_width(piece.hi)) return at_last();
      const double left = end_ - lo_;
      const bool has_closed_in = ends_inside_ && left <= 0.5 * piece.width();
      width = has_closed_in ? left : 0.5 * piece.width();
    }
    return undecided();
  }

 private:
  static Bracket miss() { return {Verdict::kMiss, kInfinity, kInfinity}; }
  Bracket undecided() const { return {Verdict::kUndecided, lo_, ends_inside_ ? end_ : kInfinity}; }

  Trace along(const Piece& piece) {
    ++evaluations_;
    return field_.along(piece_of(line_, piece.lo, piece.hi));
  }

  /// Moves the ends as far as the piece's trace proves: where the search goes on, and where it need not go beyond.
  void narrow(const Piece& piece, const Trace& f) {
    if (f.is_undefined) return;
    if (f.last.hi() <= 0.0) {
      ends_inside_ = true;
      end_ = inside_from(piece, f);
    }
    lo_ = std::min(positive_up_to(piece, f), end_);
  }

  bool is_near_enough(double inside) const {
    return ends_inside_ && rounding::add<true>(inside, -lo_) <= limits_.tolerance * inside;
  }

  /// Shorter pieces would say no more: the point's own rounding is all they are.
  double least_width(double t) const {
    return std::max(0.25 * limits_.tolerance * t, 0x1p-52 * (largest_magnitude(line_.origin) / speed_ + t));
  }

  /// What can be said where the field comes so near 0 that no piece is short enough: a point inside may be near enough.
  Bracket at_last() {
    const double t = std::min(lo_ * (1.0 + 0.75 * limits_.tolerance), end_);
    const Trace f = along({t, t});
    if (!f.is_undefined && f.first.hi() <= 0.0) {
      ends_inside_ = true;
      end_ = t;
      if (is_near_enough(t)) return {Verdict::kHit, lo_, t};
    }
    return undecided();
  }

  FieldTracer& field_;
  const Line& line_;
  const SearchLimits& limits_;
  double speed_;
  double lo_;   // the field is positive before
  double end_;  // the search goes no farther
  bool ends_inside_ = false;
  int evaluations_ = 0;
};

/// What a worker throws when others have been stopped; nobody sees it.
struct Stopped : std::exception {};

/// Fills `brackets` with first roots along line_of(i).
void search_all(const NodePtr& root, const std::function<Line(std::size_t)>& line_of, const SearchLimits& limits,
                unsigned threads, const Brackets& brackets, const Poll& poll) {
  const std::size_t rays = brackets.verdict.size();
  const unsigned workers = thread_count(threads);
  std::vector<std::optional<FieldTracer>> tracers(workers);
  const auto search_some = [&](std::size_t task, std::size_t worker, const bool& cancelled) {
    const auto stop_if_cancelled = [&cancelled] {
      if (is_set(cancelled)) throw Stopped{};
    };
    if (!tracers[worker]) tracers[worker].emplace(root, stop_if_cancelled);
    FieldTracer& field = *tracers[worker];
    const std::size_t end = std::min((task + 1) * kRaysPerTask, rays);
    for (std::size_t i = task * kRaysPerTask; i < end; ++i) {
      const Bracket bracket = first_root(field, line_of(i), limits);
      brackets.t_lo[i] = bracket.t_lo;
      brackets.t_hi[i] = bracket.t_hi;
      brackets.verdict[i] = static_cast<std::uint8_t>(bracket.verdict);
    }
  };
  parallel_for((rays + kRaysPerTask - 1) / kRaysPerTask, workers, search_some, {poll, {}});
}

Vec3 triple(std::span<const double> values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

}  // namespace

PointTrace piece_of(const Line& line, double t_first, double t_last) {
  const auto trace = [&](double origin, double direction) {
    const Interval first = Interval(origin) + Interval(t_first) * Interval(direction);
    const Interval last = Interval(origin) + Interval(t_last) * Interval(direction);
    const Interval rise = (Interval(t_last) - Interval(t_first)) * Interval(direction);
    return Trace{hull(first, last), first, last, rise, true};
  };
  return {trace(line.origin.x, line.direction.x), trace(line.origin.y, line.direction.y),
          trace(line.origin.z, line.direction.z)};
}

Bracket first_root(FieldTracer& field, const Line& line, const SearchLimits& limits) {
  const double speed = length(line.direction);
  const bool is_valid = is_finite(line.origin) && is_finite(line.direction) && speed > 0.0;
  if (!is_valid) return {Verdict::kInvalid, kInfinity, kInfinity};
  return Search(field, line, limits).run();
}

void certified(const NodePtr& root, std::span<const double> origins, std::span<const double> directions,
               const SearchLimits& limits, unsigned threads, const Brackets& brackets, const Poll& poll) {
  const auto line_of = [&](std::size_t i) { return Line{triple(origins, i), triple(directions, i)}; };
  search_all(root, line_of, limits, threads, brackets, poll);
}

void certified_picture(const NodePtr& root, const Camera& camera, std::uint32_t width, std::uint32_t height,
                       const Crop& crop, const SearchLimits& limits, unsigned threads, const Brackets& brackets,
                       const Poll& poll) {
  const Lens lens(camera, width, height);
  const auto line_of = [&](std::size_t i) {
    const std::size_t row = i / crop.width;
    const std::size_t column = i % crop.width;
    const PixelRay ray = lens.ray(static_cast<double>(crop.x + column) + 0.5, static_cast<double>(crop.y + row) + 0.5);
    return Line{ray.origin, ray.direction};
  };
  search_all(root, line_of, limits, threads, brackets, poll);
}

}  // namespace octomarch::reference
