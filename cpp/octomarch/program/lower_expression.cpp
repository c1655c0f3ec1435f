#include "octomarch/program/lower_expression.hpp"

#include <utility>
#include <vector>

#include "octomarch/base/error.hpp"

namespace octomarch {
namespace {

/// The operation of a node that has no parameters: over its children in their order.
Opcode opcode_of(NodeKind kind) {
  switch (kind) {
    case NodeKind::kNegate: return Opcode::kComplement;
    case NodeKind::kAbsolute: return Opcode::kAbsolute;
    case NodeKind::kSquareRoot: return Opcode::kSquareRoot;
    case NodeKind::kFloor: return Opcode::kFloor;
    case NodeKind::kExponential: return Opcode::kExponential;
    case NodeKind::kLogarithm: return Opcode::kLogarithm;
    case NodeKind::kSine: return Opcode::kSine;
    case NodeKind::kCosine: return Opcode::kCosine;
    case NodeKind::kTangent: return Opcode::kTangent;
    case NodeKind::kArcSine: return Opcode::kArcSine;
    case NodeKind::kArcCosine: return Opcode::kArcCosine;
    case NodeKind::kArcTangent: return Opcode::kArcTangent;
    case NodeKind::kAdd: return Opcode::kAdd;
    case NodeKind::kSubtract: return Opcode::kSubtract;
    case NodeKind::kMultiply: return Opcode::kMultiply;
    case NodeKind::kDivide: return Opcode::kDivide;
    case NodeKind::kMinimum: return Opcode::kUnion;
    case NodeKind::kMaximum: return Opcode::kIntersection;
    case NodeKind::kModulo: return Opcode::kModulo;
    case NodeKind::kPower: return Opcode::kPower;
    case NodeKind::kArcTangent2: return Opcode::kArcTangent2;
    case NodeKind::kLess: return Opcode::kLess;
    case NodeKind::kLessEqual: return Opcode::kLessEqual;
    case NodeKind::kWhere: return Opcode::kWhere;
    default: throw SceneError("an expression holds a node that is no operation on numbers");
  }
}

ValueId emit(const Node& node, const std::vector<ValueId>& operands, const Coordinates& coordinates, DataFlow& flow) {
  switch (node.kind()) {
    case NodeKind::kCoordinate: {
      const ValueId value = coordinates[static_cast<std::size_t>(node.parameter(0))];
      if (value == kNoNormal) throw SceneError("only materials can look at the normal");
      return value;
    }
    case NodeKind::kConstant: return flow.constant(node.parameter(0));
    // beyond 289 the lattice is the same again
    case NodeKind::kNoise: return flow.emit(Opcode::kNoise, operands, {{std::fmod(node.parameter(0), 289.0)}});
    case NodeKind::kTexel: {
      const ValueId red =
          flow.emit(Opcode::kTexel, operands, {{flow.image_number(node.children()[0]), node.parameter(1)}});
      return red + static_cast<ValueId>(node.parameter(0));
    }
    default: return flow.emit(opcode_of(node.kind()), operands);
  }
}

}  // namespace

ValueId ExpressionLowering::lower(const Node& expression, const Coordinates& coordinates, DataFlow& flow) {
  Values& known = values_[coordinates];
  std::vector<std::pair<const Node*, bool>> stack{{&expression, false}};
  std::vector<ValueId> operands;
  while (!stack.empty()) {
    const auto [node, operands_done] = stack.back();
    stack.pop_back();
    if (known.contains(node)) continue;
    if (!operands_done) {
      stack.emplace_back(node, true);
      for (const NodePtr& child : node->children()) {
        if (is_expression(child->kind())) stack.emplace_back(child.get(), false);
      }
      continue;
    }
    operands.clear();
    for (const NodePtr& child : node->children()) {
      if (is_expression(child->kind())) operands.push_back(known.at(child.get()));
    }
    known.emplace(node, emit(*node, operands, coordinates, flow));
  }
  return known.at(&expression);
}

}  // namespace octomarch
