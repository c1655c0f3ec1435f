// Every cell has a bound from the numbers in Bézier's form of its derivatives, between which these lie. The cells with the
// largest bounds are then cut into halves along each axis until the steepest place is known.
#include "octomarch/graph/cubic_slope.hpp"

#include <algorithm>
#include <cmath>
#include <queue>
#include <tuple>
#include <utility>
#include <vector>

namespace octomarch {
namespace {

constexpr double kTight = 1.01;
constexpr std::size_t kMostCandidates = 4096;
constexpr std::size_t kMostCuts = 16384;

using Steepness = std::array<double, 3>;

double squared(const Steepness& a) { return a[0] * a[0] + a[1] * a[1] + a[2] * a[2]; }

Steepness larger_of(const Steepness& a, const Steepness& b) {
  return {std::max(a[0], b[0]), std::max(a[1], b[1]), std::max(a[2], b[2])};
}

/// Five neighbouring layers across x of the samples, with two more beyond each edge that go on straight, as the cubic
/// interpolant does.
class Layers {
 public:
  explicit Layers(const GridSamples& samples)
      : samples_(samples),
        width_(samples.size[2] + 2 * kMargin),
        layer_((samples.size[1] + 2 * kMargin) * width_),
        numbers_(kCount * layer_) {}

  /// Makes layer `i` the one in the middle.
  void centre(std::size_t i) {
    const auto first = static_cast<std::ptrdiff_t>(i) - static_cast<std::ptrdiff_t>(kMargin);
    for (std::size_t l = 0; l < kCount; ++l) load(first + static_cast<std::ptrdiff_t>(l), &numbers_[l * layer_]);
  }

  const double* at(std::size_t j, std::size_t k) const {
    return &numbers_[kMargin * layer_ + (j + kMargin) * width_ + k + kMargin];
  }
  std::array<std::ptrdiff_t, 3> strides() const {
    return {static_cast<std::ptrdiff_t>(layer_), static_cast<std::ptrdiff_t>(width_), 1};
  }

 private:
  static constexpr std::size_t kMargin = 2;
  static constexpr std::size_t kCount = 2 * kMargin + 1;

  /// Layers before the first and after the last are made of the outermost two.
  void load(std::ptrdiff_t i, double* layer) const {
    const auto last = static_cast<std::ptrdiff_t>(samples_.size[0]) - 1;
    const std::ptrdiff_t edge = std::clamp<std::ptrdiff_t>(i, 0, last);
    const std::ptrdiff_t inner = i < 0 ? 1 : last - 1;
    const auto beyond = static_cast<double>(std::abs(i - edge));
    const std::array<std::size_t, 3> strides = samples_.strides();
    for (std::size_t j = 0; j < samples_.size[1]; ++j) {
      const float* const row = samples_.values.data() + j * strides[1];
      const float* const on_edge = row + static_cast<std::size_t>(edge) * strides[0];
      const float* const inside = row + static_cast<std::size_t>(inner) * strides[0];
      double* const to = layer + (j + kMargin) * width_ + kMargin;
      for (std::size_t k = 0; k < samples_.size[2]; ++k) {
        const auto value = static_cast<double>(on_edge[k]);
        to[k] = beyond == 0.0 ? value : value + beyond * (value - static_cast<double>(inside[k]));
      }
      go_on(to, samples_.size[2], 1, 1);
    }
    go_on(layer + kMargin * width_, samples_.size[1], width_, width_);
  }

  /// Continues `count` rows of `width` numbers, `stride` apart, at both ends.
  static void go_on(double* first, std::size_t count, std::size_t stride, std::size_t width) {
    double* const last = first + (count - 1) * stride;
    for (std::size_t n = 1; n <= kMargin; ++n) {
      for (std::size_t k = 0; k < width; ++k) {
        double* const low = first + k;
        double* const high = last + k;
        *(low - n * stride) = *low + static_cast<double>(n) * (*low - low[stride]);
        high[n * stride] = *high + static_cast<double>(n) * (*high - *(high - stride));
      }
    }
  }

