#include "octomarch/reference/trace_domain.hpp"

#include <algorithm>
#include <cmath>

namespace octomarch::reference {
namespace {

PointTrace rotated(const Node& node, const PointTrace& p) {
  PointTrace result;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto entry = [&](std::size_t row) { return Interval(node.parameter(3 * row + i)); };
    result[i] = p[0] * entry(0) + p[1] * entry(1) + p[2] * entry(2);
  }
  return result;
}

/// x − clamp(x, −half, half).
Trace drawn_together(const Trace& x, double half) {
  if (half == 0.0 || x.is_undefined) return x;
  if (x.over.lo() >= half) return x - half;
  if (x.over.hi() <= -half) return x + half;
  if (x.over.magnitude() <= half) return constant(0.0);
  const auto value = [half](const Interval& y) { return max(y - Interval(half), 0.0) + min(y + Interval(half), 0.0); };
  return mapped(value, hull(0.0, x.rise), x);
}

/// What turns: the plane of u and v, by an angle that follows the coordinate `along`; and what is across the axis.
struct Turning {
  std::size_t axis, along, u, v;

  explicit Turning(const Node& node) {
    const bool is_bend = node.kind() == NodeKind::kBend;
    axis = is_bend ? 2 : static_cast<std::size_t>(node.parameter(2));
    along = is_bend ? 0 : axis;
    u = axis == 0 ? 1 : 0;
    v = axis == 2 ? 1 : 2;
  }
};

/// A point drawn straight towards the axis until it is within `radius` of it, then turned.
PointTrace turned(const Node& node, const PointTrace& p) {
  const Turning turning(node);
  const auto [axis, along, u, v] = turning;
  const double radius = node.parameter(1);
  PointTrace drawn = p;
  const Trace distance = length(std::array{p[u], p[v]});
  if (!(distance.over.hi() <= radius)) {
    const Trace share = radius == 0.0 ? constant(0.0) : constant(radius) / max(distance, radius);
    for (const std::size_t i : {u, v}) drawn[i] = no_faster(p[i] * share, speed(std::array{p[u], p[v]}));
  }
  const Trace angle = drawn[along] * Interval(node.parameter(0));
  const Trace sine = mapped([](const Interval& x) { return sin(x); }, cos(angle.over) * angle.rise, angle);
  const Trace cosine = mapped([](const Interval& x) { return cos(x); }, -sin(angle.over) * angle.rise, angle);
  PointTrace result = drawn;
  result[u] = cosine * drawn[u] - sine * drawn[v];
  result[v] = sine * drawn[u] + cosine * drawn[v];
  return result;
}

}  // namespace

PointTrace child_trace(const Node& node, const PointTrace& p) {
  const auto number = [&node](std::size_t i) { return Interval(node.parameter(i)); };
  switch (node.kind()) {
    case NodeKind::kTranslate: return {p[0] - number(0), p[1] - number(1), p[2] - number(2)};
    case NodeKind::kRotate: return rotated(node, p);
    case NodeKind::kScale: return {p[0] / number(0), p[1] / number(0), p[2] / number(0)};
    case NodeKind::kStretch: return {p[0] / number(0), p[1] / number(1), p[2] / number(2)};
    case NodeKind::kElongate:
      return {drawn_together(p[0], node.parameter(0)), drawn_together(p[1], node.parameter(1)),
              drawn_together(p[2], node.parameter(2))};
    case NodeKind::kMirror: {
      PointTrace folded = p;
      Trace& coordinate = folded[static_cast<std::size_t>(node.parameter(0))];
      coordinate = abs(coordinate);
      return folded;
    }
    case NodeKind::kTwist:
    case NodeKind::kBend: return turned(node, p);
    case NodeKind::kExtrude: return {p[0], p[1], constant(0.0)};
    case NodeKind::kRevolve: return {length(std::array{p[0], p[2]}) - number(0), p[1], constant(0.0)};
    default: return p;
  }
}

Trace wall_trace(const Node& node, const PointTrace& p) {
  const Turning turning(node);
  return length(std::array{p[turning.u], p[turning.v]}) - Interval(node.parameter(1));
}

Copies::Row::Row(const RepeatAxis& constants, const Trace& x)
    : period_(constants.period), shift_(0.5 - constants.shift), limit_(constants.limit) {
  if (period_ == 0.0) return;
  const Gaps gaps = gaps_over(x.over);
  const auto part_of = [&gaps](const Gaps& at_end) {
    return Gaps{std::max(at_end.first, gaps.first), std::min(at_end.last, gaps.last)};
  };
  gaps_ = {gaps, part_of(gaps_over(x.first)), part_of(gaps_over(x.last))};
  lowest_ = existing(gaps.first);
  highest_ = existing(gaps.last + 1.0);
  // not beyond whole numbers' reach, nor over more than one centre
  is_known_ = std::fabs(gaps.first) < 0x1p50 && gaps.last - gaps.first <= 1.0;
}

