// The native module octomarch._core: errors first, then every concept's registration.
#include <pybind11/pybind11.h>

#include "octomarch/base/error.hpp"
#include "octomarch/bindings/register.hpp"

PYBIND11_MODULE(_core, module) {
  module.doc() = "Native core of octomarch. Use the package octomarch; this module may change without notice.";
  pybind11::register_exception<octomarch::SceneError>(module, "SceneError", PyExc_RuntimeError);
  octomarch::register_node(module);
  octomarch::register_expression(module);  // before shapes, so that the signature of paint() reads Material
  octomarch::register_shape(module);
  octomarch::register_many(module);
  octomarch::register_scene(module);
  octomarch::register_program(module);
  octomarch::register_render(module);
  octomarch::register_reference(module);
}
