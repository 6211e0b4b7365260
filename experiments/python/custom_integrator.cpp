// Integrators written in Python: function(step) gives the state at the end of a step.
#include "experiments/python/arrays.h"
#include "experiments/python/module.h"

#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/integrators/between_events/listed_contacts.h>
#include <orthant/integrators/registry.h>

#include <pybind11/stl.h>

#include <algorithm>
#include <numeric>

namespace orthant::python {
namespace py = pybind11;
namespace {

/// What the function of a step is given. Once that has returned, all but the numbers is gone.
class PythonStep {
 public:
  struct Work {
    const System& system;
    Solver& solver;
    Terms& terms;
    Lcp& problem;
    StepReport& report;
  };

  PythonStep(const Work& work, const State& x, double h) : work_(&work), x_(x), h_(h) {}
  void end() { work_ = nullptr; }

  double t() const { return x_.t; }
  double h() const { return h_; }
  py::array_t<double> q() const { return to_numpy(x_.q); }
  py::array_t<double> v() const { return to_numpy(x_.v); }
  py::array_t<double> mass() const { return to_numpy(work().system.mass()); }
  py::array_t<double> laws(double ContactLaw::*what) const {
    Vector values;
    values.resize(work().system.contacts());
    for (Index i = 0; i < values.size(); ++i) values[i] = work().system.law(static_cast<int>(i)).*what;
    return to_numpy(values);
  }

  py::dict terms(double t, py::handle q, py::handle v) const {
    const System& system = work().system;
    Terms& terms = work().terms;
    Vector positions, velocities;
    read(q, "q", system.dof(), Entries::finite, positions);
    read(v, "v", system.dof(), Entries::finite, velocities);
    set_poses(system, t, positions, terms.at);
    set_twists(system, velocities, terms.at);
    evaluate_forces(system, t, velocities, terms);
    evaluate_joints(system, terms);
    evaluate_gaps(system, terms);
    std::vector<int> all(static_cast<std::size_t>(system.contacts()));
    std::iota(all.begin(), all.end(), 0);
    evaluate_closed(system, all, terms);
    evaluate_biases(system, terms);
    const auto n = static_cast<Index>(all.size());
    Eigen::MatrixXd G = Eigen::MatrixXd::Zero(system.joint_rows(), system.dof()),
                    N = Eigen::MatrixXd::Zero(n, system.dof()), T = N;
    Vector normal_bias, tangent_bias;
    normal_bias.resize(n), tangent_bias.resize(n);
    for (Index i = 0; i < G.rows(); ++i) spread(terms.G[static_cast<std::size_t>(i)], i, G);
    for (Index i = 0; i < n; ++i) {
      const auto at = static_cast<std::size_t>(i);
      spread(terms.closed[at].rows.normal, i, N), spread(terms.closed[at].rows.tangent, i, T);
      normal_bias[i] = terms.contact_bias[at].normal, tangent_bias[i] = terms.contact_bias[at].tangent;
    }
    py::dict d;
    d["f"] = to_numpy(terms.f);
    d["G"] = table(G), d["phi"] = to_numpy(terms.phi);
    d["joint_rate"] = to_numpy(terms.joint_rate), d["joint_bias"] = to_numpy(terms.joint_bias);
    d["gap"] = to_numpy(terms.gap), d["W_N"] = table(N), d["W_T"] = table(T);
    d["normal_bias"] = to_numpy(normal_bias), d["tangent_bias"] = to_numpy(tangent_bias);
    return d;
  }

  py::object solve(py::handle M, py::handle q, py::handle lower, py::handle upper, py::handle friction) const {
    const Work& with = work();
    with.problem =
        Lcp(py::cast<const Lcp&>(py::module_::import("orthant").attr("Problem")(M, q, lower, upper, friction)));
    Solution solution;
    {
      const py::gil_scoped_release others_may_run;
      with.solver.solve(with.problem, solution, Start::cold);
    }
    return with.report.note(with.problem, solution) ? py::object(to_numpy(solution.z)) : py::none();
  }

 private:
  const Work& work() const {
    if (work_ == nullptr) throw std::runtime_error("this step is over: must be used within its own call");
    return *work_;
  }
  static void spread(const Row& row, Index i, Eigen::MatrixXd& to) {
    for (const auto& [body, j] : {std::pair{row.a, row.ja}, std::pair{row.b, row.jb}})
      for (Index c = 0; body >= 0 && c < kBlock; ++c) to(i, kBlock * body + c) += j[static_cast<std::size_t>(c)];
  }
  static py::array_t<double> table(const Eigen::MatrixXd& m) {
    constexpr auto kWord = static_cast<py::ssize_t>(sizeof(double));
    return py::array_t<double>({m.rows(), m.cols()}, {kWord, kWord * m.rows()}, m.data());
  }

  const Work* work_;
  State x_;
  double h_;
};

class CallbackIntegrator final : public Integrator {
 public:
  static constexpr Capabilities kCan{.impact_laws = false, .loaded_friction = false, .threads = false};

  CallbackIntegrator(const System& system, const std::string& name, const py::function& function)
      : Integrator(system, name, kCan), terms_(system), name_(name), function_(function) {
    ListedContacts::refuse(system, name);
  }