/// Beyond the last copies all gaps are alike.
Copies::Gaps Copies::Row::gaps_over(const Interval& x) const {
  const Interval place = x / Interval(period_) - Interval(shift_);
  const auto gap = [this](double at) { return std::clamp(std::floor(at), -limit_ - shift_ - 1.0, limit_ - shift_); };
  return {gap(place.lo()), gap(place.hi())};
}

/// The copy that stands for a number, which may be beyond the last.
double Copies::Row::existing(double number) const { return std::clamp(number, -limit_ - shift_, limit_ - shift_); }

Trace Copies::Row::seen_by(std::size_t i, const Trace& x) const {
  if (period_ == 0.0) return x;
  if (!is_known_) return seen_by_any(x);
  return x - Interval(lowest_ + static_cast<double>(i) + shift_) * Interval(period_);
}

/// Not more than a period away, or out beyond the last copy.
Trace Copies::Row::seen_by_any(const Trace& x) const {
  Interval range{-period_, period_};
  if (limit_ != kInfinity) {
    const Interval edge = Interval(limit_) * Interval(period_);
    range = {std::min(range.lo(), (x.over + edge).lo()), std::max(range.hi(), (x.over - edge).hi())};
  }
  return {range, range, range, Interval::whole(), false, x.is_undefined};
}

Copies::Use Copies::Row::use(std::size_t i, Part part) const {
  if (period_ == 0.0) return Use::kAlways;
  if (!is_known_) return Use::kMaybe;
  const double number = lowest_ + static_cast<double>(i);
  const Gaps& gaps = gaps_[static_cast<std::size_t>(part)];
  bool is_used = false;
  bool is_left_out = false;
  for (const double gap : {gaps.first, gaps.last}) {  // there is none between
    const bool borders = number == existing(gap) || number == existing(gap + 1.0);
    (borders ? is_used : is_left_out) = true;
  }
  return !is_used ? Use::kNever : is_left_out ? Use::kMaybe : Use::kAlways;
}

Copies::Copies(const Node& repeat, const PointTrace& p)
    : p_(p),
      rows_{Row(repeat_axis(repeat, 0), p[0]), Row(repeat_axis(repeat, 1), p[1]), Row(repeat_axis(repeat, 2), p[2])} {
  for (std::size_t i = 0; i < rows_[0].size(); ++i) {
    for (std::size_t j = 0; j < rows_[1].size(); ++j) {
      for (std::size_t k = 0; k < rows_[2].size(); ++k) copies_.push_back({i, j, k});
    }
  }
}

PointTrace Copies::point(std::size_t i) const {
  PointTrace result;
  for (std::size_t axis = 0; axis < 3; ++axis) result[axis] = rows_[axis].seen_by(copies_[i][axis], p_[axis]);
  return result;
}

Copies::Use Copies::use(const Place& place, Part part) const {
  Use result = Use::kAlways;
  for (std::size_t axis = 0; axis < 3; ++axis) result = std::min(result, rows_[axis].use(place[axis], part));
  return result;
}

Trace Copies::nearest(const std::vector<Trace>& children) const {
  const auto value = [&](Part part, Interval Trace::* member) -> Interval {
    double lo = kInfinity;
    double hi = kInfinity;
    for (std::size_t i = 0; i < children.size(); ++i) {
      const Use used = use(copies_[i], part);
      if (used != Use::kNever) lo = std::min(lo, (children[i].*member).lo());
      if (used == Use::kAlways) hi = std::min(hi, (children[i].*member).hi());
    }
    return {lo, hi};
  };
  Trace result{value(Part::kOver, &Trace::over), value(Part::kFirst, &Trace::first), value(Part::kLast, &Trace::last),
               Interval::whole()};
  result.is_undefined = std::ranges::any_of(children, &Trace::is_undefined);
  // the field is the least of copies that are looked at all along, where no other can be less
  std::vector<const Trace*> relevant;
  for (std::size_t i = 0; i < children.size(); ++i) {
    if (children[i].over.lo() > result.over.hi()) continue;
    if (use(copies_[i], Part::kOver) != Use::kAlways) return result;
    relevant.push_back(&children[i]);
  }
  Trace least = *relevant.front();
  for (const Trace* const child : relevant) least = min(least, *child);
  least.is_undefined = result.is_undefined;
  return least;
}

}  // namespace octomarch::reference
