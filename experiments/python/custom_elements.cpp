#include "experiments/python/custom_elements.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

namespace orthant::python {
namespace py = pybind11;
namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Pairs of bodies that callbacks get as poses and twists. Under the interpreter's lock, which a run has given up; an
/// exception of a callback ends the run.
class Bodies {
 public:
  Bodies(std::vector<BodyId> a, std::vector<BodyId> b, bool many) : a_(std::move(a)), b_(std::move(b)), many_(many) {}

  std::size_t size() const { return a_.size(); }
  BodyId a(std::size_t i) const { return a_[i]; }
  BodyId b(std::size_t i) const { return b_[i]; }

  py::tuple poses(const Kinematics& k, bool second) const {
    return three(second, [&k](BodyId body) {
      const Pose& p = k.at(body);
      return std::array<double, 3>{p.x.x(), p.x.y(), p.theta};
    });
  }
  py::tuple twists(const Kinematics& k, bool second) const {
    return three(second, [&k](BodyId body) {
      const Twist& v = k.rate(body);
      return std::array<double, 3>{v.v.x(), v.v.y(), v.omega};
    });
  }

  /// Poses, and twists where these count: results are kept as long as it stays the same.
  void key(const Kinematics& k, bool with_twists, std::vector<double>& to) const {
    to.clear();
    for (const auto* side : {&a_, &b_})
      for (const BodyId body : *side) {
        const Pose& p = k.at(body);
        to.insert(to.end(), {p.x.x(), p.x.y(), p.theta});
        if (!with_twists) continue;
        const Twist& v = k.rate(body);
        to.insert(to.end(), {v.v.x(), v.v.y(), v.omega});
      }
  }

  /// All bodies moved on by their twists for `time` [s].
  Kinematics moved(const Kinematics& k, double time) const {
    Kinematics there = k;
    there.t = k.t + time;
    for (const auto* side : {&a_, &b_})
      for (const BodyId body : *side) {
        if (body == kGround) continue;
        const Pose& p = k.at(body);
        const double theta = p.theta + time * k.rate(body).omega;
        there.pose[static_cast<std::size_t>(body)] = {p.x + time * k.rate(body).v, theta, std::cos(theta),
                                                      std::sin(theta)};
      }
    return there;
  }
  double fastest(const Kinematics& k) const {
    double most = 1;
    for (const auto* side : {&a_, &b_})
      for (const BodyId body : *side) most = std::max(most, k.rate(body).v.norm() + std::abs(k.rate(body).omega));
    return most;
  }

 private:
  template <class Get> py::tuple three(bool second, const Get& get) const {
    const auto& side = second ? b_ : a_;
    if (!many_) {
      const auto x = get(side[0]);
      return py::make_tuple(x[0], x[1], x[2]);
    }
    const auto n = static_cast<py::ssize_t>(side.size());
    std::array<py::array_t<double>, 3> all{py::array_t<double>(n), py::array_t<double>(n), py::array_t<double>(n)};
    for (py::ssize_t i = 0; i < n; ++i) {
      const auto x = get(side[static_cast<std::size_t>(i)]);
      for (std::size_t c = 0; c < 3; ++c) all[c].mutable_at(i) = x[c];
    }
    return py::make_tuple(all[0], all[1], all[2]);
  }

