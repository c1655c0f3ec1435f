// Operations that textures are made of: gradient noise, and lookups in images.
#pragma once

#include "octomarch/ops/expression.hpp"

namespace octomarch::ops {

/// Gradient noise (K. Perlin, "Improving noise", SIGGRAPH 2002) over a lattice whose corners are hashed by permutation
/// polynomials (S. Gustavson, I. McEwan, "Efficient computational noise in GLSL", 2012): whole numbers below 2²⁴, exact in
/// every precision, so that all of them agree on the gradients. Repeats every 289 units. Constants: seed mod 289.
template <class C>
struct Noise {
  C seed;
  template <class Real>
  explicit Noise(const Real* p) : seed(p[0]) {}

  template <class T>
  T operator()(const T& x, const T& y, const T& z) const {
    const C i = floor(value_of(x));
    const C j = floor(value_of(y));
    const C k = floor(value_of(z));
    const T fx = x - i;
    const T fy = y - j;
    const T fz = z - k;
    const T u = fade(fx);
    const T v = fade(fy);
    const T w = fade(fz);
    const auto corner = [&](int di, int dj, int dk) {
      const C one[2] = {C(0), C(1)};
      const C hash = permuted(permuted(permuted(k + one[dk] + seed) + (j + one[dj])) + (i + one[di]));
      return along_gradient(hash, fx - one[di], fy - one[dj], fz - one[dk]);
    };
    const auto mixed = [](const T& a, const T& b, const T& weight) { return a + (b - a) * weight; };
    const T near = mixed(mixed(corner(0, 0, 0), corner(1, 0, 0), u), mixed(corner(0, 1, 0), corner(1, 1, 0), u), v);
    const T far = mixed(mixed(corner(0, 0, 1), corner(1, 0, 1), u), mixed(corner(0, 1, 1), corner(1, 1, 1), u), v);
    return mixed(near, far, w);
  }

 private:
  /// a mod 289, of whole numbers.
  static C reduced(const C& a) { return a - C(289) * floor((a + C(0.5F)) * C(kInverse)); }
  static C permuted(const C& a) {
    const C b = reduced(a);
    return reduced((C(34) * b + C(1)) * b);
  }

  /// 6t⁵ − 15t⁴ + 10t³.
  template <class T>
  static T fade(const T& t) {
    return t * t * t * (t * (t * C(6) - C(15)) + C(10));
  }

  /// The offset's component along the hash-th of the 12 directions to a cube's edges.
  template <class T>
  static T along_gradient(const C& hash, const T& x, const T& y, const T& z) {
    const C index = hash - C(12) * floor((hash + C(0.5F)) * C(kTwelfth));
    const C plane = floor(index * C(0.25F));
    const C signs = index - plane * C(4);
    const auto in_yz = plane == C(2);
    const T first = select(in_yz, y, x);
    const T second = select(plane == C(0), y, z);
    const auto first_down = signs >= C(2);
    const auto second_down = (signs == C(1)) | (signs == C(3));
    return select(first_down, -first, first) + select(second_down, -second, second);
  }

  using Real = typename C::Real;
  static constexpr Real kInverse = Real(1) / Real(289);
  static constexpr Real kTwelfth = Real(1) / Real(12);
};

/// RGB of an image at (u, v), bilinear. Texel (i, j) has its centre at ((i + ½)/width, 1 − (j + ½)/height). Constants:
/// number of the image, wrap (see nodes.def).
template <class C>
struct Texel {
  const float* texels;
  C width, height;
  bool repeats_across, repeats_down;
  template <class Real, class Images>
  Texel(const Real* p, const Images* images)
      : texels(images[static_cast<int>(p[0])].texels),
        width(static_cast<Real>(images[static_cast<int>(p[0])].width)),
        height(static_cast<Real>(images[static_cast<int>(p[0])].height)),
        repeats_across(p[1] != Real(0)),
        repeats_down(p[1] == Real(1)) {}

  template <class T>
  Triple<T> operator()(const T& u, const T& v) const {
    const T column = u * width - C(kHalf);
    const T row = (C(1) - v) * height - C(kHalf);
    const C left = floor(value_of(column));
    const C top = floor(value_of(row));
    const C columns[2] = {held(left, width, repeats_across), held(left + C(1), width, repeats_across)};
    const C rows[2] = {held(top, height, repeats_down), held(top + C(1), height, repeats_down)};
    const T right = column - left;
    const T down = row - top;
    C corners[4][3];
    for (int corner = 0; corner < 4; ++corner) fetch(columns[corner % 2], rows[corner / 2], corners[corner]);
    const auto channel = [&](int c) {
      const T upper = right * (corners[1][c] - corners[0][c]) + corners[0][c];
      const T lower = right * (corners[3][c] - corners[2][c]) + corners[2][c];
      return upper + (lower - upper) * down;
    };
    return {channel(0), channel(1), channel(2)};
  }

 private:
  using Real = typename C::Real;
  static constexpr Real kHalf = Real(0.5);

  /// A whole index brought into [0, size), by repetition or by holding the edge; 0 where it is no number.
  static C held(const C& index, const C& size, bool repeats) {
    const C wrapped = repeats ? index - size * floor(index / size) : index;
    const C clamped = min(max(wrapped, C(0)), size - C(1));
    return select(clamped == clamped, clamped, C(0));
  }

  /// Lane by lane: what is read lies anywhere.
  void fetch(const C& column, const C& row, C (&rgb)[3]) const {
    alignas(64) Real index[C::kWidth];
    alignas(64) Real channels[3][C::kWidth];
    alignas(64) Real row_index[C::kWidth];
    alignas(64) Real widths[C::kWidth];
    column.store(index);
    row.store(row_index);
    width.store(widths);
    for (std::size_t lane = 0; lane < C::kWidth; ++lane) {
      const auto texel = static_cast<std::size_t>(row_index[lane]) * static_cast<std::size_t>(widths[0]) +
                         static_cast<std::size_t>(index[lane]);
      for (std::size_t c = 0; c < 3; ++c) channels[c][lane] = static_cast<Real>(texels[3 * texel + c]);
    }
    for (std::size_t c = 0; c < 3; ++c) rgb[c] = C::load(channels[c]);
  }
};

}  // namespace octomarch::ops
