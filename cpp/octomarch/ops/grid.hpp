// Fields that are known by samples on a grid: trilinear and tricubic lookup, and how they go on outside of the box of
// their samples.
#pragma once

#include <cstddef>

#include "octomarch/base/dual.hpp"
#include "octomarch/ops/number.hpp"

namespace octomarch::ops {

/// Where the constants of both kinds of grid stand: the array's number, a factor for all samples, how steep the box is;
/// for each axis the place of the first sample, samples per unit (< 0 where they follow each other downward), middle and
/// half edge of the box. What stands after those is for the compiler: the whole field's Lipschitz bound, and between what
/// the interpolant stays.
enum GridConstant : std::size_t {
  kGridArray,
  kGridScale,
  kGridSteepness,
  kGridAxes,
  kGridAxisConstants = 4,
  kGridLipschitz = kGridAxes + 3 * kGridAxisConstants,
  kGridLeast,
  kGridMost,
  kGridConstants
};

/// A point between two samples along an axis: the cell, and from 0 to 1 where in it.
template <class C, class T>
struct GridPlace {
  C cell;
  T within;
};

template <class C>
struct GridAxis {
  C first, rate, middle, half, cells;
  template <class Real>
  GridAxis(const Real* p, Real samples) : first(p[0]), rate(p[1]), middle(p[2]), half(p[3]), cells(samples - Real(1)) {}

  /// Of the nearest point of the box. Its slope on the box's faces is that inside; what is no number counts as 0, so that
  /// every cell is one that there is.
  template <class T>
  GridPlace<C, T> place(const T& x) const {
    const T along = (x - first) * rate;
    const C& u = value_of(along);
    const T held = select(u > cells, Lift<T>::from(cells), select(u >= C(0), along, Lift<T>::from(C(0))));
    const C cell = min(floor(value_of(held)), cells - C(1));
    return {cell, held - cell};
  }

  template <class T>
  T excess(const T& x) const {
    return abs(x - middle) - half;
  }
};

/// What both kinds of lookup have in common. `samples` in the order of ImageView; width · height ≤ 2²⁴, so that rows of
/// samples have exact numbers in every precision.
template <class C>
struct GridBox {
  using Real = typename C::Real;

  const float* samples;
  std::ptrdiff_t depth, layer;
  GridAxis<C> axes[3];
  C height, scale, steepness, zero;

  template <class Images>
  GridBox(const Real* p, const Images* images) : GridBox(p, images[static_cast<int>(p[kGridArray])]) {}

  /// The field, where the interpolant is `value` at the nearest point of the box.
  template <class T>
  T bounded(const T& value, const T& x, const T& y, const T& z) const {
    const T box = box_distance(axes[0].excess(x), axes[1].excess(y), axes[2].excess(z), zero);
    return box_distance(value * scale, box * steepness, zero);
  }

 private:
  template <class Image>
  GridBox(const Real* p, const Image& image)
    requires requires { image.depth; }
      : samples(image.texels),
        depth(image.depth),
        layer(depth * static_cast<std::ptrdiff_t>(image.height)),
        axes{{p + kGridAxes, static_cast<Real>(image.width)},
             {p + kGridAxes + kGridAxisConstants, static_cast<Real>(image.height)},
             {p + kGridAxes + 2 * kGridAxisConstants, static_cast<Real>(image.depth)}},
        height(static_cast<Real>(image.height)),
        scale(p[kGridScale]),
        steepness(p[kGridSteepness]),
        zero(Real(0)) {}
};

/// A number of each lane in memory, where lanes look at places of their own.
template <class C>
struct LaneNumbers {
  alignas(64) typename C::Real of[C::kWidth];

  LaneNumbers() = default;
  explicit LaneNumbers(const C& a) { a.store(of); }
  C lanes() const { return C::load(of); }
  std::ptrdiff_t index(std::size_t lane) const { return static_cast<std::ptrdiff_t>(of[lane]); }
};

/// Trilinear: between the eight samples around.
template <class C>
struct LinearGrid : GridBox<C> {
  using GridBox<C>::GridBox;

  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    const GridPlace<C, T> i = this->axes[0].place(x);
    const GridPlace<C, T> j = this->axes[1].place(y);
    const GridPlace<C, T> k = this->axes[2].place(z);
    LaneNumbers<C> corner[8];
    fetch(i.cell * this->height + j.cell, k.cell, corner);
    const auto edge = [&](std::size_t first) {
      const C low = corner[first].lanes();
      return k.within * (corner[first + 1].lanes() - low) + low;
    };
    const auto mixed = [](const T& low, const T& high, const T& share) { return (high - low) * share + low; };
    const T near = mixed(edge(0), edge(2), j.within);
    const T far = mixed(edge(4), edge(6), j.within);
    return this->bounded(mixed(near, far, i.within), x, y, z);
  }