  const GridSamples& samples_;
  std::size_t width_;
  std::size_t layer_;
  std::vector<double> numbers_;
};

/// Largest of the numbers in Bézier's form of ∂/∂a of the cubic interpolant that belong to a sample: those of the cells
/// around which are nearest to it. Between them all values of the derivative lie. a, b, c: strides of the axes.
///
/// Along an axis the form of a cell between p₀ and p₁ is p₀, p₀ + m₀/3, p₁ − m₁/3, p₁, m being half the difference of a
/// sample's neighbours; its derivative's is m₀, 3(p₁ − p₀) − m₀ − m₁, m₁.
double steepest_control(const double* at, std::ptrdiff_t a, std::ptrdiff_t b, std::ptrdiff_t c) {
  /// ∂/∂a at the sample, and the middle numbers of the cells before and after it.
  struct Derivative {
    double here, before, after;
  };
  const auto derivative = [&](const double* p) -> Derivative {
    const double far_before = p[-a] - p[-2 * a];
    const double before = p[0] - p[-a];
    const double after = p[a] - p[0];
    const double far_after = p[2 * a] - p[a];
    return {0.5 * (before + after), 2.0 * before - 0.5 * (far_before + after),
            2.0 * after - 0.5 * (before + far_after)};
  };
  Derivative around[3][3];
  for (std::ptrdiff_t j = -1; j <= 1; ++j) {
    for (std::ptrdiff_t k = -1; k <= 1; ++k) around[j + 1][k + 1] = derivative(at + j * b + k * c);
  }
  double result = 0.0;
  for (double Derivative::* const part : {&Derivative::here, &Derivative::before, &Derivative::after}) {
    double across[3][3];  // by the number along b, and the column along c
    for (std::size_t k = 0; k < 3; ++k) {
      const double third = (around[2][k].*part - around[0][k].*part) / 6.0;
      across[0][k] = around[1][k].*part - third;
      across[1][k] = around[1][k].*part;
      across[2][k] = around[1][k].*part + third;
    }
    for (const double (&row)[3] : across) {
      result = std::max(result, std::fabs(row[1]) + std::fabs(row[2] - row[0]) / 6.0);
    }
  }
  return result;
}

/// A cell by its first corner, and a bound of ‖∇‖² in it.
struct Candidate {
  double bound;
  std::array<std::size_t, 3> cell;
};

/// The cells of the largest bounds; of those left out the largest bound.
class Candidates {
 public:
  void add(const Candidate& candidate) {
    all_.push_back(candidate);
    if (all_.size() == 2 * kMostCandidates) drop();
  }
  void drop() {
    if (all_.size() <= kMostCandidates) return;
    const auto first_left_out = all_.begin() + kMostCandidates;
    std::ranges::nth_element(all_, first_left_out, std::ranges::greater(), &Candidate::bound);
    left_out_ = std::max(left_out_, first_left_out->bound);
    all_.resize(kMostCandidates);
  }
  const std::vector<Candidate>& all() const { return all_; }
  double left_out() const { return left_out_; }

 private:
  std::vector<Candidate> all_;
  double left_out_ = 0.0;
};

/// What is known of a layer of samples: the numbers around each, and ‖∇‖² at the steepest.
struct LayerSlopes {
  std::vector<Steepness> around;
  double steepest = 0.0;
};

LayerSlopes slopes_of_layer(const GridSamples& samples, const Layers& layers) {
  const std::array<std::ptrdiff_t, 3> strides = layers.strides();
  LayerSlopes result;
  result.around.reserve(samples.size[1] * samples.size[2]);
  for (std::size_t j = 0; j < samples.size[1]; ++j) {
    for (std::size_t k = 0; k < samples.size[2]; ++k) {
      const double* const at = layers.at(j, k);
      Steepness here{};
      Steepness around{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::ptrdiff_t a = strides[axis];
        here[axis] = 0.5 * (at[a] - at[-a]) / samples.spacing[axis];
        around[axis] =
            steepest_control(at, a, strides[(axis + 1) % 3], strides[(axis + 2) % 3]) / samples.spacing[axis];
      }
      result.steepest = std::max(result.steepest, squared(here));
      result.around.push_back(around);
    }
  }
  return result;
}

/// In a cell ∂/∂axis stays within the numbers of its eight corners. Returns the largest ‖∇‖² at a sample.
double collect(const GridSamples& samples, Candidates& candidates) {
  const std::size_t depth = samples.size[2];
  Layers layers(samples);
  layers.centre(0);
  LayerSlopes before = slopes_of_layer(samples, layers);
  double steepest = before.steepest;
  for (std::size_t i = 1; i < samples.size[0]; ++i) {
    layers.centre(i);
    LayerSlopes after = slopes_of_layer(samples, layers);
    steepest = std::max(steepest, after.steepest);
    std::vector<Steepness>& both = before.around;
    for (std::size_t n = 0; n < both.size(); ++n) both[n] = larger_of(both[n], after.around[n]);
    for (std::size_t j = 0; j + 1 < samples.size[1]; ++j) {
      for (std::size_t k = 0; k + 1 < depth; ++k) {
        const Steepness* const corner = &both[j * depth + k];
        const double bound =
            squared(larger_of(larger_of(corner[0], corner[1]), larger_of(corner[depth], corner[depth + 1])));
        if (bound > steepest) candidates.add({bound, {i - 1, j, k}});
      }
    }
    before = std::move(after);
  }
  candidates.drop();
  return steepest;
}

/// A part of a cell in Bézier's form, the numbers along z following each other, and how large it is along each axis.
class Piece {
 public:
  Piece(const GridSamples& samples, const std::array<std::size_t, 3>& cell) : edges_(samples.spacing) {
    for (std::size_t n = 0; n < 64; ++n) {
      const auto index = [&](std::size_t axis) {
        return static_cast<std::ptrdiff_t>(cell[axis] + (n >> (4 - 2 * axis)) % 4) - 1;
      };
      numbers_[n] = sample_at<double>(samples, index(0), index(1), index(2));
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      each_line(axis, [](double& a, double& b, double& c, double& d) {
        const double leaving = (c - a) / 6.0;
        const double arriving = (d - b) / 6.0;
        a = b;
        b += leaving;
        d = c;
        c -= arriving;
      });
    }
    measure();
  }

