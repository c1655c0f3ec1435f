// The plain data of a picture as Python sees it: lights, sky, scene, camera and settings. The Python package validates
// it and wraps all of it; renders take these objects.
#include <array>
#include <string>
#include <utility>
#include <vector>

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include "octomarch/bindings/register.hpp"
#include "octomarch/bindings/values.hpp"
#include "octomarch/graph/scene.hpp"

namespace py = pybind11;

namespace octomarch {
namespace {

constexpr Names<LightKind, 3> kLights{
    {{"directional", LightKind::kDirectional}, {"point", LightKind::kPoint}, {"spot", LightKind::kSpot}}};
constexpr Names<CameraKind, 3> kCameras{{{"perspective", CameraKind::kPerspective},
                                         {"orthographic", CameraKind::kOrthographic},
                                         {"panoramic", CameraKind::kPanoramic}}};
constexpr Names<Method, 6> kMethods{{{"auto", Method::kAuto},
                                     {"plain", Method::kPlain},
                                     {"relaxed", Method::kRelaxed},
                                     {"enhanced", Method::kEnhanced},
                                     {"fixed", Method::kFixed},
                                     {"certified", Method::kCertified}}};
constexpr Names<Normals, 3> kNormals{
    {{"exact", Normals::kExact}, {"central", Normals::kCentral}, {"tetrahedron", Normals::kTetrahedron}}};
constexpr Names<Shadows, 3> kShadows{{{"none", Shadows::kNone}, {"hard", Shadows::kHard}, {"soft", Shadows::kSoft}}};

void register_lights(py::module_& module) {
  py::class_<Light>(module, "Light", py::is_final())
      .def(py::init([](const std::string& kind, const Triple& vector, const Triple& color, int decay,
                       const Triple& direction, double inner_cosine, double outer_cosine) {
             return Light{parse("kind", kind, kLights),
                          vec3(vector),
                          vec3(color),
                          decay,
                          vec3(direction),
                          inner_cosine,
                          outer_cosine};
           }),
           py::arg("kind"), py::arg("vector"), py::arg("color"), py::arg("decay"), py::arg("direction"),
           py::arg("inner_cosine"), py::arg("outer_cosine"))
      .def_property_readonly("kind", name_of(&Light::kind, kLights))
      .def_property_readonly("vector", triple_of(&Light::vector))
      .def_property_readonly("color", triple_of(&Light::color))
      .def_readonly("decay", &Light::decay)
      .def_property_readonly("direction", triple_of(&Light::direction))
      .def_readonly("inner_cosine", &Light::inner_cosine)
      .def_readonly("outer_cosine", &Light::outer_cosine);
}

void register_surroundings(py::module_& module) {
  py::class_<Sky>(module, "Sky", py::is_final())
      .def(py::init([](std::array<NodePtr, 3> color) { return Sky{std::move(color)}; }), py::arg("color"))
      .def_readonly("color", &Sky::color);
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
      .def(py::init([](const std::string& method, int max_steps, double epsilon, double pixel_tolerance,
                       double max_distance, double min_distance, double bias, double step, bool finish, bool prune) {
             return March{parse("method", method, kMethods),
                          max_steps,
                          epsilon,
                          pixel_tolerance,
                          max_distance,
                          min_distance,
                          bias,
                          step,
                          finish,
                          prune};
           }),
           py::arg("method"), py::arg("max_steps"), py::arg("epsilon"), py::arg("pixel_tolerance"),
           py::arg("max_distance"), py::arg("min_distance"), py::arg("bias"), py::arg("step"), py::arg("finish"),
           py::arg("prune"))
      .def_property_readonly("method", name_of(&March::method, kMethods))
      .def_readonly("max_steps", &March::max_steps)
      .def_readonly("epsilon", &March::epsilon)
      .def_readonly("pixel_tolerance", &March::pixel_tolerance)
      .def_readonly("max_distance", &March::max_distance)
      .def_readonly("min_distance", &March::min_distance)
      .def_readonly("bias", &March::bias)
      .def_readonly("step", &March::step)
      .def_readonly("finish", &March::finish)
      .def_readonly("prune", &March::prune);
  py::class_<Shading>(module, "Shading", py::is_final())
      .def(py::init([](const std::string& normals, double normal_step, const std::string& shadows, double shadow_k,
                       int occlusion, double occlusion_distance, int bounces, double reflection_cutoff,
                       double reflection_offset) {
             return Shading{parse("normals", normals, kNormals),
                            normal_step,
                            parse("shadows", shadows, kShadows),
                            shadow_k,
                            occlusion,
                            occlusion_distance,
                            bounces,
                            reflection_cutoff,
                            reflection_offset};
           }),
           py::arg("normals"), py::arg("normal_step"), py::arg("shadows"), py::arg("shadow_k"), py::arg("occlusion"),
           py::arg("occlusion_distance"), py::arg("bounces"), py::arg("reflection_cutoff"),
           py::arg("reflection_offset"))
      .def_property_readonly("normals", name_of(&Shading::normals, kNormals))
      .def_readonly("normal_step", &Shading::normal_step)
      .def_property_readonly("shadows", name_of(&Shading::shadows, kShadows))
      .def_readonly("shadow_k", &Shading::shadow_k)
      .def_readonly("occlusion", &Shading::occlusion)
      .def_readonly("occlusion_distance", &Shading::occlusion_distance)
      .def_readonly("bounces", &Shading::bounces)
      .def_readonly("reflection_cutoff", &Shading::reflection_cutoff)
      .def_readonly("reflection_offset", &Shading::reflection_offset);
}

}  // namespace

void register_scene(py::module_& module) {
  register_lights(module);
  register_surroundings(module);
  register_camera(module);
  register_settings(module);
}

}  // namespace octomarch