 private:
  /// The corners of the cell by their numbers, binary: x, y, z.
  void fetch(const C& row, const C& column, LaneNumbers<C> (&corner)[8]) const {
    const LaneNumbers<C> rows(row);
    const LaneNumbers<C> columns(column);
    const std::ptrdiff_t steps[4] = {0, this->depth, this->layer, this->layer + this->depth};
    for (std::size_t lane = 0; lane < C::kWidth; ++lane) {
      const float* const at = this->samples + rows.index(lane) * this->depth + columns.index(lane);
      for (std::size_t edge = 0; edge < 4; ++edge) {
        corner[2 * edge].of[lane] = at[steps[edge]];
        corner[2 * edge + 1].of[lane] = at[steps[edge] + 1];
      }
    }
  }
};

/// Tricubic: through the 64 samples around, by the splines of E. Catmull and R. Rom ("A class of local interpolating
/// splines", 1974), which have continuous slopes; beyond the outermost samples these go on straight.
template <class C>
struct CubicGrid : GridBox<C> {
  using GridBox<C>::GridBox;

  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    const T point[3] = {x, y, z};
    T weights[3][4];
    std::ptrdiff_t places[3][4][C::kWidth];
    const std::ptrdiff_t strides[3] = {this->layer, this->depth, 1};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const GridAxis<C>& along = this->axes[axis];
      const GridPlace<C, T> place = along.place(point[axis]);
      weigh(place, along.cells, weights[axis]);
      for (std::size_t i = 0; i < 4; ++i) {
        const C held = max(min(place.cell + C(static_cast<Real>(i) - Real(1)), along.cells), this->zero);
        const LaneNumbers<C> numbers(held);
        for (std::size_t lane = 0; lane < C::kWidth; ++lane)
          places[axis][i][lane] = numbers.index(lane) * strides[axis];
      }
    }
    const auto row = [&](std::size_t i, std::size_t j) {
      LaneNumbers<C> numbers[4];
      for (std::size_t lane = 0; lane < C::kWidth; ++lane) {
        const float* const at = this->samples + places[0][i][lane] + places[1][j][lane];
        for (std::size_t k = 0; k < 4; ++k) numbers[k].of[lane] = at[places[2][k][lane]];
      }
      return sum(weights[2], [&](std::size_t k) { return numbers[k].lanes(); });
    };
    const auto layer_of = [&](std::size_t i) { return sum(weights[1], [&](std::size_t j) { return row(i, j); }); };
    return this->bounded(sum(weights[0], layer_of), x, y, z);
  }

 private:
  using typename GridBox<C>::Real;

  template <class T, class Term>
  static T sum(const T (&weights)[4], const Term& term) {
    T total = weights[0] * term(0);
    for (std::size_t i = 1; i < 4; ++i) total = total + weights[i] * term(i);
    return total;
  }

  /// Weights of the samples before the cell, at its two ends, and behind it.
  template <class T>
  static void weigh(const GridPlace<C, T>& place, const C& cells, T (&weights)[4]) {
    const T& t = place.within;
    const T rest = C(1) - t;
    const T before = t * square(rest) * C(Real(-0.5));
    const T behind = rest * square(t) * C(Real(-0.5));
    const T low = C(1) - square(t) * (C(Real(2.5)) - t * C(Real(1.5)));
    const T high = t * (t * (C(2) - t * C(Real(1.5))) + C(Real(0.5)));
    // a sample that is not there is 2a − b, from those at the two ends
    const T none = Lift<T>::from(C(0));
    const auto is_first = place.cell == C(0);
    const auto is_last = place.cell == cells - C(1);
    const T low_share = select(is_first, before, none);
    const T high_share = select(is_last, behind, none);
    weights[0] = select(is_first, none, before);
    weights[1] = low + (low_share + low_share) - high_share;
    weights[2] = high + (high_share + high_share) - low_share;
    weights[3] = select(is_last, none, behind);
  }
};

}  // namespace octomarch::ops
