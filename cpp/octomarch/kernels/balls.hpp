// Where the rays of a block first come near to one of many balls: the tree about these (program/ball_tree.hpp) is walked with the cone
// about the rays, the nearest node first, and each ball that it meets is asked for all rays at once. What is found is the least of a
// number of each ball and ray, and so it depends on neither the tree nor the block. cones.hpp comes before.
#pragma once

#include "octomarch/kernels/cones.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

template <class Real>
class BallsOfBlock {
  using T = Lanes<Real>;
  /// Of numbers as large as those that a place was made of, what its roundings come to.
  static constexpr Real kRoundings = 16 * std::numeric_limits<Real>::epsilon();
  static constexpr Real kMore = Real(1.001);

 public:
  BallsOfBlock(const BallsView<Real>& balls, const RayView<Real>& rays, std::size_t block, const ConeView<Real>& cones,
               Real epsilon_slope)
      : balls_(balls),
        rays_(rays),
        first_(block * kLanes),
        per_rest_(Real(1) / (Real(1) - epsilon_slope)),
        growth_((epsilon_slope + kRoundings) * per_rest_),
        o_{cones.origin.x[block], cones.origin.y[block], cones.origin.z[block]},
        d_{cones.direction.x[block], cones.direction.y[block], cones.direction.z[block]},
        width_(cones.width[block]),
        spread_(cones.spread[block]),
        t_max_(cones.t_max[block]),
        per_length_(per_square(d_[0] * d_[0] + d_[1] * d_[1] + d_[2] * d_[2])) {
    const T zero = Real(0);
    T most = zero;
    T least = std::numeric_limits<Real>::infinity();
    for (std::size_t lane = 0; lane < kLanes; lane += kWidth<Real>) {
      const std::size_t i = first_ + lane;
      const T size = abs(at(rays.ox, i)) + abs(at(rays.oy, i)) + abs(at(rays.oz, i));
      // what grows with t counts at t ≤ (|along| + reach + room) / (1 − slope), where a ray within reach is at the most
      const T room = (at(rays.epsilon, i) + T(kRoundings) * size) * T(per_rest_) + T(growth_ * balls.blend);
      const T number = (size + at(rays.dx, i) + at(rays.dy, i) + at(rays.dz, i)) * zero;
      room.store(room_ + lane);
      most = max(room, most);
      least = min(at(rays.start, i), least);
      const T infinity = std::numeric_limits<Real>::infinity();
      const T enter = select(number == zero, infinity, -infinity);  // of rays that are no numbers nothing is asked
      enter.store(enter_ + lane);
      last_of_batch_[lane / kWidth<Real>] = largest_lane(enter);
    }
    room_of_all_ = largest_lane(most);
    first_start_ = -largest_lane(T(Real(0)) - least);
  }

  void find() {
    struct Waiting {
      std::uint32_t node;
      Real from;
    };
    Waiting waiting[kDeepestBallTree];
    int count = 0;
    const auto put = [&](std::uint32_t node, Real from) {
      if (!(from >= last_)) waiting[count++] = {node, from};
    };
    find_last();
    put(0, begins(balls_.nodes[0]));
    while (count > 0 && last_ > -std::numeric_limits<Real>::infinity()) {
      const auto [index, from] = waiting[--count];
      if (from >= last_) continue;
      const BallNode<Real>& node = balls_.nodes[index];
      if (node.is_leaf) {
        meet(balls_.leaves[node.other]);
        continue;
      }
      const Real one = begins(balls_.nodes[index + 1]);
      const Real other = begins(balls_.nodes[node.other]);
      if (one < other) {
        put(node.other, other);
        put(index + 1, one);
      } else {
        put(index + 1, one);
        put(node.other, other);
      }
    }
  }

  /// `start`: where the ray is first within reach of a ball; `end`: −1 where it never is.
  void write(Real* start, Real* end) const {
    const T infinity = std::numeric_limits<Real>::infinity();
    for (std::size_t lane = 0; lane < kLanes; lane += kWidth<Real>) {
      const T enter = T::load(enter_ + lane);
      const Mask<Real> meets = (enter < infinity) & (enter > -infinity);
      select(meets, enter, at(rays_.start, first_ + lane)).store(start + lane);
      select(meets, T::load(end + lane), T(Real(-1))).store(end + lane);
    }
  }

 private:
  static Real per_square(Real square) {
    return square > std::numeric_limits<Real>::min() ? Real(1) / square
                                                     : Real(0);  // of no direction, nothing is along it
  }

