// experiments/python/custom_contact.h — a contact kind written in Python: gap, rows and bias are callbacks.
#pragma once

#include <orthant/core/mechanics/scene/scene.h>

#include <pybind11/pybind11.h>

#include <optional>
#include <string>

namespace orthant::python {

/// Arguments of Scene.add("contact", type="custom", …). rows: rates of gap and slip as (6,) or (2, 6) numbers, one
/// for each of (ẋ, ẏ, ω) of a, then of b; bias: d/dt of both at zero acceleration, None: by differences of the rows.
struct CustomSpec {
  std::string name, body_a, body_b;
  pybind11::object gap, rows, bias;
  ContactLaw law;
  std::optional<double> length;
};

/// From the tuple (name, a, b, gap, rows, bias, mu, e_n, e_t, mu_static, belt, length) of the Python side.
CustomSpec custom_spec(const pybind11::tuple& from);

/// Adds the contact to a scene, which check(scene) then compares with its derivatives (derivatives.h).
/// Throws std::invalid_argument for a body that does not exist.
void add_custom_contact(const CustomSpec& spec, Scene& scene);

}  // namespace orthant::python
