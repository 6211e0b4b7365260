// experiments/studies/motion_storm/scene_runs.h — runs of one scene by integrators and steps, each run once and kept.
#pragma once

#include "experiments/studies/motion_storm/examine.h"
#include "experiments/studies/motion_storm/judge.h"
#include "experiments/studies/motion_storm/spatial_twin.h"

#include <orthant/core/support/options.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

namespace orthant::motion_storm {

/// The state that the scene's bodies start in.
inline State start_of(const Scene& scene) {
  const auto n = static_cast<Eigen::Index>(3 * scene.bodies.size());
  State x{.t = 0, .q = Eigen::VectorXd(n), .v = Eigen::VectorXd(n)};
  for (Eigen::Index b = 0; b < n / 3; ++b) {
    const Body& body = scene.bodies[static_cast<std::size_t>(b)];
    x.q.segment<3>(3 * b) << body.position, body.angle;
    x.v.segment<3>(3 * b) << body.velocity, body.omega;
  }
  return x;
}
inline State start_of(const spatial::Scene& scene) { return SystemOf<Spatial>(scene).initial_state(); }

inline constexpr int kFine = 140, kCoarse = 4;  // output steps; all times of the coarse ones are among the fine
inline constexpr double kLeast = 1e-8;          // [J/kg] of energy, and the square of a speed, that count

inline bool precise(const std::string& spec) {
  return spec.starts_with("event-driven") || spec.starts_with("adaptive");
}
inline bool event_driven(const std::string& spec) { return spec.starts_with("event-driven"); }

/// [m/s] of b's surface, at most.
inline double surface_speed(const Contact& contact) {
  return std::visit([](const auto& x) { return std::abs(ContactLaw(x.law).belt); }, contact);
}
inline double surface_speed(const spatial::Contact& contact) {
  const SurfaceLaw s = std::visit([](const auto& x) { return x.law.surface; }, contact);
  return s.velocity.norm() + 10 * s.omega.norm();
}
inline double torque_of(const Load& l) { return std::abs(l.torque); }
inline double torque_of(const spatial::Load& l) { return l.moment.norm(); }
/// [N m] about the body's centre, at most.
inline double moment_of(const Load& l) { return torque_of(l) + l.point.norm() * l.force.norm(); }
inline double moment_of(const spatial::Load& l) { return torque_of(l) + l.point.norm() * l.force.norm(); }
inline double least_inertia_of(const Scene& scene, const Measure& /*measure*/, BodyId b) {
  return scene.bodies[static_cast<std::size_t>(b)].inertia;
}
inline double least_inertia_of(const spatial::Scene& /*scene*/, const SpatialMeasure& measure, BodyId b) {
  return measure.least_inertia(b);
}
inline double spin_of(const Body& b) { return std::abs(b.omega); }
inline double spin_of(const spatial::Body& b) { return b.omega.norm(); }

/// A run is that of an integrator with a change of the scene or of its step.
template <class Space> class SceneRuns {
  using Scene = SceneOf<Space>;

 public:
  SceneRuns(const Scene& scene, const Limits& limits) : scene_(scene), limits_(limits) {
    for (const auto& j : scene.joints) driven_ = driven_ || driven(j);
    for (const auto& b : scene.bodies) mass_ += b.mass;
  }

  struct Seen {
    Trace trace;
    Figures figures;
  };
  using Key = std::pair<std::string, std::string>;  // integrator, what is different

  double own_step(const std::string& spec) const { return precise(spec) ? scene_.duration / kFine : scene_.step; }

  static Allowance allowance(const std::string& spec, double step) {
    return {precise(spec) ? 0 : step, precise(spec) && !event_driven(spec) ? 1e-4 : 1e-7};
  }

  const Seen& run(const std::string& spec, const std::string& how, double step, const TwinOf<Space>& change = {}) {
    const auto [at, fresh] = seen_.try_emplace(Key{spec, how});
    if (!fresh) return at->second;
    const bool same = change.name.empty() && change.nudge == 0;
    const Scene other = same ? scene_ : twin_of(scene_, change);
    Seen& s = at->second;
    s.trace = trace(other, spec, step * change.tau, limits_.time, limits_.grace);
    if (!change.name.empty())
      for (State& x : s.trace.rows) x.q = back(change, x.q), x.t /= change.tau;
    s.figures = examine(scene_, s.trace, allowance(s.trace.run.crossings > 0 ? "adaptive" : spec, step));
    return s;
  }

  const Seen& base(const std::string& spec) { return run(spec, "", own_step(spec)); }
  const Seen& quarter(const std::string& spec) { return run(spec, "h/4", own_step(spec) / 4); }
  const Seen& nudged(const std::string& spec, double by) {
    return run(spec, "nudged by " + detail::text_of(by), own_step(spec), {.nudge = by});
  }

  /// The first fault of the figures, in words.
  Result figures_fault(const std::string& spec, const Seen& s, std::string& why) {
    const Figures& f = s.figures;
    const double h = precise(spec) ? 0 : own_step(spec);
    if (!f.finite) return why = "numbers that are none", Result::nan;
    if (f.joint.value > 1e-6 * f.size + h * f.speed) return why = f.joint.where, Result::joints;
    const Admissibility& reported = s.trace.run.motion;
    const bool warned = h > 0 && reported.deep() && f.depth.value <= 1.1 * reported.max_overlap;
    if (f.depth_share.value > 1 && !warned) return why = f.depth.where, Result::penetration;
    if (f.passed.value > kPassed && s.trace.run.passages < f.passages)
      return why = f.passed.where + "; " + std::to_string(s.trace.run.passages) + " of " + std::to_string(f.passages) +
                   " passages reported",
             Result::passage;
    const bool exact = event_driven(spec) && s.trace.run.crossings == 0;
    const double share = exact ? 1e-6 : precise(spec) ? 1e-3 : 0.05;
    const bool said = h > 0 && reported.energy_off() && f.gain.value <= 2 * reported.energy_defect;
    const bool bounded =
        !driven_ && f.overlap < 1e-9;  // speeds by the energy: needles may spin fast about their length
    if (bounded && !said && f.gain.value > share * f.energy + kLeast * mass_)
      return why = f.gain.where + " of " + detail::text_of(f.energy), Result::energy;
    if (!bounded && f.speed > 100 * expected_speed() && !others_as_fast(spec))
      return why = "points at " + detail::text_of(f.speed) + " m/s, expected are some " +
                   detail::text_of(expected_speed()),
             Result::energy;
    return Result::solved;
  }

  /// The same of a scheme's run; of schemes of fixed step those faults that a quarter of the step does not mend.
  Result admissible(const std::string& spec, std::string& why) {
    const Seen& s = base(spec);
    const Result first = figures_fault(spec, s, why);
    if (precise(spec) || first == Result::solved || first == Result::nan || first == Result::passage) return first;
    const Seen& q = quarter(spec);
    std::string again;
    if (q.trace.solved() && (figures_fault(spec, q, again) != first || size_of(first, q) < size_of(first, s) / 2)) {
      why.clear();
      return Result::solved;
    }
    if (first != Result::energy) return first;
    // With few steps a bounce the energy of a quarter may be off by as much: then a 32nd tells.
    const Seen& fine = run(spec, "h/32", own_step(spec) / 32);
    if (!fine.trace.solved()) return first;
    if (figures_fault(spec, fine, again) == first && size_of(first, fine) >= size_of(first, s) / 2) return first;
    why.clear();
    return Result::solved;
  }

 private:
  static double size_of(Result what, const Seen& s) {
    if (what == Result::joints) return s.figures.joint.value;
    if (what == Result::penetration) return s.figures.depth.value;
    return s.figures.gain.value / s.figures.energy;
  }

  /// Whether two other schemes make points as fast, those of fixed step with a 32nd of the step, or the other precise
  /// one comes to the same motion: a disc between faces that a drive closes to a wedge is pressed out the faster the
  /// sharper that is.
  bool others_as_fast(const std::string& spec) {
    int fast = 0;
    if (precise(spec)) {
      const Seen &s = base(spec), &other = base(event_driven(spec) ? "adaptive" : "event-driven");
      if (other.trace.solved() && difference<Space>(s.trace.rows, other.trace.rows, s.figures.size) < 1e-3) return true;
    }
    for (const char* other : {"event-driven", "adaptive", "moreau-jean", "stewart-trinkle", "rattle"}) {
      if (other == spec) continue;
      const Seen& fine = precise(other) ? base(other) : run(other, "h/32", own_step(other) / 32);
      fast += fine.trace.solved() && fine.figures.finite && fine.figures.speed > 100 * expected_speed();
    }
    return fast >= 2;
  }

 protected:
  /// [m/s] What drives, gravity, loads, springs and the start can make of points, by a rough bound. Heavy bodies make
  /// light ones faster than they are: by the root of their ratio at the most, as kinetic energy goes over.
  double expected_speed() const {
    MeasureOf<Space> measure(scene_);
    double speed = std::sqrt(kLeast), light = kInf, heavy = 0, reach = 0.1;
    for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
      const auto& body = scene_.bodies[b];
      reach = std::max(reach, measure.reach(static_cast<BodyId>(b)));
      speed = std::max(speed, body.velocity.norm() + reach * spin_of(body));
      light = std::min(light, body.mass), heavy = std::max(heavy, body.mass);
    }
    for (const auto& joint : scene_.joints)
      if (const auto* d = std::get_if<typename ElementsOf<Space>::Drive>(&joint)) {
        const double rate = std::abs(d->law.rate_of_change) + std::abs(d->law.amplitude * d->law.omega);
        speed = std::max(speed, rate * (is_angle(d->of) ? reach : 1));
      }
    speed += scene_.gravity.norm() * scene_.duration;
    for (const auto& c : scene_.contacts) speed = std::max(speed, surface_speed(c));
    double spun = 0;  // by moments, which a slender body has next to no inertia against
    for (const auto& l : scene_.loads)
      if (l.body >= 0)
        spun += measure.reach(l.body) * moment_of(l) / least_inertia_of(scene_, measure, l.body) * scene_.duration;
    double stored = 0;
    for (const auto& l : scene_.loads) stored += l.force.norm() + torque_of(l);
    stored += std::abs(measure.potential(start_of(scene_).q)) * (scene_.springs.empty() ? 0 : 1);
    return spun + (speed + std::sqrt(2 * stored / light)) * std::sqrt(heavy / light);
  }

 private:
  const Scene& scene_;
  const Limits& limits_;
  bool driven_ = false;
  double mass_ = 0;  // [kg] of all
  std::map<Key, Seen> seen_;
};

}  // namespace orthant::motion_storm
