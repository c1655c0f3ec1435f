#include "octomarch/program/placed_normal.hpp"

#include <limits>

#include "octomarch/program/axes.hpp"

namespace octomarch {

namespace {

using Vector = std::array<ValueId, 3>;

/// Shorthands for the arithmetic of normals.
class Arithmetic {
 public:
  explicit Arithmetic(DataFlow& flow) : flow_(flow) {}

  ValueId times(ValueId a, ValueId b) { return flow_.emit(Opcode::kMultiply, {{a, b}}); }
  ValueId times(ValueId a, double b) { return flow_.emit(Opcode::kMultiplyConstant, {{a}}, {{b}}); }
  ValueId plus(ValueId a, ValueId b) { return flow_.emit(Opcode::kAdd, {{a, b}}); }
  ValueId minus(ValueId a, ValueId b) { return flow_.emit(Opcode::kSubtract, {{a, b}}); }
  ValueId over(ValueId a, ValueId b) { return flow_.emit(Opcode::kDivide, {{a, b}}); }

  /// (u, v) turned by rate·along; the second output follows the first.
  ValueId turned(ValueId u, ValueId along, ValueId v, double rate) {
    return flow_.emit(Opcode::kTwist, {{u, along, v}}, {{rate, kInfinity}});
  }

  Vector normalized(const Vector& v) {
    const ValueId length = flow_.emit(Opcode::kOriginSphere, v, {{0.0}});
    return {over(v[0], length), over(v[1], length), over(v[2], length)};
  }

 private:
  DataFlow& flow_;
};

/// A twist turns across the axis, and shears along it.
Vector untwisted(const Node& node, double rate, const Vector& own, const Vector& parent, const Vector& child,
                 Arithmetic& math) {
  const Across across(node.parameter(2));
  Vector normal = own;
  normal[across.first] = math.turned(own[across.first], parent[across.along], own[across.second], rate);
  normal[across.second] = normal[across.first] + 1;
  const ValueId moment = math.minus(math.times(normal[across.second], child[across.first]),
                                    math.times(normal[across.first], child[across.second]));
  normal[across.along] = math.minus(own[across.along], math.times(moment, rate));
  return math.normalized(normal);
}

/// A bend turns in the plane of x and y while it draws x out by 1 − rate·y.
Vector unbent(double rate, const Vector& own, const Vector& parent, const Vector& child, DataFlow& flow) {
  Arithmetic math(flow);
  const ValueId drawn = flow.emit(Opcode::kSubtractFrom, {{math.times(parent[1], rate)}}, {{1.0}});
  const ValueId turned = math.turned(own[0], parent[0], own[1], rate);
  const ValueId moment = math.times(own[1], rate);
  const ValueId x = math.minus(turned, math.times(moment, child[0]));
  const ValueId y = math.minus(turned + 1, math.times(moment, child[1]));
  return math.normalized({math.over(x, drawn), math.over(y, drawn), own[2]});
}

/// Components away from the axis, along it, and around it. On the axis nothing leads away.
Vector unrevolved(const Vector& own, const Vector& parent, DataFlow& flow) {
  Arithmetic math(flow);
  const ValueId radius = flow.emit(Opcode::kOriginCylinder, {{parent[0], parent[2]}}, {{0.0}});
  const ValueId divisor =
      flow.emit(Opcode::kMaximumConstant, {{radius}}, {{double{std::numeric_limits<float>::min()}}});
  const ValueId x = math.over(parent[0], divisor);
  const ValueId z = math.over(parent[2], divisor);
  return {math.plus(math.times(own[0], x), math.times(own[2], z)), own[1],
          math.minus(math.times(own[2], x), math.times(own[0], z))};
}

}  // namespace

std::array<ValueId, 3> bent_normal(const Node& node, double scale, const std::array<ValueId, 3>& own,
                                   const std::array<ValueId, 3>& parent, const std::array<ValueId, 3>& child,
                                   DataFlow& flow) {
  Arithmetic math(flow);
  const auto p = node.parameters();
  switch (node.kind()) {
    case NodeKind::kStretch:
      return math.normalized({math.times(own[0], p[0]), math.times(own[1], p[1]), math.times(own[2], p[2])});
    case NodeKind::kMirror: {
      const auto axis = static_cast<std::size_t>(p[0]);
      Vector normal = own;
      const ValueId is_image = flow.emit(Opcode::kLess, {{parent[axis], flow.constant(0.0)}});
      const ValueId reversed = flow.emit(Opcode::kComplement, {{own[axis]}});
      normal[axis] = flow.emit(Opcode::kWhere, {{is_image, reversed, own[axis]}});
      return normal;
    }
    case NodeKind::kTwist: return untwisted(node, p[0] / scale, own, parent, child, math);
    case NodeKind::kBend: return unbent(p[0] / scale, own, parent, child, flow);
    case NodeKind::kRevolve: return unrevolved(own, parent, flow);
    default: return own;
  }
}

}  // namespace octomarch