  std::vector<BodyId> a_, b_;
  bool many_;
};

/// The Jacobian row of body entries j[0…5] in steps of `stride`.
Row row_of(BodyId a, BodyId b, const double* j, std::size_t stride) {
  Row row{a, b, {}, {}};
  for (std::size_t c = 0; c < 3; ++c) row.ja[c] = j[c * stride], row.jb[c] = j[(c + 3) * stride];
  return row;
}

double rate_of(const Row& row, const Kinematics& k) {
  double sum = 0;
  for (const auto& [body, j] : {std::pair{row.a, row.ja}, std::pair{row.b, row.jb}})
    if (body != kGround) sum += j[0] * k.rate(body).v.x() + j[1] * k.rate(body).v.y() + j[2] * k.rate(body).omega;
  return sum;
}

/// d/dt of rates along the motion: central differences of fourth order, good to about 1e-11 of the rows' changes.
template <class Rates> std::vector<double> change_of(const Bodies& bodies, const Kinematics& k, const Rates& rates) {
  const double h = 1e-3 / bodies.fastest(k);  // [s]
  const auto at = [&](double time) { return rates(bodies.moved(k, time)); };
  const std::vector<double> p1 = at(h), m1 = at(-h), p2 = at(2 * h), m2 = at(-2 * h);
  std::vector<double> change(p1.size());
  for (std::size_t i = 0; i < change.size(); ++i) change[i] = (8 * (p1[i] - m1[i]) - (p2[i] - m2[i])) / (12 * h);
  return change;
}

/// Contacts that are computed together.
class ContactGroup {
 public:
  ContactGroup(std::string name, Bodies bodies, bool many, py::object gap, py::object rows, py::object bias)
      : bodies_(std::move(bodies)),
        name_(std::move(name)),
        many_(many),
        gap_(std::move(gap)),
        rows_(std::move(rows)),
        bias_(std::move(bias)) {}

  const Bodies& bodies() const { return bodies_; }

  double gap(std::size_t i, const Kinematics& k) const {
    const py::gil_scoped_acquire lock;
    keep(gaps_, k, false, [&] {
      auto gaps = numbers(gap_(bodies_.poses(k, false), bodies_.poses(k, true)));
      if (gaps.size() != bodies_.size())
        throw py::type_error(label() + (many_ ? "gap returned something else: must be a distance [m] of each, (n,)"
                                              : "gap returned no number: must be the distance [m], > 0: open"));
      return gaps;
    });
    return gaps_.values[i];
  }

  ContactRows rows(std::size_t i, const Kinematics& k) const {
    const py::gil_scoped_acquire lock;
    fill_rows(k);
    return rows_of(i);
  }

  ContactBias bias(std::size_t i, const Kinematics& k) const {
    const py::gil_scoped_acquire lock;
    const std::size_t n = bodies_.size();
    keep(biases_, k, true, [&] {
      if (bias_.is_none())
        return change_of(bodies_, k, [&](const Kinematics& there) {
          fill_rows(there);
          std::vector<double> rates(2 * n);
          for (std::size_t j = 0; j < n; ++j) {
            const ContactRows r = rows_of(j);
            rates[j] = rate_of(r.normal, there), rates[n + j] = rate_of(r.tangent, there);
          }
          return rates;
        });
      auto biases = numbers(
          bias_(bodies_.poses(k, false), bodies_.poses(k, true), bodies_.twists(k, false), bodies_.twists(k, true)));
      if (biases.size() != n && biases.size() != 2 * n)
        throw py::type_error(label() + (many_ ? "bias returned something else: must be (n,) numbers, or (2, n)"
                                              : "bias returned something else: must be one number, or two"));
      biases.resize(2 * n, 0.0);
      return biases;
    });
    return {biases_.values[i], biases_.values[n + i]};
  }

 private:
  struct Kept {
    std::vector<double> key, values;
  };

  std::string label() const { return "contact \"" + name_ + "\": "; }

  static std::vector<double> numbers(const py::object& from) {
    const auto x = Numbers::ensure(from);
    if (!x) {
      PyErr_Clear();
      return {};
    }
    return {x.data(), x.data() + x.size()};
  }

  /// What `compute` gives, once per motion.
  template <class Compute> void keep(Kept& kept, const Kinematics& k, bool with_twists, const Compute& compute) const {
    bodies_.key(k, with_twists, key_);
    if (!kept.key.empty() && kept.key == key_) return;
    std::vector<double> key = key_;  // `compute` may keep other things
    kept.key.clear();                // and may throw
    kept.values = compute();
    kept.key = std::move(key);
  }

