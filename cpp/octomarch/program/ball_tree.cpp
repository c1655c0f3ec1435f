#include "octomarch/program/ball_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

#include "octomarch/base/parallel.hpp"
#include "octomarch/program/ball_reader.hpp"

namespace octomarch {

namespace {

/// Of numbers whose squares are numbers too.
double distance(const Vec3& a, const Vec3& b) {
  const Vec3 way = a - b;
  return std::sqrt(way.x * way.x + way.y * way.y + way.z * way.z);
}

/// Balls in parts of parts, halved along the longest side of the box about their centres.
class Halves {
 public:
  struct Part {
    Vec3 center;
    double radius = 0.0;  ///< about all of its balls
    std::uint32_t first = 0, count = 0;
    std::uint32_t other = 0;  ///< the second half; the first comes right behind
    bool is_leaf() const { return count <= kBallsOfLeaf; }
  };

  /// Cancelled, there are too few.
  Halves(std::vector<Ball> balls, const bool& cancelled) : balls_(std::move(balls)), cancelled_(cancelled) {
    build(0, static_cast<std::uint32_t>(balls_.size()));
  }

  const std::vector<Part>& parts() const { return parts_; }
  const Part& whole() const { return parts_.front(); }
  std::span<const Ball> balls() const { return balls_; }
  std::span<const Ball> balls_of(const Part& part) const { return balls().subspan(part.first, part.count); }

  /// Calls f(balls of a leaf) for all leaves that a ball about a point meets, until it returns false.
  template <class Function>
  void for_each_leaf_near(const Vec3& center, double radius, Function&& f) const {
    std::array<std::uint32_t, kDeepestBallTree> waiting{};
    std::size_t count = 1;
    while (count > 0) {
      const std::uint32_t index = waiting[--count];
      const Part& part = parts_[index];
      if (distance(part.center, center) > part.radius + radius) continue;
      if (!part.is_leaf()) {
        waiting[count++] = part.other;
        waiting[count++] = index + 1;
      } else if (!f(balls_of(part))) {
        return;
      }
    }
  }

 private:
  /// As deep as the tree is.
  void build(std::uint32_t first, std::uint32_t count) {  // NOLINT(misc-no-recursion)
    const std::span<Ball> balls = std::span(balls_).subspan(first, count);
    const std::size_t index = parts_.size();
    Vec3 size;
    parts_.push_back(about(balls, size));
    parts_[index].first = first;
    parts_[index].count = count;
    if (parts_[index].is_leaf() || is_set(cancelled_)) return;
    double Vec3::* const longest = *std::ranges::max_element(kAxes, {}, [&](auto axis) { return size.*axis; });
    const std::uint32_t half = count / 2;
    std::ranges::nth_element(balls, balls.begin() + half, {}, [&](const Ball& ball) { return ball.center.*longest; });
    build(first, half);
    parts_[index].other = static_cast<std::uint32_t>(parts_.size());
    build(first + half, count - half);
  }

  static Part about(std::span<const Ball> balls, Vec3& size) {
    Vec3 lo = balls.front().center;
    Vec3 hi = lo;
    for (const Ball& ball : balls) {
      for (double Vec3::* const axis : kAxes) {
        lo.*axis = std::min(lo.*axis, ball.center.*axis);
        hi.*axis = std::max(hi.*axis, ball.center.*axis);
      }
    }
    size = hi - lo;
    Part part{.center = lo + size * 0.5};
    for (const Ball& ball : balls) {
      part.radius = std::max(part.radius, distance(ball.center, part.center) + std::max(ball.radius, 0.0));
    }
    return part;
  }