  /// Of ‖∇‖²: no less than anywhere, and what it is in the steepest corner.
  double bound() const { return bound_; }
  double corner() const { return corner_; }

  /// De Casteljau's halves, all eight of both along each axis.
  std::vector<Piece> cut() const {
    std::vector<Piece> pieces{*this};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t count = pieces.size();
      for (std::size_t i = 0; i < count; ++i) {
        pieces.push_back(pieces[i]);
        pieces[i].halve(axis, false);
        pieces.back().halve(axis, true);
      }
    }
    for (Piece& piece : pieces) piece.measure();
    return pieces;
  }

  friend bool operator<(const Piece& a, const Piece& b) { return a.bound_ < b.bound_; }

 private:
  static constexpr std::size_t kStride[3] = {16, 4, 1};

  template <class Visit>
  void each_line(std::size_t axis, const Visit& visit) {
    const std::size_t stride = kStride[axis];
    for (std::size_t n = 0; n < 64; ++n) {
      if (n / stride % 4 != 0) continue;
      double* const at = &numbers_[n];
      visit(at[0], at[stride], at[2 * stride], at[3 * stride]);
    }
  }

  void halve(std::size_t axis, bool is_upper) {
    each_line(axis, [is_upper](double& a, double& b, double& c, double& d) {
      const double ab = 0.5 * (a + b);
      const double bc = 0.5 * (b + c);
      const double cd = 0.5 * (c + d);
      const double abc = 0.5 * (ab + bc);
      const double bcd = 0.5 * (bc + cd);
      const double middle = 0.5 * (abc + bcd);
      if (is_upper) std::tie(a, b, c) = std::tuple(middle, bcd, cd);
      else std::tie(b, c, d) = std::tuple(ab, abc, middle);
    });
    edges_[axis] *= 0.5;
  }

  void measure() {
    Steepness most{};
    std::array<Steepness, 64> slopes{};  // towards the next number, or from the one before
    for (std::size_t n = 0; n < 64; ++n) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::size_t stride = kStride[axis];
        const std::size_t low = n / stride % 4 == 3 ? n - stride : n;
        slopes[n][axis] = 3.0 * std::fabs(numbers_[low + stride] - numbers_[low]) / edges_[axis];
      }
      most = larger_of(most, slopes[n]);
    }
    bound_ = squared(most);
    corner_ = 0.0;
    for (const std::size_t corner : {0U, 3U, 12U, 15U, 48U, 51U, 60U, 63U})
      corner_ = std::max(corner_, squared(slopes[corner]));
  }

  std::array<double, 64> numbers_{};
  std::array<double, 3> edges_;
  double bound_ = 0.0;
  double corner_ = 0.0;
};

}  // namespace

double cubic_slope(const GridSamples& samples) {
  Candidates candidates;
  double steepest = collect(samples, candidates);
  std::priority_queue<Piece> pieces;
  for (const Candidate& candidate : candidates.all()) {
    if (candidate.bound > steepest) pieces.emplace(samples, candidate.cell);
  }
  const double least = std::max(steepest, candidates.left_out());
  for (std::size_t cuts = 0; cuts < kMostCuts && !pieces.empty(); ++cuts) {
    steepest = std::max(steepest, pieces.top().corner());
    if (pieces.top().bound() <= std::max(least, kTight * steepest)) break;
    const std::vector<Piece> parts = pieces.top().cut();
    pieces.pop();
    for (const Piece& part : parts) pieces.push(part);
  }
  return std::sqrt(std::max(least, pieces.empty() ? 0.0 : pieces.top().bound()));
}

}  // namespace octomarch