  StepReport step(double h, Solver& solver, State& x) override {
    StepReport report = StepReport::solved();
    const py::gil_scoped_acquire interpreter;
    problem_ = Lcp{};
    const PythonStep::Work work{system_, solver, terms_, problem_, report};
    const auto given = std::make_shared<PythonStep>(work, x, h);
    py::object made;
    try {
      made = function_(py::cast(given));
    } catch (...) {
      given->end();
      throw;
    }
    given->end();
    if (made.is_none()) {
      if (report.status == Status::solved) fail(report, Status::stalled, "the function of '" + name_ + "' gave up");
      return report;
    }
    take(made, h, x, report);
    return report;
  }

  void remember(CheckpointData&) override {}
  const Lcp& problem() const override { return problem_; }

 private:
  void take(const py::object& made, double h, State& x, StepReport& report) {
    const bool pair = py::isinstance<py::tuple>(made) && (py::len(made) == 2 || py::len(made) == 3);
    const std::string label = "integrator '" + name_ + "': ";
    if (!pair) throw py::type_error(label + "must return (q, v), (q, v, impulses), or None where it gives up");
    const auto parts = py::reinterpret_borrow<py::tuple>(made);
    Vector q, v;
    read(parts[0], label + "q", system_.dof(), Entries::finite, q);
    read(parts[1], label + "v", system_.dof(), Entries::finite, v);
    std::fill(impulses_.begin(), impulses_.end(), Impulse{});
    if (parts.size() == 3) {
      const Eigen::MatrixXd impulses = read_table(parts[2], label + "impulses");
      if (impulses.rows() != system_.contacts() || impulses.cols() != 2)
        throw std::invalid_argument(label + "impulses: must have a row (normal, tangent) [N s] for each contact");
      for (Index i = 0; i < impulses.rows(); ++i)
        impulses_[static_cast<std::size_t>(i)] = {impulses(i, 0), impulses(i, 1)};
    }
    report.status = Status::solved;
    x.t += h, x.q = q, x.v = v;
    set_poses(system_, x.t, x.q, terms_.at);
    evaluate_joints(system_, terms_);
    evaluate_gaps(system_, terms_);
    gaps_ = terms_.gap;
    if (terms_.phi.size() > 0) report.joint_residual = terms_.phi.cwiseAbs().maxCoeff();
    for (Index i = 0; i < terms_.phi.size(); ++i)
      report.joint_rate = std::max(report.joint_rate, std::abs(terms_.missing_rate(i, x.v)));
    if (gaps_.size() > 0) report.penetration = std::max(0.0, -gaps_.minCoeff());
  }

  Terms terms_;
  Lcp problem_;
  std::string name_;
  const py::function& function_;  // of the registry, which keeps it
};

void register_scheme(const std::string& name, const py::function& function, const std::string& summary) {
  const auto* kept = new py::function(function);  // as long as the process lives, longer than the interpreter
  const auto make_one = [kept, name](const System& system, std::string_view options) -> std::unique_ptr<Integrator> {
    if (!options.empty())
      throw std::invalid_argument("options '" + std::string(options) + "': an integrator written in Python has none");
    return std::make_unique<CallbackIntegrator>(system, name, *kept);
  };
  register_integrator(
      {name, summary, make_one, nullptr, [] { return std::vector<OptionEntry>(); }, CallbackIntegrator::kCan});
}

}  // namespace

void add_integrators(py::module_& m) {
  py::class_<PythonStep, std::shared_ptr<PythonStep>>(
      m, "Step", "A step to be made by a function of register_integrator: from t [s] and (q, v) over h [s].")
      .def_property_readonly("t", &PythonStep::t, "[s] at its start")
      .def_property_readonly("h", &PythonStep::h, "[s] its length")
      .def_property_readonly("q", &PythonStep::q, "(dof,) x, y [m], angle [rad] of each body")
      .def_property_readonly("v", &PythonStep::v, "(dof,) their rates")
      .def_property_readonly("mass", &PythonStep::mass, "(dof,) diagonal of M: mass, mass [kg], inertia [kg m^2]")
      .def_property_readonly(
          "mu", [](const PythonStep& s) { return s.laws(&ContactLaw::mu); }, "(contacts,) of friction")
      .def_property_readonly(
          "e_n", [](const PythonStep& s) { return s.laws(&ContactLaw::e); }, "(contacts,) of restitution")
      .def("terms", &PythonStep::terms, py::arg("t"), py::arg("q"), py::arg("v"),
           "Of the equations of motion at (t, q, v), as a dict of arrays: f (dof,) forces; G (rows, dof), phi, "
           "joint_rate,\n"
           "joint_bias (rows,) of joints: phi = 0, G v = joint_rate, G dv/dt + joint_bias = 0; gap (contacts,), W_N, "
           "W_T\n"
           "(contacts, dof) rates of gap and slip, normal_bias, tangent_bias (contacts,) their d/dt at zero "
           "acceleration.")
      .def("solve", &PythonStep::solve, py::arg("M"), py::arg("q"), py::arg("lower") = py::none(),
           py::arg("upper") = py::none(), py::arg("friction") = py::none(),
           "z of a problem as of orthant.solve, by the run's own solver, or None: then give up, returning None.");
  m.def("_register_integrator", &register_scheme);
}

}  // namespace orthant::python
