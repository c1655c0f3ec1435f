// Forward differentiation, node after node, with the standard library's functions. See expression.hpp.
#include "octomarch/reference/expression.hpp"

#include <cmath>

#include "octomarch/reference/noise.hpp"
#include "octomarch/reference/texel.hpp"

namespace octomarch::reference {
namespace {

/// A function of one variable: its value, and its slope with 0 where that is infinite or none.
template <class T>
Jet<T> function(T value, T slope, const Jet<T>& operand) {
  return {value, along(std::isfinite(slope) ? slope : T(0), operand.gradient)};
}

template <class T>
Jet<T> function(T value, T slope_a, const Jet<T>& a, T slope_b, const Jet<T>& b) {
  return {value, function(value, slope_a, a).gradient + function(value, slope_b, b).gradient};
}

template <class T>
Jet<T> unary(NodeKind kind, const Jet<T>& a) {
  const T x = a.value;
  switch (kind) {
    case NodeKind::kNegate: return {-x, -a.gradient};
    case NodeKind::kAbsolute: return x < T(0) ? Jet<T>{-x, -a.gradient} : Jet<T>{std::abs(x), a.gradient};
    case NodeKind::kSquareRoot: return function(std::sqrt(x), T(0.5) / std::sqrt(x), a);
    case NodeKind::kFloor: return {std::floor(x)};
    case NodeKind::kExponential: return function(std::exp(x), std::exp(x), a);
    case NodeKind::kLogarithm: return function(std::log(x), T(1) / x, a);
    case NodeKind::kSine: return function(std::sin(x), std::cos(x), a);
    case NodeKind::kCosine: return function(std::cos(x), -std::sin(x), a);
    case NodeKind::kTangent: return function(std::tan(x), T(1) + std::tan(x) * std::tan(x), a);
    case NodeKind::kArcSine: return function(std::asin(x), T(1) / std::sqrt(T(1) - x * x), a);
    case NodeKind::kArcCosine: return function(std::acos(x), T(-1) / std::sqrt(T(1) - x * x), a);
    default: return function(std::atan(x), T(1) / (T(1) + x * x), a);
  }
}

/// The first where `chosen`, else the second; of equal ones the second, unless only the first has a slope.
template <class T>
Jet<T> either(bool chosen, const Jet<T>& a, const Jet<T>& b) {
  const bool tie_to_a = a.value == b.value && b.gradient == Vector<T>(0);
  return {chosen ? a.value : b.value, chosen || tie_to_a ? a.gradient : b.gradient};
}

template <class T>
Jet<T> binary(NodeKind kind, const Jet<T>& a, const Jet<T>& b) {
  const T x = a.value;
  const T y = b.value;
  switch (kind) {
    case NodeKind::kAdd: return {x + y, a.gradient + b.gradient};
    case NodeKind::kSubtract: return {x - y, a.gradient - b.gradient};
    case NodeKind::kMultiply: return function(x * y, y, a, x, b);
    case NodeKind::kDivide: return function(x / y, T(1) / y, a, -x / y / y, b);
    case NodeKind::kMinimum: return either(x < y, a, b);
    case NodeKind::kMaximum: return either(x > y, a, b);
    case NodeKind::kModulo: return function(x - y * std::floor(x / y), T(1), a, -std::floor(x / y), b);
    case NodeKind::kPower: {
      const T power = std::pow(x, y);
      return function(power, y * std::pow(x, y - T(1)), a, power * std::log(x), b);
    }
    case NodeKind::kArcTangent2: {  // x is the ordinate, y the abscissa
      const T squared = x * x + y * y;
      return function(std::atan2(x, y), y / squared, a, -x / squared, b);
    }
    case NodeKind::kLess: return {x < y ? T(1) : T(0)};
    default: return {x <= y ? T(1) : T(0)};
  }
}

template <class T>
Jet<T> noise(const Node& node, const Jet<T>& x, const Jet<T>& y, const Jet<T>& z) {
  const Jet<T> at = gradient_noise(Vector<T>(x.value, y.value, z.value), T(std::fmod(node.parameter(0), 289.0)));
  return {at.value,
          along(at.gradient.x, x.gradient) + along(at.gradient.y, y.gradient) + along(at.gradient.z, z.gradient)};
}

template <class T>
Jet<T> texel(const Node& node, const Jet<T>& u, const Jet<T>& v) {
  const TexelJet<T> at = texel_at(node, u.value, v.value);
  return function(at.value, at.du, u, at.dv, v);
}

template <class T>
Jet<T> coordinate(int index, const Vector<T>& point, const Vector<T>& normal) {
  if (index >= 3) return {normal[index - 3]};
  Jet<T> result{point[index]};
  result.gradient[index] = T(1);
  return result;
}

}  // namespace

template <class T>
Expression<T>::Expression(const Node& root) : steps_(steps_of(root)), results_(steps_.size()) {}

template <class T>
Jet<T> Expression<T>::at(const Vector<T>& point, const Vector<T>& normal) {
  for (std::size_t i = 0; i < steps_.size(); ++i) {
    const Node& node = *steps_[i].node;
    const auto operand = [&](std::size_t number) -> const Jet<T>& { return results_[steps_[i].operands[number]]; };
    switch (node.kind()) {
      case NodeKind::kCoordinate: results_[i] = coordinate(static_cast<int>(node.parameter(0)), point, normal); break;
      case NodeKind::kConstant: results_[i] = {T(node.parameter(0))}; break;
      case NodeKind::kWhere: results_[i] = operand(operand(0).value != T(0) ? 1 : 2); break;
      case NodeKind::kNoise: results_[i] = noise(node, operand(0), operand(1), operand(2)); break;
      case NodeKind::kTexel: results_[i] = texel(node, operand(0), operand(1)); break;
      default:
        results_[i] =
            node.children().size() == 1 ? unary(node.kind(), operand(0)) : binary(node.kind(), operand(0), operand(1));
    }
  }
  return results_.back();
}

template class Expression<float>;
template class Expression<double>;

}  // namespace octomarch::reference
