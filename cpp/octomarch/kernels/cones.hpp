// Cones about neighbouring camera rays, which are marched before these: nothing is nearer to them than where their cone ends. A
// cone's points are o + t·d, o and d being the middles of the boxes that the rays' origins and directions fill. camera.hpp comes
// before; steps.hpp says how they are marched.
#pragma once

#include "octomarch/kernels/lanes.hpp"
#include "octomarch/kernels/packets.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

template <class Real>
using Columns = const Column<Real>* [3];

template <class Real>
Real largest_lane(const Lanes<Real>& batch) {
  alignas(kAlignment) Real lanes[kWidth<Real>];
  batch.store(lanes);
  Real result = lanes[0];
  for (const Real lane : lanes) result = lane > result ? lane : result;
  return result;
}

/// The largest of sign times the numbers of a column over the block that begins at `first`; −∞ where all are NaN.
template <class Real>
Real largest(const Column<Real>& column, std::size_t first, Real sign) {
  using T = Lanes<Real>;
  if (column.values == nullptr) return sign * column.value;
  T result = -std::numeric_limits<Real>::infinity();
  for (std::size_t i = first; i < first + kLanes; i += kWidth<Real>) result = max(T(sign) * at(column, i), result);
  return largest_lane(result);
}

/// Puts the middle of a vector's range over a block of rays into a row; returns how far the farthest is from it.
template <class Real>
Real set_middle(const Columns<Real>& columns, std::size_t first, const Vectors<Real>& out, std::size_t index) {
  using T = Lanes<Real>;
  Real* const rows[3] = {out.x, out.y, out.z};
  Real middle[3];
  bool is_one = true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Real lo = -largest(*columns[axis], first, Real(-1));
    const Real hi = largest(*columns[axis], first, Real(1));
    rows[axis][index] = middle[axis] = lo + (hi - lo) * Real(0.5);
    is_one = is_one && columns[axis]->values == nullptr;
  }
  if (is_one) return 0;
  T farthest = Real(0);
  for (std::size_t i = first; i < first + kLanes; i += kWidth<Real>) {
    const T x = at(*columns[0], i) - T(middle[0]);
    const T y = at(*columns[1], i) - T(middle[1]);
    const T z = at(*columns[2], i) - T(middle[2]);
    farthest = max(x * x + y * y + z * z, farthest);
  }
  return largest_lane(sqrt(Lanes<Real>(largest_lane(farthest))));
}

template <class Real>
void fit_cones(const RayView<Real>& rays, const ConeView<Real>& cones) {
  for (std::size_t first = 0, i = 0; first < rays.count; first += kLanes, ++i) {
    cones.width[i] = set_middle<Real>({&rays.ox, &rays.oy, &rays.oz}, first, cones.origin, i);
    cones.spread[i] = set_middle<Real>({&rays.dx, &rays.dy, &rays.dz}, first, cones.direction, i);
    cones.epsilon[i] = largest(rays.epsilon, first, Real(1));
    cones.t_max[i] = largest(rays.t_max, first, Real(1));
  }
}

/// Puts cones about 2×2 and 4×4 pixels of one block of camera rays.
template <class Real>
class SmallConesOfBlock {
  using T = Lanes<Real>;
  static constexpr std::size_t kRays = kLanes / kSmallestCones;        ///< in a smallest cone
  static constexpr std::size_t kParts = kSmallestCones / kSmallCones;  ///< smallest cones in a small one

 public:
  SmallConesOfBlock(std::size_t block, const ConeView<Real>& small, const ConeView<Real>& smallest)
      : first_(block * kLanes),
        small_(block * kSmallCones),
        smallest_(block * kSmallestCones),
        cones_{small, smallest} {}

  void fit(const RayView<Real>& rays) {
    fit_vectors({&rays.ox, &rays.oy, &rays.oz}, &ConeView<Real>::origin, &ConeView<Real>::width);
    fit_vectors({&rays.dx, &rays.dy, &rays.dz}, &ConeView<Real>::direction, &ConeView<Real>::spread);
    find_largest(rays.epsilon, &ConeView<Real>::epsilon);
    find_largest(rays.t_max, &ConeView<Real>::t_max);
  }

 private:
  /// A number for each smallest cone, those of the k-th parts of all small ones side by side.
  struct alignas(kAlignment) Row {
    Real of[kSmallestCones];
    T load(std::size_t i) const { return T::load(of + i); }
  };
  /// Which lane is the first, second, … ray of each smallest cone.
  struct Order {
    std::uint8_t lane[kRays][kSmallestCones] = {};
    constexpr Order() {
      std::size_t rays[kSmallestCones] = {};
      for (std::size_t i = 0; i < kLanes; ++i) {
        const std::size_t cone = smallest_cone_about(i);
        lane[rays[cone]++][cone] = static_cast<std::uint8_t>(i);
      }
    }
  };
  static constexpr Order kOrder{};

