// The field at given points: distances, gradients, normals, and ambient occlusion along them. Each walks its points in
// blocks through the tape interpreter. The march comes before; shade.hpp uses what is found here.
#pragma once

#include <limits>

#include "octomarch/kernels/evaluate.hpp"

namespace octomarch::kernels::OCTOMARCH_ISA {

template <class Real>
inline constexpr Real kNaN = std::numeric_limits<Real>::quiet_NaN();

/// Lanes of the block that begins at `first`.
inline std::size_t lanes_in_block(std::size_t first, std::size_t count) {
  return count - first < kLanes ? count - first : kLanes;
}

template <class Real>
void distance(const TapeView<Real>& tape, Real* registers, const Vectors<const Real>& points, std::size_t count,
              const bool* cancelled, Real* out) {
  using T = Lanes<Real>;
  for (std::size_t first = 0; first < count && !is_set(cancelled); first += kLanes) {
    const std::size_t n = batches<Real>(lanes_in_block(first, count));
    // minima drop a NaN operand, so a NaN coordinate has to be looked for
    std::uint64_t numbers = 0;
    for (std::size_t lane = 0; lane < n * kWidth<Real>; lane += kWidth<Real>) {
      const T x = T::load(points.x + first + lane);
      const T y = T::load(points.y + first + lane);
      const T z = T::load(points.z + first + lane);
      x.store(registers + lane);
      y.store(registers + kLanes + lane);
      z.store(registers + 2 * kLanes + lane);
      numbers |= ((x == x) & (y == y) & (z == z)).bits() << lane;
    }
    const Real* const field = numbers == 0 ? registers : evaluate(tape, registers, n);
    for (std::size_t lane = 0; lane < n * kWidth<Real>; lane += kWidth<Real>) {
      const Mask<Real> is_number = Mask<Real>::from_bits(numbers >> lane);
      select(is_number, T::load(field + lane), T(kNaN<Real>)).store(out + first + lane);
    }
  }
}

template <class Real>
void expressions(const TapeView<Real>& tape, Real* registers, const Vectors<const Real>& points,
                 const Vectors<const Real>* normals, std::size_t count, const bool* cancelled,
                 const std::uint16_t* results, std::size_t result_count, Real* const* outs) {
  using T = Lanes<Real>;
  for (std::size_t first = 0; first < count && !is_set(cancelled); first += kLanes) {
    const std::size_t n = batches<Real>(lanes_in_block(first, count));
    const auto copy = [n](const Real* from, Real* to) {
      for (std::size_t lane = 0; lane < n * kWidth<Real>; lane += kWidth<Real>) T::load(from + lane).store(to + lane);
    };
    const auto place = [&](const Vectors<const Real>& rows, std::size_t input) {
      copy(rows.x + first, registers + input * kLanes);
      copy(rows.y + first, registers + (input + 1) * kLanes);
      copy(rows.z + first, registers + (input + 2) * kLanes);
    };
    place(points, 0);
    if (normals != nullptr) place(*normals, 3);
    evaluate(tape, registers, n);
    for (std::size_t i = 0; i < result_count; ++i) copy(registers + results[i] * kLanes, outs[i] + first);
  }
}

template <class Real>
void gradient(const TapeView<Real>& tape, Real* registers, const Vectors<const Real>& points, std::size_t count,
              const bool* cancelled, const Vectors<Real>& out) {
  using T = Lanes<Real>;
  const T nan = kNaN<Real>;
  for (std::size_t first = 0; first < count && !is_set(cancelled); first += kLanes) {
    const std::size_t n = batches<Real>(lanes_in_block(first, count));
    std::uint64_t finite = 0;  // known derivatives hide a NaN, as minima do, and an infinity times 0
    for (std::size_t lane = 0; lane < n * kWidth<Real>; lane += kWidth<Real>) {
      const T x = T::load(points.x + first + lane);
      const T y = T::load(points.y + first + lane);
      const T z = T::load(points.z + first + lane);
      x.store(registers + lane);
      y.store(registers + 4 * kLanes + lane);
      z.store(registers + 8 * kLanes + lane);
      finite |= ((x - x) + (y - y) + (z - z) == T(Real(0))).bits() << lane;
    }
    const Real* field = evaluate_dual(tape, registers, n);
    for (std::size_t lane = 0; lane < n * kWidth<Real>; lane += kWidth<Real>) {
      const Mask<Real> is_finite = Mask<Real>::from_bits(finite >> lane);
      select(is_finite, T::load(field + kLanes + lane), nan).store(out.x + first + lane);
      select(is_finite, T::load(field + 2 * kLanes + lane), nan).store(out.y + first + lane);
      select(is_finite, T::load(field + 3 * kLanes + lane), nan).store(out.z + first + lane);
    }
  }
}

template <class Real>
void sample_around(const TapeView<Real>& tape, Real* registers, const Vectors<const Real>& points, std::size_t count,
                   const StencilView<Real>& stencil, const bool* cancelled, const Vectors<Real>& out) {
  using T = Lanes<Real>;
  const Real* const coordinates[3] = {points.x, points.y, points.z};
  Real* const results[3] = {out.x, out.y, out.z};
  for (std::size_t first = 0; first < count; first += kLanes) {
    const std::size_t n = batches<Real>(lanes_in_block(first, count));
    for (Real* result : results) {
      for (std::size_t lane = 0; lane < n * kWidth<Real>; lane += kWidth<Real>) T(Real(0)).store(result + first + lane);
    }
    for (std::size_t i = 0; i < stencil.count; ++i) {
      if (is_set(cancelled)) return;
      const Real* const offset = stencil.offsets + 3 * i;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const T moved = stencil.step * offset[axis];
        for (std::size_t lane = 0; lane < n * kWidth<Real>; lane += kWidth<Real>) {
          (T::load(coordinates[axis] + first + lane) + moved).store(registers + axis * kLanes + lane);
        }
      }
      const Real* const field = evaluate(tape, registers, n);
      for (std::size_t lane = 0; lane < n * kWidth<Real>; lane += kWidth<Real>) {
        const T value = T::load(field + lane);
        const T weight = stencil.counted ? select(value < T(Real(0)), T(Real(-1)), T(Real(0))) : value;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          Real* const sum = results[axis] + first + lane;
          (T::load(sum) + weight * T(offset[axis])).store(sum);
        }
      }
    }
  }
}

