// Scenes come as TOML text, the one format; runs go out as one table.
#include "arrays.h"
#include "interrupt.h"
#include "module.h"

#include "../support/trajectory.h"
#include "../support/trajectory_files.h"

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

namespace orthant::python {
namespace py = pybind11;
namespace {

/// A scene with what it was made of: so it goes to other processes.
struct MadeScene {
  std::optional<std::string> text;  // TOML; none: a built-in scene
  std::string name;                 // the built-in one's, or what messages call the text
  std::vector<std::string> sets;
  Scene scene;
};

MadeScene make(const std::optional<std::string>& text, const std::string& name, const std::vector<std::string>& sets) {
  return {text, name, sets, text ? parse_scene(*text, sets, name) : make_scene(name, sets)};
}

py::dict summary(const Run& run) {
  py::dict d;
  d["status"] = name(run.status);
  d["why"] = run.why;
  d["t"] = run.final.t;
  d["steps"] = run.steps;
  d["seconds"] = run.seconds;
  d["energy_initial"] = run.energy_initial;
  d["energy_final"] = run.energy_final;
  d["max_joint_residual"] = run.max_joint_residual;
  d["max_joint_rate"] = run.max_joint_rate;
  d["max_penetration"] = run.max_penetration;
  d["max_lcp_residual"] = run.max_lcp_residual;
  d["accepted"] = run.accepted;
  d["rejected"] = run.rejected;
  d["lcp_solves"] = run.lcp_solves;
  d["lcp_iterations"] = run.lcp_iterations;
  d["events"] = run.events;
  d["crossings"] = run.crossings;
  d["energy_rises"] = run.energy_rises;
  d["max_energy_rise"] = run.max_energy_rise;
  d["passages"] = run.passages;
  return d;
}

py::tuple run_scene(const MadeScene& made, const std::string& integrator_spec, const std::string& solver_spec,
                    std::optional<double> step, std::optional<double> duration, long every,
                    std::optional<double> time_limit) {
  const Scene& scene = made.scene;
  const System system(scene);
  const auto integrator = make_integrator(integrator_spec, system);
  const auto solver = make_solver(solver_spec);
  const Interruptible interruptible;
  const Clock clock{step.value_or(scene.step), duration.value_or(scene.duration), every, time_limit.value_or(kInf),
                    interruptible.flag()};
  const auto columns = trajectory_columns(scene);
  std::vector<double> table;
  Run run;
  {
    const py::gil_scoped_release others_may_run;
    run = simulate(*integrator, *solver, clock, [&](const Moment& moment) { append_row(system, moment, table); });
  }
  interruptible.raise();
  const auto width = static_cast<py::ssize_t>(columns.size());
  const py::array_t<double> array({static_cast<py::ssize_t>(table.size()) / width, width}, table.data());
  py::object unsolved = py::none();
  if (run.status != Status::solved && integrator->problem().size() > 0) unsolved = py::cast(Lcp(integrator->problem()));
  return py::make_tuple(columns, array, summary(run), unsolved);
}

void write_run(const std::filesystem::path& file, const MadeScene& made, const std::vector<std::string>& columns,
               const py::array_t<double, py::array::c_style | py::array::forcecast>& table) {
  if (table.ndim() != 2 || columns != trajectory_columns(made.scene) ||
      table.shape(1) != static_cast<py::ssize_t>(columns.size()))
    throw std::invalid_argument("table: must have the columns of the scene's runs");
  write_trajectory(file, made.scene, columns, {table.data(), table.data() + table.size()});
}

}  // namespace

void add_mechanics(py::module_& m) {
  py::class_<MadeScene>(m, "_Scene")
      .def(py::init(&make))
      .def_readonly("text", &MadeScene::text)
      .def_readonly("sets", &MadeScene::sets)
      .def_property_readonly("bodies",
                             [](const MadeScene& s) {
                               std::vector<std::string> names;
                               for (const Body& b : s.scene.bodies) names.push_back(b.name);
                               return names;
                             })
      .def("__reduce__", [](const py::object& self) {
        const auto& s = self.cast<const MadeScene&>();
        return py::make_tuple(py::type::of(self), py::make_tuple(s.text, s.name, s.sets));
      });
  m.def("_simulate", &run_scene);
  m.def("_write_trajectory", &write_run);
  m.def("_integrators", [] {
    std::vector<std::tuple<std::string_view, std::string_view, std::string>> table;
    for (const IntegratorEntry& e : integrators()) table.emplace_back(e.name, e.summary, e.options());
    return table;
  });
  m.def("_scenes", [] {
    std::vector<std::tuple<std::string_view, std::string_view, std::string>> table;
    for (const SceneEntry& e : scenes()) table.emplace_back(e.name, e.summary, e.options());
    return table;
  });
}

}  // namespace orthant::python
