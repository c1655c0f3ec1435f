// What nodes.def says, at run time: names, and which parameters and children a node may have. The node graph comes
// before it; the builder and files make nodes through it, the compiler asks how parameters grow with a shape.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "octomarch/graph/node.hpp"

namespace octomarch {

/// Lower-case name of a kind, as in nodes.def ("smooth union" is "union" with k > 0).
std::string_view name(NodeKind kind);

/// Names of all kinds, in the order of nodes.def; and the kind of a name.
std::span<const std::string_view> node_names();
std::optional<NodeKind> kind_named(std::string_view name);

/// What a node can be a child as: "shape", "expression" or "image".
std::string_view sort_of(const Node& node);

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

/// As in nodes.def.
std::string_view name(ParameterType type);

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

/// The node of that name, after every check that can be made by looking at its parameters and children alone. Throws
/// ArgumentError that names the parameter or child and the value.
NodePtr checked_node(std::string_view kind_name, std::vector<double> parameters, std::vector<NodePtr> children,
                     std::vector<float> texels);

}  // namespace octomarch