/// Has a vector of this length, squared, a direction?
template <class T>
auto is_usable(const T& length2) {
  using Real = typename T::Real;
  return (length2 > T(Real(0))) & (length2 < T(std::numeric_limits<Real>::infinity()));
}

/// v / ‖v‖, or `otherwise` where v has no usable length.
template <class T>
ops::Triple<T> unit_or(const ops::Triple<T>& v, const ops::Triple<T>& otherwise) {
  using Real = typename T::Real;
  const T length2 = square(v.x) + square(v.y) + square(v.z);
  const auto usable = is_usable(length2);
  const T inverse = T(Real(1)) / sqrt(length2);
  return {select(usable, v.x * inverse, otherwise.x), select(usable, v.y * inverse, otherwise.y),
          select(usable, v.z * inverse, otherwise.z)};
}

template <class Real>
ops::Triple<Lanes<Real>> load3(const Vectors<Real>& rows, std::size_t i) {
  return {Lanes<Real>::load(rows.x + i), Lanes<Real>::load(rows.y + i), Lanes<Real>::load(rows.z + i)};
}

template <class Real>
void store3(const ops::Triple<Lanes<Real>>& v, const Vectors<Real>& rows, std::size_t i) {
  v.x.store(rows.x + i);
  v.y.store(rows.y + i);
  v.z.store(rows.z + i);
}

/// Elements of an array by their indices. Those of neighbours, as most are, are loaded at once.
template <class Real>
Lanes<Real> gathered(const Column<Real>& column, const std::uint32_t* indices, bool are_neighbours) {
  if (column.values == nullptr) return column.value;
  if (are_neighbours) return Lanes<Real>::load_unaligned(column.values + indices[0]);
  alignas(kAlignment) Real lanes[kWidth<Real>];
  for (std::size_t lane = 0; lane < kWidth<Real>; ++lane) lanes[lane] = column.values[indices[lane]];
  return Lanes<Real>::load(lanes);
}

template <class Real>
void surface_points(const RayView<Real>& rays, Real epsilon_slope, const Real* t, const std::uint32_t* indices,
                    const SurfaceView<Real>& surface) {
  using T = Lanes<Real>;
  std::uint32_t padded[kWidth<Real>];
  for (std::size_t i = 0; i < surface.count; i += kWidth<Real>) {
    const bool is_whole = surface.count - i >= kWidth<Real>;
    for (std::size_t lane = 0; !is_whole && lane < kWidth<Real>; ++lane) {  // the last one fills the batch
      padded[lane] = indices[i + lane < surface.count ? i + lane : surface.count - 1];
    }
    const std::uint32_t* const own = is_whole ? indices + i : padded;
    const bool are_neighbours = is_whole && own[kWidth<Real> - 1] - own[0] == kWidth<Real> - 1;  // indices ascend
    const auto of = [&](const Column<Real>& column) { return gathered(column, own, are_neighbours); };
    const T at_t = of({t, 0});
    const ops::Triple<T> d{of(rays.dx), of(rays.dy), of(rays.dz)};
    store3(d, surface.direction, i);
    store3<Real>({of(rays.ox) + at_t * d.x, of(rays.oy) + at_t * d.y, of(rays.oz) + at_t * d.z}, surface.position, i);
    max(of(rays.epsilon), T(epsilon_slope) * at_t).store(surface.epsilon + i);
  }
}

