#include "experiments/studies/motion_storm/trace.h"

#include "experiments/support/isolated.h"

#include <orthant/core/mechanics/spatial/friction_impulse.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <sys/resource.h>

#include <cmath>
#include <cstring>
#include <ctime>

namespace orthant::motion_storm {
namespace {

/// Bytes of a trace, one way or the other: into `text`, or out of it.
class Bytes {
 public:
  explicit Bytes(std::string text_ = {}) : text(std::move(text_)), reading_(!text.empty()) {}

  template <class Number>
    requires std::is_trivially_copyable_v<Number>
  void operator()(Number& value) {
    if (reading_)
      std::memcpy(&value, text.data() + at_, sizeof value);
    else
      text.append(reinterpret_cast<const char*>(&value), sizeof value);
    at_ += sizeof value;
  }
  void operator()(std::string& words) {
    std::size_t size = words.size();
    (*this)(size), words.resize(size);
    for (char& letter : words) (*this)(letter);
  }
  void operator()(Eigen::VectorXd& values) {
    Eigen::Index size = values.size();
    (*this)(size), values.resize(size);
    for (double& value : values) (*this)(value);
  }

  std::string text;

 private:
  bool reading_;
  std::size_t at_ = 0;
};

void all_of(Trace& t, Bytes& bytes) {
  bytes(t.refused), bytes(t.threw), bytes(t.seconds), bytes(t.run.status), bytes(t.run.why);
  bytes(t.run.energy_rises), bytes(t.run.max_energy_rise), bytes(t.run.passages), bytes(t.run.crossings);
  bytes(t.run.error_estimate);
  bytes(t.run.motion.energy_defect), bytes(t.run.motion.energy_scale);
  bytes(t.run.motion.max_overlap), bytes(t.run.motion.overlap_length), bytes(t.run.motion.overlap_scale);
  std::size_t events = t.events.size();
  bytes(events), t.events.resize(events);
  for (Event& event : t.events) bytes(event);
  std::size_t rows = t.rows.size();
  bytes(rows), t.rows.resize(rows), t.belt.resize(rows), t.pressed.resize(rows);
  for (std::size_t r = 0; r < rows; ++r)
    bytes(t.rows[r].t), bytes(t.rows[r].q), bytes(t.rows[r].v), bytes(t.belt[r]), bytes(t.pressed[r]);
}

double belt_work(const System& system, const RunSample& moment) {
  double work = 0;
  for (int i = 0; i < system.listed(); ++i)
    work += std::abs(system.law(i).belt * moment.impulses[static_cast<std::size_t>(i)].tangent);
  return work;
}
/// Surfaces that turn move at most as fast as at 10 m from their centre.
double belt_work(const SystemOf<Spatial>& system, const RunSampleOf<Spatial>& moment) {
  double work = 0;
  for (int i = 0; i < system.listed(); ++i) {
    const SurfaceLaw& s = system.law(i).surface;
    const Tangents tangent = along_unit_tangents(system.law(i), moment.impulses[static_cast<std::size_t>(i)].tangent);
    work += (s.velocity.norm() + 10 * s.omega.norm()) * size_of(tangent);
  }
  return work;
}

template <class Space> Trace here(const SceneOf<Space>& scene, const std::string& spec, double step, double limit) {
  Trace t;
  const SystemOf<Space> system(scene);
  std::unique_ptr<IntegratorOf<Space>> integrator;
  try {
    integrator = make_integrator(spec, system);
  } catch (const std::invalid_argument& error) {
    t.refused = error.what();
    return t;
  }
  const auto solver = make_solver("auto");
  const Clock clock{.step = step, .duration = scene.duration, .time_limit = limit};
  const std::clock_t begin = std::clock();
  double work = 0;
  try {
    t.run = simulate(*integrator, *solver, clock, [&](const RunSampleOf<Space>& moment) {
      t.rows.push_back(moment.state);
      t.events.insert(t.events.end(), moment.events.begin(), moment.events.end());
      t.belt.push_back(work += belt_work(system, moment));
      double pressed = 0;
      for (const auto& impulse : moment.impulses) pressed += std::abs(impulse.normal);
      t.pressed.push_back(pressed);
    });
  } catch (const std::exception& error) {
    t.threw = std::string("exception: ") + error.what();
  }
  t.seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  return t;
}

template <class Space>
Trace isolated(const SceneOf<Space>& scene, const std::string& spec, double step, double limit, double grace) {
  Isolated process(1, 0);
  Trace t;
  process.start(
      [&] {
        const auto most = static_cast<rlim_t>(std::ceil(limit + grace)) + 1;
        const rlimit seconds{most, most + 1};
        setrlimit(RLIMIT_CPU, &seconds);
        Trace made = here<Space>(scene, spec, step, limit);
        Bytes bytes;
        all_of(made, bytes);
        return bytes.text;
      },
      30 * (limit + grace + 1),
      [&](const Outcome& outcome) {
        if (outcome.kind == Outcome::finished) {
          Bytes bytes(outcome.text);
          all_of(t, bytes);
        } else if (outcome.kind == Outcome::killed || outcome.text == "CPU time limit exceeded") {
          t.late = true;
        } else {
          t.threw = outcome.text;
        }
      });
  process.wait_for_all();
  return t;
}

}  // namespace

Trace trace(const Scene& scene, const std::string& spec, double step, double limit, double grace) {
  return isolated<Planar>(scene, spec, step, limit, grace);
}
Trace trace(const spatial::Scene& scene, const std::string& spec, double step, double limit, double grace) {
  return isolated<Spatial>(scene, spec, step, limit, grace);
}

bool strikes_in_turn(const std::vector<Event>& events, double step) {
  double most = 0;
  for (const Event& e : events)
    if (e.kind == EventKind::impact) most = std::max(most, e.normal);
  const Event* last = nullptr;
  for (const Event& e : events) {
    if (e.kind != EventKind::impact || e.normal < 1e-3 * most) continue;
    if (last != nullptr && e.contact != last->contact && e.t > last->t && e.t - last->t <= step) return true;
    last = &e;
  }
  return false;
}

}  // namespace orthant::motion_storm
