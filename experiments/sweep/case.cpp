#include "experiments/sweep/case.h"

#include "experiments/sweep/drift.h"

#include "experiments/runs/manifest.h"
#include "experiments/runs/trajectory.h"
#include "experiments/support/clock.h"

#include <orthant/core/lcp/files/io.h>
#include <orthant/core/mechanics/spatial/friction_impulse.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/core/scenes/slider_crank_exact.h>
#include <orthant/core/support/hash.h>
#include <orthant/core/support/options.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/run_fields.h>
#include <orthant/solvers/registry.h>

#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <variant>

namespace orthant {
namespace {

std::string fingerprint(std::string_view text) {
  char digits[17];
  std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(fnv1a(text)));
  return digits;
}

/// The columns that describe the case.
ResultRow description(const Case& c) {
  nlohmann::ordered_json parameters = nlohmann::ordered_json::object();
  for (const auto& [name, value] : c.parameters) parameters[name] = value;
  ResultRow row = {{"key", c.key()},
                   {"scene", c.scene},
                   {"parameters", parameters.dump()},
                   {"integrator", c.integrator},
                   {"solver", c.solver},
                   {"step", c.step},
                   {"rtol", nullptr},
                   {"duration", c.duration},
                   {"measure", c.measure},
                   {"compared_with", c.reference},
                   {"repeats", c.repeats},
                   {"time_limit", c.time_limit},
                   {"revision", revision()}};
  if (c.rtol) row["rtol"] = *c.rtol;
  return row;
}

nlohmann::ordered_json number(double x) { return std::isfinite(x) ? nlohmann::ordered_json(x) : nullptr; }

constexpr double kLasting = 0.01;  // of the duration: a contact of this length is no impact, its end a release
constexpr double kBridged = 5;     // steps: schemes may carry a lasting contact by an impulse every few steps

/// What is summed up along a run, besides what Run holds. Times are ends of steps.
class Along {
 public:
  explicit Along(const Clock& clock) : clock_(clock) {}

  double impulse = 0, friction_impulse = 0, first_touch = kInf, touching = 0;
  double first_release = kInf, last_release = kInf;

  template <class Space> void add(const SystemOf<Space>& system, const RunSampleOf<Space>& moment) {
    const double t = moment.state.t;
    double normal = 0;
    for (std::size_t i = 0; i < moment.impulses.size(); ++i) {
      const auto& one = moment.impulses[i];
      normal += one.normal;
      friction_impulse += size_of(along_unit_tangents(system.law(static_cast<int>(i)), one.tangent));
    }
    impulse += normal;
    if (t - last_ > (kBridged + 0.5) * clock_.step && last_ - since_ > kLasting * clock_.duration) {
      first_release = std::min(first_release, last_), last_release = last_;
      last_ = since_ = -kInf;
    }
    if (normal > 0) {
      if (!(t - last_ <= (kBridged + 0.5) * clock_.step)) since_ = before_;
      last_ = t;
      first_touch = std::min(first_touch, t), touching += t - before_;
    }
    before_ = t;
  }

