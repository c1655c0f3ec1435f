// One registration function per concept; module.cpp calls them all.
#pragma once

#include <pybind11/pybind11.h>

namespace octomarch {

void register_node(pybind11::module_& module);
void register_expression(pybind11::module_& module);
void register_shape(pybind11::module_& module);
void register_many(pybind11::module_& module);
void register_scene(pybind11::module_& module);
void register_reference(pybind11::module_& module);
void register_program(pybind11::module_& module);
void register_render(pybind11::module_& module);

}  // namespace octomarch