  std::vector<Ball> balls_;  ///< in the order of the leaves
  const bool& cancelled_;
  std::vector<Part> parts_;
};

/// How far outside of a ball a blend may have its surface, or be no more than `epsilon`, where that ball is the nearest.
///
/// Let d be the least of the distances dᵢ at a point. Blends that take up one shape at a time lower what they have by k in
/// all at the most: at θk below the least, the next takes (1 − θ)²k/4 and no more. So what is 2k farther than d does not
/// count: alone it stays above d + k, and the blend of that with anything at d is d. The blend of two takes no more from the
/// smaller than κ·log(1 + exp(−|a − b|/κ)), κ = k / (4 log 2), with which it agrees in value and slope where a = b; and that
/// does not depend on the order of operands. So the field is at least d − κ·log(Σ exp(−(dᵢ − d)/κ) + exp(−k/κ)), the last
/// for those that do not count. And dᵢ − d is at least the gap to the i-th ball less 2d.
class BlendReach {
 public:
  BlendReach(const Halves& halves, double k, double epsilon)
      : halves_(halves),
        k_(k),
        epsilon_(epsilon),
        reach_(4.0 * k + 2.0 * epsilon),
        sharpness_(4.0 * std::numbers::ln2 / k) {}

  /// Of all balls of a leaf. O(log n + balls near it).
  void of(const Halves::Part& leaf, std::span<double> lowerings) {
    const std::span<const Ball> own = halves_.balls_of(leaf);
    std::size_t first_own = 0;
    near_.clear();
    halves_.for_each_leaf_near(leaf.center, leaf.radius + reach_, [&](std::span<const Ball> balls) {
      if (balls.data() == own.data()) first_own = near_.size();
      near_.insert(near_.end(), balls.begin(), balls.end());
      return near_.size() <= kMostNear;
    });
    const bool are_too_many = near_.size() > kMostNear;
    for (std::size_t i = 0; i < own.size(); ++i) lowerings[i] = are_too_many ? k_ : of(first_own + i);
  }

 private:
  static constexpr std::size_t kMostNear = 2000;  ///< to a leaf, to be looked at
  static constexpr std::size_t kMostGaps = 16;    ///< of which the sum is taken
  static constexpr int kRounds = 6;               ///< each begins at what the last has found to be the most
  static constexpr double kHardlyLess = 0.95;     ///< not worth another

  double of(std::size_t one) const {
    const Ball& ball = near_[one];
    std::array<double, kMostGaps> gaps{};
    std::size_t count = 0;
    for (std::size_t i = 0; i < near_.size(); ++i) {
      const Ball& other = near_[i];
      const Vec3 way = other.center - ball.center;
      const double most = std::max(ball.radius + other.radius + reach_, 0.0);
      const double square = way.x * way.x + way.y * way.y + way.z * way.z;
      if (i == one || square >= most * most) continue;
      if (count == kMostGaps) return k_;
      gaps[count++] = std::sqrt(square) - ball.radius - other.radius;
    }
    double most = k_;
    for (int round = 0; round < kRounds; ++round) {
      const double less = at(most + epsilon_, std::span(gaps).first(count));
      if (less > most * kHardlyLess) break;
      most = less;
    }
    return most;
  }

  /// The most that blends take at a distance from the ball.
  double at(double distance, std::span<const double> gaps) const {
    double sum = 0.0;
    for (const double gap : gaps) {
      const double farther = std::max(gap - 2.0 * distance, 0.0);
      if (farther < 2.0 * k_) sum += std::exp(-farther * sharpness_);
    }
    if (sum == 0.0) return 0.0;  // alone it is as it is
    return std::log1p(sum + std::exp(-k_ * sharpness_)) / sharpness_;
  }

