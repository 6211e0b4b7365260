// Scenes come as TOML text, the one format; runs go out as one table.
#include "experiments/python/arrays.h"
#include "experiments/python/custom_elements.h"
#include "experiments/python/interrupt.h"
#include "experiments/python/module.h"

#include "experiments/report/parts.h"
#include "experiments/report/view.h"
#include "experiments/runs/check.h"
#include "experiments/runs/drawing.h"
#include "experiments/runs/event_table.h"
#include "experiments/runs/pushes.h"
#include "experiments/runs/solids.h"
#include "experiments/runs/trajectory.h"
#include "experiments/runs/trajectory_files.h"
#include "experiments/runs/warnings.h"

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/run_fields.h>
#include <orthant/solvers/registry.h>

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <type_traits>
#include <variant>

namespace orthant::python {
namespace py = pybind11;
namespace {

/// A scene with what it was made of: so it goes to other processes.
struct MadeScene {
  std::optional<std::string> text;  // TOML; none: a built-in scene
  std::string name;                 // the built-in one's, or what messages call the text
  std::vector<std::string> sets;
  std::vector<py::dict> customs;  // joints and contacts written in Python
  AnyScene scene;
};

template <class Scene> using SpaceOf = std::conditional_t<std::is_same_v<Scene, orthant::Scene>, Planar, Spatial>;

MadeScene make(const std::optional<std::string>& text, const std::string& name, const std::vector<std::string>& sets,
               const std::vector<py::dict>& customs) {
  MadeScene made{text, name, sets, customs, text ? parse_any_scene(*text, sets, name) : make_any_scene(name, sets)};
  if (customs.empty()) return made;
  auto* planar = std::get_if<Scene>(&made.scene);
  if (planar == nullptr)
    throw std::invalid_argument("type = \"custom\": joints and contacts written in Python must be in a planar scene");
  for (const py::dict& custom : customs) add_custom_element(custom, *planar);
  if (!customs.front().contains("copied")) check(*planar);  // it would call functions that a copied run does not have
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

struct RunRequest {
  std::string integrator, solver;
  Clock clock;
  bool check = false, reactions = false;
};

/// What a run leaves for Python, but its columns and table.
template <class Space> struct Kept {
  std::vector<double> table, joints;  // by rows; coordinates of joints in space
  std::vector<Event> events;
  std::vector<std::string> joint_columns;
  std::vector<Push> pushes;  // of searched collisions in the plane
  Run run;
  std::optional<CheckedRun> checked;
  std::optional<Lcp> unsolved;
};

template <class Space>
Kept<Space> run_system(const SystemOf<Space>& system, const RunRequest& wanted, const py::function& warn) {
  Kept<Space> kept;
  const auto integrator = make_integrator(wanted.integrator, system);
  const auto solver = make_solver(wanted.solver);
  for (const Remark& remark : remarks_on_start(system)) warn((remark.warning ? "" : "note: ") + remark.words);
  std::conditional_t<kPlanar<Space>, std::monostate, std::optional<JointCoordinates>> coordinates;
  if constexpr (!kPlanar<Space>) kept.joint_columns = coordinates.emplace(system).names();
  std::conditional_t<kPlanar<Space>, std::optional<PushLog>, std::monostate> pushes;
  if constexpr (kPlanar<Space>)
    if (PushLog::wanted(system, wanted.clock)) pushes.emplace(system);
  std::optional<ReactionsOf<Space>> reactions;
  if (wanted.reactions) reactions.emplace(system);
  const py::gil_scoped_release others_may_run;
  kept.run = simulate(*integrator, *solver, wanted.clock, [&](const RunSampleOf<Space>& moment) {
    append_row(system, moment, kept.table);
    if (reactions) append_reactions(*reactions, moment, kept.table);
    append_events(system, moment.events, kept.events);
    if constexpr (kPlanar<Space>) {
      if (pushes) pushes->add(moment);
    } else {
      for (const double value : coordinates->at(moment.state)) kept.joints.push_back(value);
    }
  });
  if constexpr (kPlanar<Space>)
    if (pushes) kept.pushes = pushes->pushes();
  if (wanted.check && kept.run.status == Status::solved)
    kept.checked = check_run(system, wanted.integrator, wanted.solver, wanted.clock, kept.run);
  if (kept.run.status != Status::solved && integrator->problem().size() > 0) kept.unsolved = integrator->problem();
  return kept;
}

py::array_t<double> by_rows(const std::vector<double>& table, std::size_t columns) {
  const auto width = static_cast<py::ssize_t>(columns);
  return py::array_t<double>({width > 0 ? static_cast<py::ssize_t>(table.size()) / width : 0, width}, table.data());
}

/// `warn` is called with the words of each warning: before the run of those about its start.
template <class Scene> py::tuple run_in(const Scene& scene, RunRequest wanted, std::optional<double> step,
                                        std::optional<double> duration, const py::function& warn) {
  using Space = SpaceOf<Scene>;
  const SystemOf<Space> system(scene);
  const Interruptible interruptible;
  wanted.clock.step = step.value_or(scene.step), wanted.clock.duration = duration.value_or(scene.duration);
  wanted.clock.cancel = interruptible.flag();
  const Kept<Space> kept = run_system(system, wanted, warn);
  const py::object interruption = interruptible.raised();
  for (const std::string& warning : warnings_of(system, kept.run, wanted.integrator, wanted.clock.step)) warn(warning);
  auto columns = trajectory_columns(scene);
  if (wanted.reactions)
    for (std::string& column : reaction_columns(scene)) columns.push_back(std::move(column));
  py::dict d = summary(kept.run);
  if (kept.checked) d["check"] = check_of(*kept.checked);
  const py::object unsolved = kept.unsolved ? py::cast(*kept.unsolved) : py::none();
  return py::make_tuple(columns, by_rows(kept.table, columns.size()), d, unsolved, event_columns(kept.events),
                        interruption, kept.joint_columns, by_rows(kept.joints, kept.joint_columns.size()),
                        push_table(kept.pushes));
}

py::tuple run_scene(const MadeScene& made, const std::string& integrator, const std::string& solver,
                    std::optional<double> step, std::optional<double> duration, long every,
                    std::optional<double> time_limit, bool stop_when_rounded, bool check, bool reactions,
                    const py::function& warn) {
  RunRequest wanted{integrator, solver, {}, check, reactions};
  wanted.clock.every = every, wanted.clock.time_limit = time_limit.value_or(kInf);
  wanted.clock.rounded = stop_when_rounded ? Rounded::stop : Rounded::take;
  return std::visit([&](const auto& scene) { return run_in(scene, wanted, step, duration, warn); }, made.scene);
}

using RunTable = py::array_t<double, py::array::c_style | py::array::forcecast>;

void write_run(const std::filesystem::path& file, const MadeScene& made, const std::vector<std::string>& columns,
               const RunTable& table, const py::tuple& events) {
  std::visit(
      [&](const auto& scene) {
        if (table.ndim() != 2 || !columns_of_run(scene, columns) ||
            table.shape(1) != static_cast<py::ssize_t>(columns.size()))
          throw std::invalid_argument("table: must have the columns of the scene's runs");
        write_trajectory(file, scene, columns, {table.data(), table.data() + table.size()}, events_of(events));
      },
      made.scene);
}

std::vector<std::string> contacts_of_any(const AnyScene& any) {
  return std::visit([](const auto& scene) { return event_contacts(scene); }, any);
}

nlohmann::ordered_json drawing_of(const AnyScene& any) {
  return std::visit([](const auto& scene) { return drawing(scene); }, any);
}

std::string page_of(const std::string& title, const std::string& note, const MadeScene& made,
                    const std::vector<std::string>& columns, const RunTable& table, const py::tuple& events,
                    const RunTable& pushes) {
  RecordedRun run{columns, {table.data(), table.data() + table.size()}, {}, {}, pushes_of(pushes)};
  const auto names = contacts_of_any(made.scene);
  for (const Event& e : events_of(events))
    run.events.push_back({e.t, std::string(kEventNames[static_cast<std::size_t>(e.kind)]),
                          names[static_cast<std::size_t>(e.contact)], e.normal, e.tangent});
  const py::gil_scoped_release others_may_run;
  return view_page(view_data(title, note, run, drawing_of(made.scene)));
}

/// Of each body at the start x, y, θ; in space x, y, z and the quaternion.
py::array_t<double> initial_poses(const Scene& scene) { return to_numpy(System(scene).initial_state().q); }
py::array_t<double> initial_poses(const spatial::Scene& scene) {
  std::vector<double> poses;
  for (const spatial::Body& body : scene.bodies) {
    poses.insert(poses.end(), body.position.begin(), body.position.end());
    poses.insert(poses.end(), body.orientation.begin(), body.orientation.end());
  }
  return py::array_t<double>(static_cast<py::ssize_t>(poses.size()), poses.data());
}

/// (body, whether it is a plane, points, faces) of each solid of a scene in space.
py::list surfaces_of(const MadeScene& made) {
  py::list all;
  if (const auto* scene = std::get_if<spatial::Scene>(&made.scene))
    for (const DrawnSolid& one : solids(*scene)) {
      const Faces faces = surface(one);
      py::list points;
      for (const Vector3d& p : faces.points) points.append(py::make_tuple(p.x(), p.y(), p.z()));
      all.append(py::make_tuple(one.body, std::holds_alternative<drawn::Plane>(one.shape), points, faces.faces));
    }
  return all;
}

}  // namespace

void add_mechanics(py::module_& m) {
  py::class_<MadeScene>(m, "_Scene")
      .def(py::init(&make), py::arg("text"), py::arg("name"), py::arg("sets"),
           py::arg("customs") = std::vector<py::dict>())
      .def_readonly("text", &MadeScene::text)
      .def_readonly("name", &MadeScene::name)
      .def_readonly("sets", &MadeScene::sets)
      .def_readonly("customs", &MadeScene::customs)
      .def_property_readonly("dimension",
                             [](const MadeScene& s) { return std::holds_alternative<Scene>(s.scene) ? 2 : 3; })
      .def_property_readonly("bodies",
                             [](const MadeScene& s) {
                               std::vector<std::string> names;
                               std::visit(
                                   [&](const auto& scene) {
                                     for (const auto& b : scene.bodies) names.push_back(b.name);
                                   },
                                   s.scene);
                               return names;
                             })
      .def_property_readonly("contacts", [](const MadeScene& s) { return contacts_of_any(s.scene); })
      .def_property_readonly("drawing", [](const MadeScene& s) { return drawing_of(s.scene).dump(); })
      .def_property_readonly("surfaces", &surfaces_of)
      .def_property_readonly("initial",
                             [](const MadeScene& s) {
                               return std::visit([](const auto& scene) { return initial_poses(scene); }, s.scene);
                             })
      .def("__reduce__", [](const py::object& self) {
        const auto& s = self.cast<const MadeScene&>();
        return py::make_tuple(py::type::of(self), py::make_tuple(s.text, s.name, s.sets, s.customs));
      });
  m.def("_simulate", &run_scene);
  m.def("_write_trajectory", &write_run);
  m.def("_view_page", &page_of);
  m.def("_set_folder_of_parts", &set_folder_of_parts);
  m.def("_register_scene", [](const std::string& name, const MadeScene& scene, const std::string& summary) {
    struct Source {
      std::optional<std::string> text;
      std::string name;
      std::vector<std::string> sets;
      std::vector<py::dict> customs;
    };
    // Kept as long as the process lives, longer than the interpreter.
    const auto* from = new Source{scene.text, scene.text ? name : scene.name, scene.sets, scene.customs};
    const auto made = [from](std::span<const std::string> sets) {
      const py::gil_scoped_acquire lock;
      const auto key = [](const std::string& set) { return set.substr(0, set.find('=')); };
      std::vector<std::string> all;  // of two for one key the later
      for (const std::string& own : from->sets)
        if (std::none_of(sets.begin(), sets.end(), [&](const auto& set) { return key(set) == key(own); }))
          all.push_back(own);
      all.insert(all.end(), sets.begin(), sets.end());
      return make(from->text, from->name, all, from->customs).scene;
    };
    std::visit(
        [&](const auto& of_its_kind) {
          using Kind = std::decay_t<decltype(of_its_kind)>;
          register_scene(SceneEntryOf<Kind>{
              name, summary, [made](std::span<const std::string> sets) { return std::get<Kind>(made(sets)); },
              [] { return std::vector<OptionEntry>(); }});
        },
        scene.scene);
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
    for (const SpatialSceneEntry& e : spatial_scenes()) table.emplace_back(e.name, e.summary, text_of(e.options()));
    return table;
  });
}

}  // namespace orthant::python