  void fill_rows(const Kinematics& k) const {
    keep(jacobian_, k, false, [&] {
      auto rows = numbers(rows_(bodies_.poses(k, false), bodies_.poses(k, true)));
      const std::size_t n = bodies_.size();
      if (rows.size() != 6 * n && rows.size() != 12 * n)
        throw py::type_error(label() +
                             "rows returned something else: must be the rate of the gap as 6 numbers, of (x, y, angle) "
                             "of both bodies, or those of gap and slip as (2, 6) numbers" +
                             (many_ ? "; of n contacts (6, n) or (2, 6, n)" : ""));
      rows.resize(12 * n, 0.0);
      return rows;
    });
  }
  ContactRows rows_of(std::size_t i) const {
    const std::size_t n = bodies_.size();
    const double* j = jacobian_.values.data() + i;
    return {row_of(bodies_.a(i), bodies_.b(i), j, n), row_of(bodies_.a(i), bodies_.b(i), j + 6 * n, n)};
  }

  Bodies bodies_;
  std::string name_;
  bool many_;
  py::object gap_, rows_, bias_;
  mutable Kept gaps_, jacobian_, biases_;  // read and written under the interpreter's lock
  mutable std::vector<double> key_;
};

struct PythonContact {
  std::string name;
  BodyId a = kGround, b = kGround;
  ContactLaw law;
  std::shared_ptr<const ContactGroup> group;
  std::size_t place = 0;
  double reach = std::numeric_limits<double>::infinity();  // [m]

  double gap(const Kinematics& k) const { return group->gap(place, k); }
  ContactRows rows(const Kinematics& k) const { return group->rows(place, k); }
  ContactBias bias(const Kinematics& k) const { return group->bias(place, k); }
  double length() const { return reach; }
};

/// The callbacks of a joint; each is given (pose of a, pose of b), and of a joint driven in time also t.
struct JointCalls {
  std::string name;
  Bodies bodies;
  py::object residual, rows, bias, rate;

  std::vector<double> call(const py::object& function, const char* what, const Kinematics& k, std::size_t size) const {
    const py::tuple two = py::make_tuple(bodies.poses(k, false), bodies.poses(k, true));
    const auto x = Numbers::ensure(rate.is_none() ? function(*two) : function(*two, k.t));
    if (!x || static_cast<std::size_t>(x.size()) != size) {
      PyErr_Clear();
      throw py::type_error("joint \"" + name + "\": " + what + " returned something else: must be " +
                           std::to_string(size) + " number" + (size == 1 ? "" : "s"));
    }
    return {x.data(), x.data() + x.size()};
  }
};

template <int N> struct PythonJoint {
  static constexpr int kRows = N;
  std::string name;
  BodyId a = kGround, b = kGround;
  std::shared_ptr<const JointCalls> calls;

  void residual(const Kinematics& k, double* phi) const {
    const py::gil_scoped_acquire lock;
    const auto x = calls->call(calls->residual, "residual", k, N);
    std::copy(x.begin(), x.end(), phi);
  }
  void rows(const Kinematics& k, Row* G) const {
    const py::gil_scoped_acquire lock;
    const auto x = calls->call(calls->rows, "rows", k, 6 * N);
    for (std::size_t i = 0; i < N; ++i) G[i] = row_of(a, b, x.data() + 6 * i, 1);
  }
  void bias(const Kinematics& k, double* wanted) const {
    const py::gil_scoped_acquire lock;
    std::vector<double> x;
    if (calls->bias.is_none()) {
      x = change_of(calls->bodies, k, [&](const Kinematics& there) {
        const auto j = calls->call(calls->rows, "rows", there, 6 * N);
        std::vector<double> missing(N, 0.0);
        if (!calls->rate.is_none()) missing = calls->call(calls->rate, "rate", there, N);
        for (std::size_t i = 0; i < N; ++i) missing[i] = rate_of(row_of(a, b, j.data() + 6 * i, 1), there) - missing[i];
        return missing;
      });
    } else {
      const Bodies& two = calls->bodies;
      const py::tuple given =
          py::make_tuple(two.poses(k, false), two.poses(k, true), two.twists(k, false), two.twists(k, true));
      const auto y = Numbers::ensure(calls->rate.is_none() ? calls->bias(*given) : calls->bias(*given, k.t));
      if (!y || y.size() != N) {
        PyErr_Clear();
        throw py::type_error("joint \"" + name + "\": bias returned something else: must be " + std::to_string(N) +
                             " number" + (N == 1 ? "" : "s"));
      }
      x.assign(y.data(), y.data() + N);
    }
    std::copy(x.begin(), x.end(), wanted);
  }
};

/// Driven in time.
template <int N> struct DrivenPythonJoint : PythonJoint<N> {
  void rate(const Kinematics& k, double* wanted) const {
    const py::gil_scoped_acquire lock;
    const auto x = this->calls->call(this->calls->rate, "rate", k, N);
    std::copy(x.begin(), x.end(), wanted);
  }
};

template <int N> void add_joint(const std::shared_ptr<const JointCalls>& calls, Scene& scene) {
  PythonJoint<N> joint{calls->name, calls->bodies.a(0), calls->bodies.b(0), calls};
  if (calls->rate.is_none())
    scene.joint(std::move(joint));
  else
    scene.joint(DrivenPythonJoint<N>{std::move(joint)});
}

}  // namespace