  const Halves& halves_;
  double k_, epsilon_;
  double reach_;  ///< from its surface to those that may have a say
  double sharpness_;
  std::vector<Ball> near_;
};

/// Of all balls; nothing where there is so much about what is in them that rays are better led by cones. `k`: of the blend.
std::optional<std::vector<double>> lowerings_of(const Halves& halves, double k, double epsilon, const bool& cancelled) {
  constexpr double kMostOfBulk = 1.0 / 6.0;
  constexpr double kMostOfBlend = 0.8;
  constexpr std::size_t kLeavesOfSample = 64;  // a crowd is told by these
  std::vector<const Halves::Part*> leaves;
  for (const Halves::Part& part : halves.parts()) {
    if (part.is_leaf()) leaves.push_back(&part);
  }
  std::vector<double> lowerings(halves.balls().size());
  const auto own = [&](const Halves::Part& leaf) { return std::span(lowerings).subspan(leaf.first, leaf.count); };
  std::optional<BlendReach> reach;
  if (k > 0.0) reach.emplace(halves, k, epsilon);
  double around = 0.0;
  double blended = 0.0;
  double bulk = 0.0;
  double count = 0.0;
  const std::size_t stride = std::max<std::size_t>(leaves.size() / kLeavesOfSample, 1);
  for (std::size_t i = 0; i < leaves.size(); i += stride) {
    if (reach) reach->of(*leaves[i], own(*leaves[i]));
    for (const double lowered : own(*leaves[i])) blended += lowered;
    for (const Ball& ball : halves.balls_of(*leaves[i])) {
      bulk += std::max(ball.bulk, 0.0);
      around += ball.radius - ball.bulk;
    }
    count += leaves[i]->count;
  }
  if (around + blended > kMostOfBulk * bulk || blended > kMostOfBlend * k * count) return std::nullopt;
  for (std::size_t i = 0; reach && i < leaves.size(); ++i) {
    if (is_set(cancelled)) return std::nullopt;
    if (i % stride != 0) reach->of(*leaves[i], own(*leaves[i]));
  }
  return lowerings;
}

/// In Real, and not less than it.
template <class Real>
Real at_least(double number) {
  constexpr double kUp = 4.0 * static_cast<double>(std::numeric_limits<Real>::epsilon());
  return static_cast<Real>(number + std::fabs(number) * kUp);
}

template <class Real>
BallLeaf<Real> leaf_of(std::span<const Ball> balls, std::span<const double> lowerings) {
  BallLeaf<Real> leaf{};
  std::ranges::fill(leaf.radius, -std::numeric_limits<Real>::infinity());
  for (std::size_t i = 0; i < balls.size(); ++i) {
    leaf.x[i] = static_cast<Real>(balls[i].center.x);
    leaf.y[i] = static_cast<Real>(balls[i].center.y);
    leaf.z[i] = static_cast<Real>(balls[i].center.z);
    leaf.radius[i] = at_least<Real>(balls[i].radius + lowerings[i]);
  }
  return leaf;
}

}  // namespace

template <class Real>
std::optional<BallTree<Real>> BallTree<Real>::of(const Tape& tape, const bool& cancelled) {
  std::optional<Crowd> crowd = read_crowd<Real>(tape);
  if (!crowd) return std::nullopt;
  if (crowd->balls.size() < kFewest) return std::nullopt;
  const double blend = crowd->blend;
  const Halves halves(std::move(crowd->balls), cancelled);
  if (is_set(cancelled)) return std::nullopt;
  const double size = distance(halves.whole().center, {}) + halves.whole().radius + blend;
  // squares of distances, and of their roundings, are to be numbers
  const double least = std::sqrt(static_cast<double>(std::numeric_limits<Real>::min())) * 0x1p24;
  const double most = std::sqrt(static_cast<double>(std::numeric_limits<Real>::max())) * 0x1p-4;
  if (size <= least || size >= most || std::isnan(size)) return std::nullopt;

  const double trusted = blend > 0.0 ? blend / 8.0 : kInfinity;
  const std::optional<std::vector<double>> lowerings = lowerings_of(halves, blend, trusted, cancelled);
  if (!lowerings) return std::nullopt;
  BallTree tree;
  tree.blend_ = at_least<Real>(blend);
  tree.trusted_epsilon_ = static_cast<Real>(trusted);
  for (const Halves::Part& part : halves.parts()) {
    BallNode<Real>& node = tree.nodes_.emplace_back();
    for (std::size_t axis = 0; axis < 3; ++axis) node.center[axis] = static_cast<Real>(part.center.*kAxes[axis]);
    // no centre is moved by more than a rounding of the largest
    node.radius =
        at_least<Real>(part.radius + blend + size * static_cast<double>(std::numeric_limits<Real>::epsilon()));
    node.is_leaf = part.is_leaf();
    node.other = node.is_leaf ? static_cast<std::uint32_t>(tree.leaves_.size()) : part.other;
    if (!node.is_leaf) continue;
    tree.leaves_.push_back(leaf_of<Real>(halves.balls_of(part), std::span(*lowerings).subspan(part.first, part.count)));
  }
  return tree;
}

template class BallTree<float>;
template class BallTree<double>;

}  // namespace octomarch
