// Scenes come as TOML text, the one format; runs go out as one table.
#include "arrays.h"
#include "custom_elements.h"
#include "interrupt.h"
#include "module.h"

#include "../report/parts.h"
#include "../report/view.h"
#include "../support/check.h"
#include "../support/drawing.h"
#include "../support/event_table.h"
#include "../support/pushes.h"
#include "../support/trajectory.h"
#include "../support/trajectory_files.h"
#include "../support/warnings.h"

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/run_fields.h>
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
  std::vector<py::dict> customs;  // joints and contacts written in Python
  Scene scene;
};

MadeScene make(const std::optional<std::string>& text, const std::string& name, const std::vector<std::string>& sets,
               const std::vector<py::dict>& customs) {
  MadeScene made{text, name, sets, customs, text ? parse_scene(*text, sets, name) : make_scene(name, sets)};
  for (const py::dict& custom : customs) add_custom_element(custom, made.scene);
  if (!customs.empty()) check(made.scene);
  return made;
}

py::dict summary(const Run& run) {
  py::dict d;
  d["status"] = name(run.status);
  d["why"] = run.why;
  d["t"] = run.final.t;
  visit_fields(run, [&](const char* field, const char*, const char*, auto value) {
    if (static_cast<double>(value) != kInf) d[field] = value;
  });
  return d;
}

py::dict check_of(const CheckedRun& checked) {
  py::dict errors, digits, d;
  for (const CheckedColumn& c : checked.columns) errors[py::str(c.name)] = c.error, digits[py::str(c.name)] = c.digits;
  d["against"] = checked.against;
  d["left_out"] = checked.left_out;
  d["error"] = errors, d["digits"] = digits;
  return d;
}

/// Columns t, kind, contact (both by number), impulse_n, impulse_t.
py::tuple event_columns(const std::vector<Event>& events) {
  const auto n = static_cast<py::ssize_t>(events.size());
  py::array_t<double> t(n), normal(n), tangent(n);
  py::array_t<int> kind(n), contact(n);
  for (py::ssize_t i = 0; i < n; ++i) {
    const Event& event = events[static_cast<std::size_t>(i)];
    t.mutable_at(i) = event.t, normal.mutable_at(i) = event.normal, tangent.mutable_at(i) = event.tangent;
    kind.mutable_at(i) = static_cast<int>(event.kind), contact.mutable_at(i) = event.contact;
  }
  return py::make_tuple(t, kind, contact, normal, tangent);
}

std::vector<Event> events_of(const py::tuple& columns) {
  const auto t = columns[0].cast<py::array_t<double>>(), normal = columns[3].cast<py::array_t<double>>(),
             tangent = columns[4].cast<py::array_t<double>>();
  const auto kind = columns[1].cast<py::array_t<int>>(), contact = columns[2].cast<py::array_t<int>>();
  std::vector<Event> events;
  for (py::ssize_t i = 0; i < t.size(); ++i)
    events.push_back({t.at(i), static_cast<EventKind>(kind.at(i)), contact.at(i), normal.at(i), tangent.at(i)});
  return events;
}

/// Rows t, collision, shapes a and b, point; x, y [m], normal, impulse [N s].
py::array_t<double> push_table(const std::vector<Push>& pushes) {
  py::array_t<double> table({static_cast<py::ssize_t>(pushes.size()), py::ssize_t{10}});
  double* row = table.mutable_data();
  for (const Push& p : pushes) {
    const std::array<double, 10> entries = {p.t,
                                            static_cast<double>(p.pair.collision),
                                            static_cast<double>(p.pair.a),
                                            static_cast<double>(p.pair.b),
                                            static_cast<double>(p.pair.point),
                                            p.point.x(),
                                            p.point.y(),
                                            p.normal.x(),
                                            p.normal.y(),
                                            p.impulse};
    row = std::copy(entries.begin(), entries.end(), row);
  }
  return table;
}

std::vector<Push> pushes_of(const py::array_t<double, py::array::c_style | py::array::forcecast>& table) {
  std::vector<Push> pushes;
  for (py::ssize_t i = 0; table.ndim() == 2 && table.shape(1) == 10 && i < table.shape(0); ++i) {
    const double* x = table.data(i, 0);
    const auto whole = [&](int k) { return static_cast<int>(x[k]); };
    pushes.push_back({x[0], {whole(1), whole(2), whole(3), whole(4)}, {x[5], x[6]}, {x[7], x[8]}, x[9]});
  }
  return pushes;
}

