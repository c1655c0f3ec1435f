// Nodes of the graph as Python sees them: equal nodes are one object, and what a node is made of can be read and made
// again, which scene files rest on. Builders of shapes and expressions come after it.
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "octomarch/bindings/register.hpp"
#include "octomarch/graph/node.hpp"
#include "octomarch/graph/schema.hpp"

namespace py = pybind11;

namespace octomarch {
namespace {

using Texels = py::array_t<float, py::array::c_style | py::array::forcecast>;

/// An image's texels as a read-only array of shape (height, width, 3) that keeps the node alive.
std::optional<py::array> texels_of(const NodePtr& node) {
  if (node->kind() != NodeKind::kImage) return std::nullopt;
  const auto width = static_cast<py::ssize_t>(node->parameter(0));
  const auto height = static_cast<py::ssize_t>(node->parameter(1));
  py::array_t<float> view({height, width, py::ssize_t{3}}, node->texels().data(), py::cast(node));
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

NodePtr node_from(const std::string& kind, std::vector<double> parameters, std::vector<NodePtr> children,
                  const std::optional<Texels>& texels) {
  std::vector<float> values;
  if (texels) values.assign(texels->data(), texels->data() + texels->size());
  return checked_node(kind, std::move(parameters), std::move(children), std::move(values));
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
      .def_property_readonly("is_flat", [](const Node& node) { return is_flat(node); })
      .def_property_readonly("node_count", [](const NodePtr& node) { return count_nodes(node); });
  module.def("checked_node", &node_from, py::arg("kind"), py::arg("parameters"), py::arg("children"),
             py::arg("texels"));
}

}  // namespace octomarch
