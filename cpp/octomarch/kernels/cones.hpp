// The prepass of camera rays: one cone about each block of them is marched first, and the rays begin where it ends. A cone's
// points are o + t·d, o and d being the middles of the boxes that the rays' origins and directions fill. camera.hpp comes
// before, march.hpp after.
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
void fit_cones(const RayView<Real>& rays, const MarchParameters<Real>& parameters, const ConeView<Real>& cones) {
  for (std::size_t i = 0; i < cones.count; ++i) {
    const std::size_t first = i * kLanes;
    cones.width[i] = set_middle<Real>({&rays.ox, &rays.oy, &rays.oz}, first, cones.origin, i);
    cones.spread[i] = set_middle<Real>({&rays.dx, &rays.dy, &rays.dz}, first, cones.direction, i);
    cones.epsilon[i] = largest(rays.epsilon, first, Real(1));
    cones.t_max[i] = largest(rays.t_max, first, Real(1));
    cones.t[i] = parameters.t_min;
  }
}

template <class Real>
void cone_points(const ConeView<Real>& cones, const Vectors<Real>& points) {
  using T = Lanes<Real>;
  for (std::size_t i = 0; i < cones.count; i += kWidth<Real>) {
    const T t = T::load(cones.t + i);
    (T::load(cones.origin.x + i) + t * T::load(cones.direction.x + i)).store(points.x + i);
    (T::load(cones.origin.y + i) + t * T::load(cones.direction.y + i)).store(points.y + i);
    (T::load(cones.origin.z + i) + t * T::load(cones.direction.z + i)).store(points.z + i);
  }
}

/// Where the field is r, all rays of a cone are free as far as t + r less the cone's width there. A cone ends where it would
/// gain less than a quarter of its width, or no more than rays take for a hit.
template <class Real>
std::uint64_t step_cones(const ConeView<Real>& cones, const MarchParameters<Real>& parameters, const Real* field,
                         std::uint64_t live) {
  using T = Lanes<Real>;
  const T margin = Real(1.01);  // for what rounding adds to the width
  std::uint64_t goes_on = 0;
  for (std::size_t i = 0; i < cones.count; i += kWidth<Real>) {
    const T t = T::load(cones.t + i);
    const T r = T::load(field + i) * T(parameters.step_scale) - T(parameters.bias);
    const T width = (T::load(cones.width + i) + T::load(cones.spread + i) * t) * margin;
    const T epsilon = max(T::load(cones.epsilon + i), T(parameters.epsilon_slope) * t);
    const T gain = r - width - epsilon;
    const Mask<Real> gains = (gain > width * T(Real(0.25))) & (gain > epsilon) & (t <= T::load(cones.t_max + i)) &
                             Mask<Real>::from_bits(live >> i);
    select(gains, t + gain, t).store(cones.t + i);
    goes_on |= gains.bits() << i;
  }
  return goes_on & live;
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
