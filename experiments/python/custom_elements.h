// experiments/python/custom_elements.h — joints and contacts written in Python: their values and rows are callbacks.
//
//   A contact, or n of them in one call (lists of bodies): gap, rows and bias of all are computed together, once per
//   motion, and kept until a body of the group moves. A pose is (x, y, angle), numbers or arrays (n,).
#pragma once

#include <orthant/core/mechanics/scene/scene.h>

#include <pybind11/pybind11.h>

namespace orthant::python {

/// Adds what one call of Scene.add("joint" or "contact", type="custom", …) has collected, _scene.py. The bodies,
/// named there, must exist. Throws std::invalid_argument, or pybind11::type_error for what is no function.
void add_custom_element(const pybind11::dict& spec, Scene& scene);

}  // namespace orthant::python