template <class Real>
std::size_t normalize(const SurfaceView<Real>& surface) {
  std::size_t without = 0;
  const std::size_t end = batches<Real>(surface.count) * kWidth<Real>;
  for (std::size_t i = 0; i < end; i += kWidth<Real>) {
    const auto d = load3(surface.direction, i);
    const auto n = load3(surface.normal, i);
    const std::size_t lanes = surface.count - i;
    const std::uint64_t used = lanes < kLanes ? (std::uint64_t{1} << lanes) - 1 : ~std::uint64_t{0};
    const std::uint64_t usable = is_usable(square(n.x) + square(n.y) + square(n.z)).bits();
    const std::uint64_t batch = ~std::uint64_t{0} >> (kLanes - kWidth<Real>);
    without += static_cast<std::size_t>(__builtin_popcountll(~usable & used & batch));
    store3({unit_or(n, {-d.x, -d.y, -d.z})}, surface.normal, i);
  }
  return without;
}

template <class Real>
void face_rays(const SurfaceView<Real>& surface) {
  using T = Lanes<Real>;
  const std::size_t end = batches<Real>(surface.count) * kWidth<Real>;
  for (std::size_t i = 0; i < end; i += kWidth<Real>) {
    const auto n = load3(surface.normal, i);
    const auto d = load3(surface.direction, i);
    const auto p = load3(surface.position, i);
    const T away = max(n.x * d.x + n.y * d.y + n.z * d.z, T(Real(0)));
    const auto sideways = unit_or<T>({n.x - d.x * away, n.y - d.y * away, n.z - d.z * away}, {-d.x, -d.y, -d.z});
    const Mask<Real> turned = away > T(Real(0));
    const ops::Triple<T> facing{select(turned, sideways.x, n.x), select(turned, sideways.y, n.y),
                                select(turned, sideways.z, n.z)};
    store3(facing, surface.facing, i);
    const T offset = T::load(surface.epsilon + i) * T(Real(2));
    store3<Real>({p.x + facing.x * offset, p.y + facing.y * offset, p.z + facing.z * offset}, surface.origin, i);
  }
}

template <class Real>
void mirror_rays(const SurfaceView<Real>& surface, Real offset, const Vectors<Real>& origin,
                 const Vectors<Real>& direction) {
  using T = Lanes<Real>;
  const std::size_t end = batches<Real>(surface.count) * kWidth<Real>;
  for (std::size_t i = 0; i < end; i += kWidth<Real>) {
    const auto p = load3(surface.position, i);
    const auto n = load3(surface.facing, i);
    const auto d = load3(surface.direction, i);
    const T along = d.x * n.x + d.y * n.y + d.z * n.z;
    const T twice = along + along;
    store3<Real>({d.x - twice * n.x, d.y - twice * n.y, d.z - twice * n.z}, direction, i);
    const T height = max(T(offset), T::load(surface.epsilon + i) * T(Real(2)));
    store3<Real>({p.x + height * n.x, p.y + height * n.y, p.z + height * n.z}, origin, i);
  }
}

template <class Real>
void occlusion_points(const SurfaceView<Real>& surface, Real height, const Vectors<Real>& points) {
  using T = Lanes<Real>;
  const T h = height;
  for (std::size_t i = 0; i < surface.count; i += kWidth<Real>) {
    const auto o = load3(surface.origin, i);
    const auto n = load3(surface.facing, i);
    store3<Real>({o.x + n.x * h, o.y + n.y * h, o.z + n.z * h}, points, i);
  }
}

template <class Real>
void add_occlusion(const Real* field, std::size_t count, Real height, Real weight, Real* occlusion) {
  using T = Lanes<Real>;
  for (std::size_t i = 0; i < count; i += kWidth<Real>) {
    // a sample inside a solid lacks all of its height, no more
    const T lacking = min(max(T(height) - T::load(field + i), T(Real(0))), T(height));
    (T::load(occlusion + i) + T(weight) * lacking).store(occlusion + i);
  }
}

template <class Real>
void ambient_visibility(std::size_t count, Real most, Real* occlusion) {
  using T = Lanes<Real>;
  for (std::size_t i = 0; i < count; i += kWidth<Real>) {
    (T(Real(1)) - min(T::load(occlusion + i) / T(most), T(Real(1)))).store(occlusion + i);
  }
}

}  // namespace octomarch::kernels::OCTOMARCH_ISA