 private:
  Clock clock_;
  double before_ = 0, since_ = -kInf, last_ = -kInf;  // the step's begin; of the contact: begin, last force
};

constexpr double kLong = 0.1;  // [s] two runs of this length are measured well enough
constexpr int kLeast = 2;      // runs, for a scatter

/// Coordinates of joints, which are measures in space, followed along a run.
template <class Space> struct Followed {
  explicit Followed(const SystemOf<Space>&) {}
  void add(const State&) {}
  std::vector<double> values;
};
template <> struct Followed<Spatial> {
  explicit Followed(const SystemOf<Spatial>& system) : coordinates(system) {}
  void add(const State& x) { values = coordinates.at(x); }
  JointCoordinates coordinates;
  std::vector<double> values;
};

template <class Space>
void run_in(ResultRow& row, const Case& c, std::optional<double> reference, const SystemOf<Space>& system) {
  const auto& scene = system.scene();
  const auto columns = measures_of(scene);
  const auto column = std::find(columns.begin(), columns.end(), c.measure);
  if (column == columns.end()) throw std::invalid_argument("measure '" + c.measure + "': the scene has no such column");
  const Clock clock{.step = c.step, .duration = c.duration};
  Along along(clock);
  Drift<Space> drift(system);
  Followed<Space> joints(system);
  const auto integrator = make_integrator(c.integrator_spec(), system);
  const Run run = simulate(*integrator, *make_solver(c.solver), clock, [&](const RunSampleOf<Space>& moment) {
    along.add(system, moment), drift.add(moment.state), joints.add(moment.state);
  });
  double seconds = c.repeats > 0 ? kInf : run.seconds, slowest = 0;
  for (int i = 0; i < c.repeats && (i < kLeast || seconds < kLong); ++i) {  // once more, to be timed: nothing recorded
    const auto again = make_integrator(c.integrator_spec(), system);
    const auto solver = make_solver(c.solver);
    const double start = rival::processor_time();
    simulate(*again, *solver, clock);
    const double taken = rival::processor_time() - start;
    seconds = std::min(seconds, taken), slowest = std::max(slowest, taken);
  }
  const bool solved = run.status == Status::solved;
  std::vector<double> last;
  append_row(system,
             {run.final, {}, integrator->gaps(), integrator->impulses(), integrator->frictions(), integrator->events()},
             last);
  last.insert(last.end(), joints.values.begin(), joints.values.end());
  const double value = last[static_cast<std::size_t>(column - columns.begin())];
  if (c.known) {
    reference = c.known;
  } else if (!reference && !c.reference.empty()) {
    if (const auto other = c.reference_case()) {
      reference = answer_of(run_case(*other));
    } else {
      reference = exact_measure(c);
    }
  }
  row.update({{"status", name(run.status)},
              {"why", run.why},
              {"value", number(value)},
              {"reference", number(reference.value_or(kInf))},
              {"error", solved ? number(std::abs(value - reference.value_or(kInf))) : nullptr},
              {"energy_drift", number(drift.energy())},
              {"momentum_drift", number(drift.momentum())},
              {"spin_drift", number(drift.spin())},
              {"impulse", number(along.impulse)},
              {"friction_impulse", number(along.friction_impulse)},
              {"first_touch", number(along.first_touch)},
              {"first_release", number(along.first_release)},
              {"last_release", number(along.last_release)},
              {"touching", number(along.touching)},
              {"slowest", number(slowest > 0 ? slowest : kInf)},
              {"seconds", number(seconds)}});
  visit_fields(run, [&](const std::string& field, const char*, const char*, auto measured) {
    if constexpr (std::is_same_v<decltype(measured), long>)
      row[field] = measured;
    else if (field != "seconds")
      row[field] = number(measured);
  });
  if (solved && reference && !std::isfinite(*reference)) row["why"] = "its reference run was not solved";
  if (run.status == Status::unsupported && run.why.empty())
    row["why"] = make_solver(c.solver)->why_not(integrator->problem());
  if (!solved && integrator->problem().size() > 0)
    row["problem"] = to_json(integrator->problem(), "scene " + c.scene + ", integrator " + c.integrator_spec() +
                                                        ", solver " + c.solver + ", case " + c.key());
}

void run_into(ResultRow& row, const Case& c, std::optional<double> reference) {
  std::visit([&](const auto& system) { run_in(row, c, reference, system); }, make_any_system(c.scene, c.sets()));
}

/// The file that this code was loaded from: the program, or the Python package's module.
std::string whole_program() {
  const auto here = reinterpret_cast<std::uintptr_t>(&fingerprint);
  std::ifstream maps("/proc/self/maps");
  std::string line, file = "/proc/self/exe";
  while (std::getline(maps, line)) {  // BEGIN-END … FILE, hexadecimal
    std::size_t dash = 0;
    const std::uintptr_t begin = std::stoull(line, &dash, 16), end = std::stoull(line.substr(dash + 1), nullptr, 16);
    if (const auto name = line.find('/'); begin <= here && here < end && name != std::string::npos)
      file = line.substr(name);
  }
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

std::vector<std::string> measures_of(const Scene& scene) { return trajectory_columns(scene); }
std::vector<std::string> measures_of(const spatial::Scene& scene) {
  auto columns = trajectory_columns(scene);
  const SystemOf<Spatial> system(scene);
  const auto joints = JointCoordinates(system).names();
  columns.insert(columns.end(), joints.begin(), joints.end());
  return columns;
}

std::string revision() {
  static const std::string text = [] {
    std::string built = manifest().at("revision").get<std::string>();
    if (built.ends_with("+changes") || built == "unknown") built += "-" + fingerprint(whole_program());
    return built;
  }();
  return text;
}

std::string Case::integrator_spec() const {
  if (!rtol) return integrator;
  return integrator + (integrator.find(':') == std::string::npos ? ":" : ",") + "rtol=" + detail::text_of(*rtol) +
         ",atol=" + detail::text_of(std::max(1e-3 * *rtol, 1e-15));
}

std::vector<std::string> Case::sets() const {
  std::vector<std::string> all;
  for (const auto& [name, value] : parameters) {  // a scene file reads TOML, a built-in scene bare words
    if (name == kSceneParameter) continue;
    const bool bare = value.is_string() && scene_text.empty();
    all.push_back(name + '=' +
                  (value.is_number() ? detail::text_of(value.get<double>())
                   : bare            ? value.get<std::string>()
                                     : value.dump()));
  }
  return all;
}

std::string Case::key() const {
  static const auto build = manifest();
  nlohmann::ordered_json all = {scene_text.empty() ? scene : scene_text,
                                sets(),
                                integrator_spec(),
                                solver,
                                step,
                                duration,
                                measure,
                                reference,
                                repeats,
                                revision(),
                                build.at("compiler"),
                                build.at("flags")};
  if (known) all.push_back(*known);
  return fingerprint(all.dump());
}

std::optional<Case> Case::reference_case() const {
  if (reference.empty() || reference == "exact" || known) return {};
  Case other = *this;
  // Lemke's method takes no discs.
  const bool in_space = std::holds_alternative<spatial::Scene>(make_any_scene(scene, sets()));
  other.integrator = reference, other.solver = in_space ? "auto" : "lemke", other.reference.clear();
  other.rtol.reset(), other.repeats = 0, other.step = duration;
  return other;
}

double exact_measure(const Case& c) {
  double mu = 0.01, e = 0.4;  // SliderCrank's
  const auto refuse = [](const std::string& what) {
    throw std::invalid_argument(
        "reference = 'exact': known for slider_crank with mu in {0, 0.01, 0.1}, e in {0, 0.4, 0.9} "
        "and no other parameters, after 0.2 s; not for " +
        what);
  };
  if (c.scene != "slider_crank") refuse("the scene " + c.scene);
  if (c.duration != 0.2) refuse("duration = " + detail::text_of(c.duration));
  for (const auto& [name, value] : c.parameters) {
    if (name == kSceneParameter) continue;
    if ((name != "mu" && name != "e") || !value.is_number()) refuse(name + " = " + value.dump());
    (name == "mu" ? mu : e) = value.get<double>();
  }
  const auto exact = slider_crank_exact(mu, e);
  if (!exact) refuse("mu = " + detail::text_of(mu) + ", e = " + detail::text_of(e));
  if (c.measure == "crank.theta") return exact->theta1;
  if (c.measure == "rod.theta") return exact->theta2;
  if (c.measure == "crank.omega") return exact->omega1;
  if (c.measure == "rod.omega") return exact->omega2;
  if (c.measure != "energy") refuse("the measure " + c.measure);
  return exact->energy;
}

double answer_of(const ResultRow& row) {
  const bool known = row.at("status") == "solved" && !row.at("value").is_null();
  return known ? row.at("value").get<double>() : std::numeric_limits<double>::quiet_NaN();
}

ResultRow run_case(const Case& c, std::optional<double> reference) {
  ResultRow row = unfinished_row(c, "refused", "");
  try {
    run_into(row, c, reference);
  } catch (const std::exception& error) {  // an integrator that does not take the scene, say
    row["why"] = error.what();
  }
  return row;
}

ResultRow unfinished_row(const Case& c, const std::string& status, const std::string& why) {
  ResultRow row = description(c);
  row["status"] = status, row["why"] = why;
  return row;
}

}  // namespace orthant
