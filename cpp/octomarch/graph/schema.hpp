// What nodes.def says, at run time: names, and which parameters and children a node may have. The node graph comes
// before it; the builder and files make nodes through it, the compiler asks how parameters grow with a shape.
#pragma once

#include <string_view>
#include <vector>

#include "octomarch/graph/node.hpp"

namespace octomarch {

/// Lower-case name of a kind, as in nodes.def ("smooth union" is "union" with k > 0).
std::string_view name(NodeKind kind);

/// Types of parameters; see nodes.def.
enum class ParameterType : std::uint8_t {
  kLength,
  kPosition,
  kExtent,
  kRate,
  kFactor,
  kNumber,
  kBound,
  kAxis,
  kWhole,
};

struct Parameter {
  std::string_view name;
  ParameterType type;
};

struct NodeSchema {
  std::vector<Parameter> parameters;
  bool any_number = false;                 ///< the last parameter stands for any number of them
  std::vector<std::string_view> children;  ///< "shape", "expression" or "image"
  bool any_children = false;               ///< the last child stands for one or more
};

const NodeSchema& schema(NodeKind kind);

/// Parameter `i` of a node whose shape is enlarged by `scale`.
double scaled_parameter(const Node& node, std::size_t i, double scale);

/// The node of that name, after every check that its builder makes. For what comes from files: throws ArgumentError
/// that names the parameter or child and the value.
NodePtr checked_node(std::string_view kind_name, std::vector<double> parameters, std::vector<NodePtr> children,
                     std::vector<float> texels);

/// Does the expression look at the surface's normal? O(nodes).
bool uses_normal(const Node& expression);

}  // namespace octomarch