void add_custom_element(const py::dict& spec, Scene& scene) {
  const auto kind = spec["kind"].cast<std::string>(), name = spec["name"].cast<std::string>();
  const auto ids = [&](const char* side) {
    std::vector<BodyId> list;
    for (const auto& body : spec[side].cast<std::vector<std::string>>()) {
      if (body == "ground") {
        list.push_back(kGround);
        continue;
      }
      const auto at =
          std::find_if(scene.bodies.begin(), scene.bodies.end(), [&](const Body& b) { return b.name == body; });
      if (at == scene.bodies.end())
        throw std::invalid_argument(kind + " \"" + name + "\": bodies: \"" + body + "\": must be the name of a body");
      list.push_back(static_cast<BodyId>(at - scene.bodies.begin()));
    }
    return list;
  };
  const bool many = spec["many"].cast<bool>();
  Bodies bodies(ids("a"), ids("b"), many);
  const auto function = [&](const char* key) { return py::reinterpret_borrow<py::object>(spec[key]); };
  if (kind == "joint") {
    const auto calls = std::make_shared<const JointCalls>(JointCalls{
        name, std::move(bodies), function("residual"), function("rows"), function("bias"), function("rate")});
    switch (spec["count"].cast<int>()) {
      case 1:
        return add_joint<1>(calls, scene);
      case 2:
        return add_joint<2>(calls, scene);
      default:
        return add_joint<3>(calls, scene);
    }
  }
  const auto number = [&](const char* key) { return spec[key].cast<double>(); };
  PythonContact contact;
  contact.law = {number("mu"), number("e_n"), number("e_t"), number("mu_static"), number("belt")};
  if (!spec["length"].is_none()) contact.reach = number("length");
  contact.group = std::make_shared<const ContactGroup>(name, std::move(bodies), many, function("gap"), function("rows"),
                                                       function("bias"));
  for (contact.place = 0; contact.place < contact.group->bodies().size(); ++contact.place) {
    contact.name = many ? name + "-" + std::to_string(contact.place + 1) : name;
    contact.a = contact.group->bodies().a(contact.place), contact.b = contact.group->bodies().b(contact.place);
    scene.contact(PythonContact(contact));
  }
}

}  // namespace orthant::python