/// `warn` is called with the words of each warning: before the run of those about its start.
py::tuple run_scene(const MadeScene& made, const std::string& integrator_spec, const std::string& solver_spec,
                    std::optional<double> step, std::optional<double> duration, long every,
                    std::optional<double> time_limit, bool stop_when_rounded, bool check, const py::function& warn) {
  const Scene& scene = made.scene;
  const System system(scene);
  const auto integrator = make_integrator(integrator_spec, system);
  const auto solver = make_solver(solver_spec);
  const Interruptible interruptible;
  const Clock clock{step.value_or(scene.step),
                    duration.value_or(scene.duration),
                    every,
                    time_limit.value_or(kInf),
                    interruptible.flag(),
                    stop_when_rounded ? Rounded::stop : Rounded::take};
  const auto columns = trajectory_columns(scene);
  for (const Remark& remark : remarks_on_start(system)) warn((remark.warning ? "" : "note: ") + remark.words);
  std::vector<double> table;
  std::vector<Event> events;
  PushLog pushes(system);
  const bool pushing = PushLog::wanted(system, clock);
  Run run;
  std::optional<CheckedRun> checked;
  {
    const py::gil_scoped_release others_may_run;
    run = simulate(*integrator, *solver, clock, [&](const Moment& moment) {
      append_row(system, moment, table);
      append_events(system, moment.events, events);
      if (pushing) pushes.add(moment);
    });
    if (check && run.status == Status::solved) checked = check_run(system, integrator_spec, solver_spec, clock, run);
  }
  const py::object interruption = interruptible.raised();
  for (const std::string& warning : warnings_of(system, run, integrator_spec, clock.step)) warn(warning);
  const auto width = static_cast<py::ssize_t>(columns.size());
  const py::array_t<double> array({static_cast<py::ssize_t>(table.size()) / width, width}, table.data());
  py::object unsolved = py::none();
  if (run.status != Status::solved && integrator->problem().size() > 0) unsolved = py::cast(Lcp(integrator->problem()));
  py::dict d = summary(run);
  if (checked) d["check"] = check_of(*checked);
  return py::make_tuple(columns, array, d, unsolved, event_columns(events), interruption, push_table(pushes.pushes()));
}

void write_run(const std::filesystem::path& file, const MadeScene& made, const std::vector<std::string>& columns,
               const py::array_t<double, py::array::c_style | py::array::forcecast>& table, const py::tuple& events) {
  if (table.ndim() != 2 || columns != trajectory_columns(made.scene) ||
      table.shape(1) != static_cast<py::ssize_t>(columns.size()))
    throw std::invalid_argument("table: must have the columns of the scene's runs");
  write_trajectory(file, made.scene, columns, {table.data(), table.data() + table.size()}, events_of(events));
}

std::string page_of(const std::string& title, const std::string& note, const MadeScene& made,
                    const std::vector<std::string>& columns,
                    const py::array_t<double, py::array::c_style | py::array::forcecast>& table,
                    const py::tuple& events,
                    const py::array_t<double, py::array::c_style | py::array::forcecast>& pushes) {
  RecordedRun run{columns, {table.data(), table.data() + table.size()}, {}, {}, pushes_of(pushes)};
  const auto names = event_contacts(made.scene);
  for (const Event& e : events_of(events))
    run.events.push_back({e.t, std::string(kEventNames[static_cast<std::size_t>(e.kind)]),
                          names[static_cast<std::size_t>(e.contact)], e.normal, e.tangent});
  const py::gil_scoped_release others_may_run;
  return view_page(view_data(title, note, run, drawing(made.scene)));
}

}  // namespace

void add_mechanics(py::module_& m) {
  py::class_<MadeScene>(m, "_Scene")
      .def(py::init(&make), py::arg("text"), py::arg("name"), py::arg("sets"),
           py::arg("customs") = std::vector<py::dict>())
      .def_readonly("text", &MadeScene::text)
      .def_readonly("name", &MadeScene::name)
      .def_readonly("sets", &MadeScene::sets)
      .def_property_readonly("bodies",
                             [](const MadeScene& s) {
                               std::vector<std::string> names;
                               for (const Body& b : s.scene.bodies) names.push_back(b.name);
                               return names;
                             })
      .def_property_readonly("contacts", [](const MadeScene& s) { return event_contacts(s.scene); })
      .def_property_readonly("drawing", [](const MadeScene& s) { return drawing(s.scene).dump(); })
      .def_property_readonly("initial", [](const MadeScene& s) { return to_numpy(System(s.scene).initial_state().q); })
      .def("__reduce__", [](const py::object& self) {
        const auto& s = self.cast<const MadeScene&>();
        return py::make_tuple(py::type::of(self), py::make_tuple(s.text, s.name, s.sets, s.customs));
      });
  m.def("_simulate", &run_scene);
  m.def("_write_trajectory", &write_run);
  m.def("_view_page", &page_of);
  m.def("_set_folder_of_parts", &set_folder_of_parts);
  m.def("_register_scene", [](const std::string& name, const std::string& text, const std::string& summary,
                              const std::vector<py::dict>& customs) {
    make(text, name, {}, customs);                          // a mistake is said now
    const auto* kept = new std::vector<py::dict>(customs);  // as long as the process lives, longer than the interpreter
    register_scene({name, summary,
                    [name, text, kept](std::span<const std::string> sets) {
                      const py::gil_scoped_acquire lock;
                      return make(text, name, {sets.begin(), sets.end()}, *kept).scene;
                    },
                    [] { return std::vector<OptionEntry>(); }});
  });
  m.attr("_event_kinds") = std::vector<std::string_view>(kEventNames.begin(), kEventNames.end());
  m.def("_integrators", [] {
    std::vector<std::tuple<std::string_view, std::string_view, std::string>> table;
    for (const IntegratorEntry& e : integrators()) table.emplace_back(e.name, e.summary, text_of(e.options()));
    return table;
  });
  m.def("_scenes", [] {
    std::vector<std::tuple<std::string_view, std::string_view, std::string>> table;
    for (const SceneEntry& e : scenes()) table.emplace_back(e.name, e.summary, text_of(e.options()));
    return table;
  });
}

}  // namespace orthant::python
