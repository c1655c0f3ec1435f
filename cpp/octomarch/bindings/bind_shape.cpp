// Nodes, their builders, and the plain data of a picture (materials, lights, sky, camera, settings) as Python sees them.
// The Python package validates what is not a shape and wraps all of it; programs and renders take these objects.
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "octomarch/base/error.hpp"
#include "octomarch/bindings/register.hpp"
#include "octomarch/graph/builder.hpp"

namespace py = pybind11;

namespace octomarch {
namespace {

using Triple = std::array<double, 3>;

Vec3 vec3(const Triple& v) { return {v[0], v[1], v[2]}; }

/// Getter of a Vec3 member as a tuple of three floats.
template <class Owner>
auto triple_of(Vec3 Owner::* member) {
  return [member](const Owner& owner) {
    const Vec3& v = owner.*member;
    return std::tuple{v.x, v.y, v.z};
  };
}

/// The names by which Python knows the values of an enumeration.
template <class Value, std::size_t count>
using Names = std::array<std::pair<std::string_view, Value>, count>;

constexpr Names<NodeKind, 3> kCombinations{
    {{"union", NodeKind::kUnion}, {"intersection", NodeKind::kIntersection}, {"difference", NodeKind::kDifference}}};
constexpr Names<LightKind, 2> kLights{{{"directional", LightKind::kDirectional}, {"point", LightKind::kPoint}}};
constexpr Names<CameraKind, 3> kCameras{{{"perspective", CameraKind::kPerspective},
                                         {"orthographic", CameraKind::kOrthographic},
                                         {"panoramic", CameraKind::kPanoramic}}};
constexpr Names<Normals, 2> kNormals{{{"exact", Normals::kExact}, {"central", Normals::kCentral}}};
constexpr Names<Shadows, 3> kShadows{{{"none", Shadows::kNone}, {"hard", Shadows::kHard}, {"soft", Shadows::kSoft}}};

/// The value called `text`, or an ArgumentError that lists the names there are.
template <class Value, std::size_t count>
Value parse(const char* argument, std::string_view text, const Names<Value, count>& names) {
  std::string known;
  for (const auto& [name, value] : names) {
    if (text == name) return value;
    known.append(known.empty() ? "'" : ", '").append(name).append("'");
  }
  throw ArgumentError(std::string(argument) + " must be one of " + known + ", got '" + std::string(text) + "'");
}

/// Getter of an enumeration member by name.
template <class Owner, class Value, std::size_t count>
auto name_of(Value Owner::* member, const Names<Value, count>& names) {
  return [member, &names](const Owner& owner) {
    for (const auto& [name, value] : names) {
      if (owner.*member == value) return name;
    }
    return std::string_view("unknown");
  };
}

void register_node(py::module_& module) {
  py::class_<Node, std::shared_ptr<Node>>(module, "Node", py::is_final(),
                                          "One immutable node of the graph; equal nodes are the same object.")
      .def("__eq__",
           [](const Node& a, const py::object& b) { return py::isinstance<Node>(b) && &b.cast<Node&>() == &a; })
      .def("__hash__", [](const Node& node) { return std::hash<const Node*>{}(&node); })
      .def("__repr__", [](const Node& node) { return "<Node " + std::string(name(node.kind())) + ">"; })
      .def_property_readonly("kind", [](const Node& node) { return name(node.kind()); })
      .def_property_readonly("node_count", [](const NodePtr& node) { return count_nodes(node); });
}

void register_primitives(py::module_& module) {
  module.def("sphere", &sphere, py::arg("radius"));
  module.def("box", [](const Triple& size) { return box(vec3(size)); }, py::arg("size"));
  module.def(
      "plane", [](const Triple& normal, const Triple& point) { return plane(vec3(normal), vec3(point)); },
      py::arg("normal"), py::arg("point"));
  module.def(
      "cylinder",
      [](double radius, std::optional<double> height, const Triple& axis) {
        return cylinder(radius, height, vec3(axis));
      },
      py::arg("radius"), py::arg("height"), py::arg("axis"));
  module.def(
      "torus",
      [](double radius, double tube_radius, const Triple& axis) { return torus(radius, tube_radius, vec3(axis)); },
      py::arg("radius"), py::arg("tube_radius"), py::arg("axis"));
  module.def(
      "capsule", [](const Triple& a, const Triple& b, double radius) { return capsule(vec3(a), vec3(b), radius); },
      py::arg("a"), py::arg("b"), py::arg("radius"));
}

void register_operators(py::module_& module) {
  module.def(
      "combine",
      [](const std::string& kind, std::vector<NodePtr> shapes, double smooth) {
        return combine(parse("kind", kind, kCombinations), std::move(shapes), smooth);
      },
      py::arg("kind"), py::arg("shapes"), py::arg("smooth"));
  module.def("complement", &complement, py::arg("shape").none(false));
  module.def(
      "translate", [](NodePtr shape, const Triple& offset) { return translate(std::move(shape), vec3(offset)); },
      py::arg("shape").none(false), py::arg("offset"));
  module.def(
      "rotate",
      [](NodePtr shape, double degrees, const Triple& axis) { return rotate(std::move(shape), degrees, vec3(axis)); },
      py::arg("shape").none(false), py::arg("degrees"), py::arg("axis"));
  module.def("scale", &scale, py::arg("shape").none(false), py::arg("factor"));
  module.def(
      "repeat",
      [](NodePtr shape, const Triple& period, const std::array<int, 3>& counts) {
        return repeat(std::move(shape), vec3(period), counts);
      },
      py::arg("shape").none(false), py::arg("period"), py::arg("counts"));
  module.def("paint", &paint, py::arg("shape").none(false), py::arg("material"));
}

void register_lighting(py::module_& module) {
  py::class_<Material>(module, "Material", py::is_final())
      .def(py::init([](const Triple& color, double roughness, double specular, double metallic) {
             return Material{vec3(color), roughness, specular, metallic};
           }),
           py::arg("color"), py::arg("roughness"), py::arg("specular"), py::arg("metallic"))
      .def_property_readonly("color", triple_of(&Material::color))
      .def_readonly("roughness", &Material::roughness)
      .def_readonly("specular", &Material::specular)
      .def_readonly("metallic", &Material::metallic);
  py::class_<Light>(module, "Light", py::is_final())
      .def(py::init([](const std::string& kind, const Triple& vector, const Triple& color, int decay) {
             return Light{parse("kind", kind, kLights), vec3(vector), vec3(color), decay};
           }),
           py::arg("kind"), py::arg("vector"), py::arg("color"), py::arg("decay"))
      .def_property_readonly("kind", name_of(&Light::kind, kLights))
      .def_property_readonly("vector", triple_of(&Light::vector))
      .def_property_readonly("color", triple_of(&Light::color))
      .def_readonly("decay", &Light::decay);
  py::class_<Sky>(module, "Sky", py::is_final())
      .def(py::init([](const Triple& axis, const Triple& toward, const Triple& away, const Triple& base) {
             return Sky{vec3(axis), vec3(toward), vec3(away), vec3(base)};
           }),
           py::arg("axis"), py::arg("toward"), py::arg("away"), py::arg("base"))
      .def_property_readonly("axis", triple_of(&Sky::axis))
      .def_property_readonly("toward", triple_of(&Sky::toward))
      .def_property_readonly("away", triple_of(&Sky::away))
      .def_property_readonly("base", triple_of(&Sky::base));
  py::class_<Scene>(module, "Scene", py::is_final())
      .def(py::init([](std::vector<Light> lights, const Sky& sky, const Triple& ambient) {
             return Scene{std::move(lights), sky, vec3(ambient)};
           }),
           py::arg("lights"), py::arg("sky"), py::arg("ambient"))
      .def_readonly("lights", &Scene::lights)
      .def_readonly("sky", &Scene::sky)
      .def_property_readonly("ambient", triple_of(&Scene::ambient));
}

void register_camera(py::module_& module) {
  py::class_<Camera>(module, "Camera", py::is_final())
      .def(py::init([](const std::string& kind, const Triple& eye, const Triple& target, const Triple& up, double fov,
                       double fov_across, double height) {
             return Camera{parse("kind", kind, kCameras), vec3(eye), vec3(target), vec3(up), fov, fov_across, height};
           }),
           py::arg("kind"), py::arg("eye"), py::arg("target"), py::arg("up"), py::arg("fov"), py::arg("fov_across"),
           py::arg("height"))
      .def_property_readonly("kind", name_of(&Camera::kind, kCameras))
      .def_property_readonly("eye", triple_of(&Camera::eye))
      .def_property_readonly("target", triple_of(&Camera::target))
      .def_property_readonly("up", triple_of(&Camera::up))
      .def_readonly("fov", &Camera::fov)
      .def_readonly("fov_across", &Camera::fov_across)
      .def_readonly("height", &Camera::height);
}

void register_settings(py::module_& module) {
  py::class_<March>(module, "March", py::is_final())
      .def(py::init([](int max_steps, double epsilon, double pixel_tolerance, double max_distance, bool secant_finish) {
             return March{max_steps, epsilon, pixel_tolerance, max_distance, secant_finish};
           }),
           py::arg("max_steps"), py::arg("epsilon"), py::arg("pixel_tolerance"), py::arg("max_distance"),
           py::arg("secant_finish"))
      .def_readonly("max_steps", &March::max_steps)
      .def_readonly("epsilon", &March::epsilon)
      .def_readonly("pixel_tolerance", &March::pixel_tolerance)
      .def_readonly("max_distance", &March::max_distance)
      .def_readonly("secant_finish", &March::secant_finish);
  py::class_<Shading>(module, "Shading", py::is_final())
      .def(py::init([](const std::string& normals, double normal_step, const std::string& shadows, double shadow_k,
                       int occlusion, double occlusion_distance) {
             return Shading{parse("normals", normals, kNormals),
                            normal_step,
                            parse("shadows", shadows, kShadows),
                            shadow_k,
                            occlusion,
                            occlusion_distance};
           }),
           py::arg("normals"), py::arg("normal_step"), py::arg("shadows"), py::arg("shadow_k"), py::arg("occlusion"),
           py::arg("occlusion_distance"))
      .def_property_readonly("normals", name_of(&Shading::normals, kNormals))
      .def_readonly("normal_step", &Shading::normal_step)
      .def_property_readonly("shadows", name_of(&Shading::shadows, kShadows))
      .def_readonly("shadow_k", &Shading::shadow_k)
      .def_readonly("occlusion", &Shading::occlusion)
      .def_readonly("occlusion_distance", &Shading::occlusion_distance);
}

}  // namespace

void register_shape(py::module_& module) {
  register_node(module);
  register_lighting(module);  // before the operators, so that the signature of paint() reads Material
  register_primitives(module);
  register_operators(module);
  register_camera(module);
  register_settings(module);
}

}  // namespace octomarch