  /// Where the cone may first come near to balls that are all in one: +∞ where it does not, and a NaN where numbers are too large.
  T begins(const T& x, const T& y, const T& z, const T& radius) const {
    const T px = x - T(o_[0]);
    const T py = y - T(o_[1]);
    const T pz = z - T(o_[2]);
    const T ahead = px * T(d_[0]) + py * T(d_[1]) + pz * T(d_[2]);
    const T along = ahead * T(per_length_);
    const T aside = square(px - along * T(d_[0])) + square(py - along * T(d_[1])) + square(pz - along * T(d_[2]));
    const T distance = sqrt(px * px + py * py + pz * pz);
    const T farthest = distance + T(Real(2)) * (radius + T(width_));  // of all lanes and balls
    const T epsilon = (T(room_of_all_) + T(growth_) * farthest) * T(kMore);
    const T room = epsilon + select(epsilon > T(balls_.trusted_epsilon), T(balls_.blend), T(Real(0)));
    const T about = (radius + room + T(width_)) * T(kMore) + T(4 * kRoundings) * distance;
    const T wide = about + T(spread_) * (farthest + room) * T(kMore);
    const auto misses = (aside > wide * wide) | (ahead < -wide);
    // where rays begin within reach, no earlier than they do: so the walk ends once all have
    return select(misses, T(std::numeric_limits<Real>::infinity()), max(distance - about, T(first_start_)));
  }

  Real begins(const BallNode<Real>& node) const {
    alignas(kAlignment) Real all[kWidth<Real>];
    begins(T(node.center[0]), T(node.center[1]), T(node.center[2]), T(node.radius)).store(all);
    return all[0];
  }

  /// Meets those balls of a leaf that the cone comes near to.
  void meet(const BallLeaf<Real>& leaf) {
    alignas(kAlignment) Real from[kBallsOfLeaf];
    std::uint64_t near = 0;
    for (std::size_t i = 0; i < kBallsOfLeaf; i += kWidth<Real>) {
      const T first = begins(T::load(leaf.x + i), T::load(leaf.y + i), T::load(leaf.z + i), T::load(leaf.radius + i));
      first.store(from + i);
      near |= (!(first >= T(last_))).bits() << i;
    }
    for (; near != 0; near &= near - 1) {
      const auto i = static_cast<std::size_t>(__builtin_ctzll(near));
      meet(leaf.x[i], leaf.y[i], leaf.z[i], leaf.radius[i], from[i]);
    }
    find_last();
  }

  void find_last() {
    last_ = -std::numeric_limits<Real>::infinity();
    for (const Real last : last_of_batch_) last_ = last > last_ ? last : last_;
    last_ = last_ < t_max_ ? last_ : t_max_;
  }

  void meet(Real ball_x, Real ball_y, Real ball_z, Real radius, Real from) {
    const T zero = Real(0);
    const T infinity = std::numeric_limits<Real>::infinity();
    for (std::size_t lane = 0; lane < kLanes; lane += kWidth<Real>) {
      if (from >= last_of_batch_[lane / kWidth<Real>]) continue;
      const std::size_t i = first_ + lane;
      const T dx = at(rays_.dx, i);
      const T dy = at(rays_.dy, i);
      const T dz = at(rays_.dz, i);
      const T px = T(ball_x) - at(rays_.ox, i);
      const T py = T(ball_y) - at(rays_.oy, i);
      const T pz = T(ball_z) - at(rays_.oz, i);
      const T along = px * dx + py * dy + pz * dz;
      const T epsilon = T::load(room_ + lane) + T(growth_) * (abs(along) + abs(T(radius)));
      const T reach = T(radius) + epsilon + select(epsilon > T(balls_.trusted_epsilon), T(balls_.blend), zero);
      const T within = square(reach) - (square(px - along * dx) + square(py - along * dy) + square(pz - along * dz));
      const T half = sqrt(max(within, zero));
      const T start = at(rays_.start, i);
      const Mask<Real> misses = (within < zero) | (reach < zero) | (along + half < start);
      const T enter = select(misses, infinity, max(along - half, start));
      const T before = T::load(enter_ + lane);
      if ((enter < before).bits() == 0) continue;
      const T first = min(enter, before);
      first.store(enter_ + lane);
      last_of_batch_[lane / kWidth<Real>] = largest_lane(first);
    }
  }

  const BallsView<Real>& balls_;
  const RayView<Real>& rays_;
  std::size_t first_;
  Real per_rest_, growth_;
  Real o_[3], d_[3];
  Real width_, spread_, t_max_, per_length_;
  Real room_of_all_ = 0;
  Real first_start_ = 0;
  Real last_ = 0;  ///< where the last ray enters, as far as is known
  Real last_of_batch_[kLanes / kWidth<Real>];
  alignas(kAlignment) Real room_[kLanes];
  alignas(kAlignment) Real enter_[kLanes];
};

template <class Real>
void enter_balls(const BallsView<Real>& balls, const RayView<Real>& rays, std::size_t block,
                 const ConeView<Real>& cones, Real epsilon_slope, Real* start, Real* end) {
  BallsOfBlock<Real> of_block(balls, rays, block, cones, epsilon_slope);
  of_block.find();
  of_block.write(start, end);
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
