// Nodes of the graph as Python sees them: equal nodes are one object, and what a node is made of can be read and made
// again, which scene files rest on. Builders of shapes and expressions come after it.
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "octomarch/bindings/register.hpp"
#include "octomarch/graph/node.hpp"
#include "octomarch/graph/node_list.hpp"
#include "octomarch/graph/schema.hpp"

namespace py = pybind11;

namespace octomarch {
namespace {

using Texels = py::array_t<float, py::array::c_style | py::array::forcecast>;

/// An image's texels as a read-only array of shape (height, width, 3), or a grid's samples, that keeps the node alive.
std::optional<py::array> texels_of(const NodePtr& node) {
  const bool is_image = node->kind() == NodeKind::kImage;
  if (!is_image && node->kind() != NodeKind::kGrid) return std::nullopt;
  const auto size = [&node](std::size_t i) { return static_cast<py::ssize_t>(node->parameter(i)); };
  const std::array<py::ssize_t, 3> shape{size(is_image ? 1 : 0), size(is_image ? 0 : 1), is_image ? 3 : size(2)};
  py::array_t<float> view(shape, node->texels().data(), py::cast(node));
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

/// Kind, parameters, places of children and texels of each of `nodes`. Contract: their children are among them.
py::list contents_of(const std::vector<NodePtr>& nodes) {
  std::unordered_map<const Node*, std::size_t> places;
  places.reserve(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) places.emplace(nodes[i].get(), i);
  py::list contents(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const std::span<const double> parameters = nodes[i]->parameters();
    std::vector<std::size_t> children;
    for (const NodePtr& child : nodes[i]->children()) children.push_back(places.at(child.get()));
    contents[i] = py::make_tuple(name(nodes[i]->kind()), std::vector<double>(parameters.begin(), parameters.end()),
                                 children, texels_of(nodes[i]));
  }
  return contents;
}

void append(NodeList& list, const std::string& kind, std::vector<double> parameters,
            const std::vector<std::size_t>& children, const std::optional<Texels>& texels) {
  std::vector<float> values;
  if (texels) values.assign(texels->data(), texels->data() + texels->size());
  list.append(kind, std::move(parameters), children, std::move(values));
}

/// A parameter of a kind of node: its name, its type, and how many numbers it has, 0 for any number.
using ParameterInfo = std::tuple<std::string_view, std::string_view, std::size_t>;

std::vector<ParameterInfo> parameters_of(const NodeSchema& schema) {
  std::vector<ParameterInfo> parameters;
  for (const Parameter& parameter : schema.parameters) {
    if (parameters.empty() || std::get<0>(parameters.back()) != parameter.name) {
      parameters.emplace_back(parameter.name, name(parameter.type), 0);
    }
    ++std::get<2>(parameters.back());
  }
  if (schema.any_number) std::get<2>(parameters.back()) = 0;
  return parameters;
}

py::dict node_kinds() {
  py::dict kinds;
  for (const std::string_view kind : node_names()) kinds[py::str(kind)] = parameters_of(schema(*kind_named(kind)));
  return kinds;
}

}  // namespace

void register_node(py::module_& module) {
  py::class_<Node, std::shared_ptr<Node>>(module, "Node", py::is_final(),
                                          "One immutable node of the graph; equal nodes are the same object.")
      .def("__eq__",
           [](const Node& a, const py::object& b) { return py::isinstance<Node>(b) && &b.cast<Node&>() == &a; })
      .def("__hash__", [](const Node& node) { return std::hash<const Node*>{}(&node); })
      .def("__repr__", [](const Node& node) { return "<Node " + std::string(name(node.kind())) + ">"; })
      .def_property_readonly("kind", [](const Node& node) { return name(node.kind()); })
      .def_property_readonly("sort", &sort_of)
      .def_property_readonly("parameters",
                             [](const Node& node) {
                               const auto p = node.parameters();
                               return std::vector<double>(p.begin(), p.end());
                             })
      .def_property_readonly("children",
                             [](const Node& node) {
                               const auto children = node.children();
                               return std::vector<NodePtr>(children.begin(), children.end());
                             })
      .def_property_readonly("texels", &texels_of)
      .def_property_readonly("is_flat", &Node::is_flat)
      .def_property_readonly("node_count", [](const NodePtr& node) { return count_nodes(node); });
  py::class_<NodeList>(module, "NodeList", py::is_final(), "Nodes of unknown origin, each checked as it is appended.")
      .def(py::init<>())
      .def("append", &append, py::arg("kind"), py::arg("parameters"), py::arg("children"), py::arg("texels"))
      .def("__len__", &NodeList::size)
      .def("__getitem__", &NodeList::at);
  module.def("node_kinds", &node_kinds);
  module.def("contents", &contents_of, py::arg("nodes"));
  module.def(
      "children_first", [](const std::vector<NodePtr>& roots) { return children_first(roots); }, py::arg("roots"));
}

}  // namespace octomarch