  /// Their first, second, … rays.
  void read(const Column<Real>& column, Row* rows) const {
    for (std::size_t ray = 0; ray < kRays; ++ray) {
      for (std::size_t i = 0; i < kSmallestCones; ++i) {
        rows[ray].of[i] = column.values == nullptr ? column.value : column.values[first_ + kOrder.lane[ray][i]];
      }
    }
  }

  template <class Function>
  static void for_each_of_row(Function&& f) {
    for (std::size_t i = 0; i < kSmallestCones; i += kWidth<Real>) f(i);
  }

  void fit_vectors(const Columns<Real>& columns, Vectors<Real> ConeView<Real>::* middle,
                   Real* ConeView<Real>::* reach) {
    Row rays[3][kRays];
    for (std::size_t axis = 0; axis < 3; ++axis) read(*columns[axis], rays[axis]);
    Row middles[3];
    Row reaches;
    for_each_of_row([&](std::size_t i) {
      T at[3];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        T lo = std::numeric_limits<Real>::infinity();
        T hi = -lo;
        for (const Row& ray : rays[axis]) {  // a NaN is no number's lesser or greater
          lo = min(ray.load(i), lo);
          hi = max(ray.load(i), hi);
        }
        at[axis] = lo + (hi - lo) * T(Real(0.5));
        at[axis].store(middles[axis].of + i);
      }
      T farthest = Real(0);
      for (std::size_t ray = 0; ray < kRays; ++ray) {
        farthest = max(square(rays[0][ray].load(i) - at[0]) + square(rays[1][ray].load(i) - at[1]) +
                           square(rays[2][ray].load(i) - at[2]),
                       farthest);
      }
      sqrt(farthest).store(reaches.of + i);
    });
    write(middles, reaches, cones_[1].*middle, cones_[1].*reach, smallest_, kSmallestCones);
    unite(middles, reaches);
    write(middles, reaches, cones_[0].*middle, cones_[0].*reach, small_, kSmallCones);
  }

  /// From smallest cones to small ones: a ray is no farther from the middle than the middle of its smallest cone, and it from that.
  static void unite(Row* middles, Row& reaches) {
    Row wide[3];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t i = 0; i < kSmallCones; ++i) {
        Real lo = std::numeric_limits<Real>::infinity();
        Real hi = -lo;
        for (std::size_t part = i; part < kSmallestCones; part += kSmallCones) {
          const Real at = middles[axis].of[part];
          lo = at < lo ? at : lo;
          hi = at > hi ? at : hi;
        }
        for (std::size_t part = i; part < kSmallestCones; part += kSmallCones) {
          wide[axis].of[part] = lo + (hi - lo) * Real(0.5);
        }
      }
    }
    for_each_of_row([&](std::size_t i) {
      const auto off = [&](std::size_t axis) { return middles[axis].load(i) - wide[axis].load(i); };
      (sqrt(square(off(0)) + square(off(1)) + square(off(2))) + reaches.load(i)).store(reaches.of + i);
    });
    keep_largest(reaches);
    for (std::size_t axis = 0; axis < 3; ++axis) middles[axis] = wide[axis];
  }

  /// Of the parts of each small cone.
  static void keep_largest(Row& row) {
    for (std::size_t part = kSmallCones; part < kSmallestCones; ++part) {
      Real& largest = row.of[part % kSmallCones];
      if (row.of[part] > largest || !(largest == largest)) largest = row.of[part];
    }
  }

  static void write(const Row* middles, const Row& reaches, const Vectors<Real>& to, Real* reach, std::size_t at,
                    std::size_t count) {
    __builtin_memcpy(to.x + at, middles[0].of, count * sizeof(Real));
    __builtin_memcpy(to.y + at, middles[1].of, count * sizeof(Real));
    __builtin_memcpy(to.z + at, middles[2].of, count * sizeof(Real));
    __builtin_memcpy(reach + at, reaches.of, count * sizeof(Real));
  }

  void find_largest(const Column<Real>& column, Real* ConeView<Real>::* to) const {
    Row rays[kRays];
    read(column, rays);
    for (std::size_t ray = 1; ray < kRays; ++ray) {
      for_each_of_row([&](std::size_t i) { max(rays[ray].load(i), rays[0].load(i)).store(rays[0].of + i); });
    }
    __builtin_memcpy(cones_[1].*to + smallest_, rays[0].of, kSmallestCones * sizeof(Real));
    keep_largest(rays[0]);
    __builtin_memcpy(cones_[0].*to + small_, rays[0].of, kSmallCones * sizeof(Real));
  }

  std::size_t first_, small_, smallest_;
  const ConeView<Real> cones_[2];
};

template <class Real>
void fit_small_cones(const RayView<Real>& rays, std::size_t block, const ConeView<Real>& small,
                     const ConeView<Real>& smallest) {
  SmallConesOfBlock<Real>(block, small, smallest).fit(rays);
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
