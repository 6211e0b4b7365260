#include "custom_contact.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace orthant::python {
namespace py = pybind11;
namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// The callbacks are called under the interpreter's lock, which a run has given up; what they raise ends the run.
struct PythonContact {
  std::string name;
  BodyId a = kGround, b = kGround;
  ContactLaw law;
  std::shared_ptr<const CustomSpec> spec;

  double gap(const Kinematics& k) const {
    const py::gil_scoped_acquire lock;
    const py::object value = spec->gap(pose(k.at(a)), pose(k.at(b)));
    try {
      return value.cast<double>();
    } catch (const py::cast_error&) {
      throw py::type_error("contact \"" + name + "\": gap returned no number: must be the distance [m], > 0: open");
    }
  }
  ContactRows rows(const Kinematics& k) const {
    const py::gil_scoped_acquire lock;
    const auto x = Numbers::ensure(spec->rows(pose(k.at(a)), pose(k.at(b))));
    if (!x || !((x.ndim() == 1 && x.shape(0) == 6) || (x.ndim() == 2 && x.shape(0) == 2 && x.shape(1) == 6))) {
      PyErr_Clear();
      throw py::type_error("contact \"" + name +
                           "\": rows returned something else: must be the rate of the gap as 6 numbers, of "
                           "(x, y, angle) of both bodies, or those of gap and slip as (2, 6) numbers");
    }
    ContactRows r{{a, b, {}, {}}, {a, b, {}, {}}};
    const double* p = x.data();
    std::copy(p, p + 3, r.normal.ja.begin()), std::copy(p + 3, p + 6, r.normal.jb.begin());
    if (x.ndim() == 2) std::copy(p + 6, p + 9, r.tangent.ja.begin()), std::copy(p + 9, p + 12, r.tangent.jb.begin());
    return r;
  }
  ContactBias bias(const Kinematics& k) const {
    if (spec->bias.is_none()) return bias_by_differences(k);
    const py::gil_scoped_acquire lock;
    const auto x = Numbers::ensure(spec->bias(pose(k.at(a)), pose(k.at(b)), twist(k.rate(a)), twist(k.rate(b))));
    if (!x || x.size() < 1 || x.size() > 2) {
      PyErr_Clear();
      throw py::type_error("contact \"" + name + "\": bias returned something else: must be one number, or two");
    }
    return {x.data()[0], x.size() == 2 ? x.data()[1] : 0.0};
  }
  double length() const { return spec->length.value_or(std::numeric_limits<double>::infinity()); }

 private:
  static py::tuple pose(const Pose& p) { return py::make_tuple(p.x.x(), p.x.y(), p.theta); }
  static py::tuple twist(const Twist& v) { return py::make_tuple(v.v.x(), v.v.y(), v.omega); }

  /// d/dt (rows v) along the motion v: central differences of fourth order; errors of about 1e-11 of the rows' changes.
  ContactBias bias_by_differences(const Kinematics& k) const {
    const auto speed = [&](BodyId body) { return k.rate(body).v.norm() + std::abs(k.rate(body).omega); };
    const double h = 1e-3 / std::max({1.0, speed(a), speed(b)});  // [s]
    const auto rates = [&](double time) {
      Kinematics there = k;
      for (const BodyId body : {a, b}) {
        if (body == kGround) continue;
        Pose& p = there.pose[static_cast<std::size_t>(body)];
        const double theta = p.theta + time * k.rate(body).omega;
        p = {p.x + time * k.rate(body).v, theta, std::cos(theta), std::sin(theta)};
      }
      const ContactRows r = rows(there);
      const auto rate = [&](const Row& row) {
        double sum = 0;
        for (const auto& [body, j] : {std::pair{a, row.ja}, std::pair{b, row.jb}})
          if (body != kGround) sum += j[0] * k.rate(body).v.x() + j[1] * k.rate(body).v.y() + j[2] * k.rate(body).omega;
        return sum;
      };
      return Vector2d(rate(r.normal), rate(r.tangent));
    };
    const Vector2d change = (8 * (rates(h) - rates(-h)) - (rates(2 * h) - rates(-2 * h))) / (12 * h);
    return {change.x(), change.y()};
  }
};

}  // namespace

CustomSpec custom_spec(const py::tuple& from) {
  CustomSpec spec{from[0].cast<std::string>(),
                  from[1].cast<std::string>(),
                  from[2].cast<std::string>(),
                  from[3],
                  from[4],
                  from[5],
                  {},
                  {}};
  spec.law = {from[6].cast<double>(), from[7].cast<double>(), from[8].cast<double>(), from[9].cast<double>(),
              from[10].cast<double>()};
  if (!from[11].is_none()) spec.length = from[11].cast<double>();
  return spec;
}

void add_custom_contact(const CustomSpec& spec, Scene& scene) {
  const auto body = [&](const std::string& name) {
    if (name == "ground") return kGround;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
      if (scene.bodies[i].name == name) return static_cast<BodyId>(i);
    throw std::invalid_argument("contact \"" + spec.name + "\": bodies: \"" + name + "\": must be the name of a body");
  };
  PythonContact contact{spec.name, body(spec.body_a), body(spec.body_b), spec.law,
                        std::make_shared<const CustomSpec>(spec)};
  scene.contact(std::move(contact));
}

}  // namespace orthant::python
