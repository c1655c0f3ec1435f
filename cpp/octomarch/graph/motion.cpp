#include "octomarch/graph/motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "octomarch/base/error.hpp"
#include "octomarch/graph/text.hpp"

namespace octomarch {
namespace {

std::string text_of(std::span<const double> matrix) {
  std::string result;
  for (std::size_t row = 0; row < 3; ++row) {
    result += row == 0 ? "((" : "), (";
    for (std::size_t column = 0; column < 4; ++column) {
      result += (column == 0 ? "" : ", ") + text(matrix[4 * row + column]);
    }
  }
  return result + "))";
}

double determinant(const Mat3& m) { return dot(cross({m[0], m[1], m[2]}, {m[3], m[4], m[5]}), {m[6], m[7], m[8]}); }

/// By how much an entry of MᵀM is off at the most.
double skewness(const Mat3& m) {
  const Mat3 product = transposed(m) * m;
  double most = 0.0;
  for (std::size_t i = 0; i < product.size(); ++i) most = std::fmax(most, std::fabs(product[i] - kIdentity3[i]));
  return most;
}

/// Newton's iteration towards the nearest rotation, ½(M + M⁻ᵀ); errors are squared (N. J. Higham, "Computing the polar
/// decomposition", SIAM J. Sci. Stat. Comput. 7(4), 1986).
Mat3 nearer_rotation(const Mat3& m) {
  const Vec3 rows[3] = {{m[0], m[1], m[2]}, {m[3], m[4], m[5]}, {m[6], m[7], m[8]}};
  const double half = 0.5 / determinant(m);
  Mat3 result{};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 cofactors = cross(rows[(i + 1) % 3], rows[(i + 2) % 3]);
    result[3 * i] = 0.5 * rows[i].x + half * cofactors.x;
    result[3 * i + 1] = 0.5 * rows[i].y + half * cofactors.y;
    result[3 * i + 2] = 0.5 * rows[i].z + half * cofactors.z;
  }
  return result;
}

/// Where a matrix takes one coordinate axis to another but for `rounding`, it is made to: so quarter turns are exact, and
/// what is flat stays so when it is turned in its plane.
Mat3 axes_set_right(Mat3 m, double rounding) {
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      double across = 0.0;
      for (std::size_t other = 0; other < 3; ++other) {
        if (other != column) across = std::fmax(across, std::fabs(m[3 * row + other]));
        if (other != row) across = std::fmax(across, std::fabs(m[3 * other + column]));
      }
      const double along = m[3 * row + column];
      if (across > rounding || std::fabs(std::fabs(along) - 1.0) > rounding) continue;
      for (std::size_t other = 0; other < 3; ++other) m[3 * row + other] = m[3 * other + column] = 0.0;
      m[3 * row + column] = std::copysign(1.0, along);
    }
  }
  return m;
}

/// The nearest rotation of a matrix within the tolerance of one. What is orthonormal up to rounding stays as it is.
Mat3 nearest_rotation(const Mat3& given, double rounding) {
  constexpr double kRoundedOnly = 0x1p-50;
  const Mat3 m = axes_set_right(given, rounding);
  return skewness(m) <= kRoundedOnly ? m : nearer_rotation(nearer_rotation(m));
}

double mean(const std::array<double, 3>& numbers) {
  // the sum of equal numbers may round
  if (numbers[0] == numbers[1] && numbers[1] == numbers[2]) return numbers[0];
  return numbers[0] / 3.0 + numbers[1] / 3.0 + numbers[2] / 3.0;
}

/// Column `j` of three rows of `width` numbers.
Vec3 column(std::span<const double> rows, std::size_t width, std::size_t j) {
  return {rows[j], rows[width + j], rows[2 * width + j]};
}

}  // namespace

Motion motion_of(std::span<const double, Motion::kNumbers> m, double rounding, std::string_view argument) {
  const auto refuse_unless = [&](bool valid, std::string_view requirement) {
    if (!valid) require(false, argument, requirement, text_of(m));
  };
  refuse_unless(std::ranges::all_of(m, [](double entry) { return std::isfinite(entry); }), "finite");
  const Vec3 x = column(m, 4, 0);
  const Vec3 y = column(m, 4, 1);
  const Vec3 z = column(m, 4, 2);
  const auto set_right = [rounding](double factor) { return std::fabs(factor - 1.0) <= rounding ? 1.0 : factor; };
  const double size = set_right(mean({length(x), length(y), length(z)}));
  refuse_unless(std::isnormal(size), "a rotation times a factor that is finite and > 0");
  Mat3 linear{};
  for (std::size_t k = 0; k < linear.size(); ++k) linear[k] = m[4 * (k / 3) + k % 3] / size;
  refuse_unless(skewness(linear) <= Motion::kTolerance, "a rotation times one factor > 0, without shear or stretch");
  refuse_unless(determinant(linear) > 0.0, "a rotation times one factor > 0, without reflection");
  const Mat3 rotation = nearest_rotation(linear, rounding);
  // the factor by which that rotation is nearest to the matrix
  const double factor =
      mean({dot(x, column(rotation, 3, 0)), dot(y, column(rotation, 3, 1)), dot(z, column(rotation, 3, 2))});
  return {set_right(factor), rotation, column(m, 4, 3)};
}

}  // namespace octomarch
