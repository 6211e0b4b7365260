#include "experiments/studies/motion_storm/judge.h"

#include "experiments/studies/motion_storm/closed_terms.h"
#include "experiments/studies/motion_storm/examine.h"
#include "experiments/studies/motion_storm/painleve.h"
#include "experiments/studies/motion_storm/shared_load.h"
#include "experiments/studies/motion_storm/spatial_twin.h"

#include <orthant/core/support/options.h>
#include <orthant/integrators/registry.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

namespace orthant::motion_storm {
namespace {

using detail::text_of;

constexpr int kFine = 140, kCoarse = 4;  // output steps; all times of the coarse ones are among the fine
constexpr int kFinest = 256;             // parts of a step
constexpr double kNudge = 1e-9;          // for conditioning of references
constexpr double kWell = 1e-5;           // difference that such a nudge makes at the most in a well-conditioned motion
constexpr double kOwnNudge = 1e-7;       // of schemes of fixed step: more than rounding, less than h
constexpr double kMoreNudges[] = {3e-8, -1e-8, 1e-9};                // where a fault depends on what that one shows
constexpr double kFineNudges[] = {-1e-9, 5e-10, 2e-9, -2e-9, 1e-8};  // likewise, of precise ones
constexpr double kClosed = 1e-6;   // [m] contacts with no larger gap, where a run says that it cannot go on
constexpr double kStrikes = 1e-9;  // [m/s]
constexpr double kLeast = 1e-8;    // [J/kg] of energy, and the square of a speed, that count

bool precise(const std::string& spec) { return spec.starts_with("event-driven") || spec.starts_with("adaptive"); }
bool event_driven(const std::string& spec) { return spec.starts_with("event-driven"); }

const Twin kTwins[] = {
    {.name = "mirrored", .m = -1},           {.name = "turned", .phi = 0.7},
    {.name = "moved", .d = {3.1, -1.7}},     {.name = "in other units", .lambda = 4, .kappa = 0.125, .tau = 2},
    {.name = "reordered", .reversed = true}, {.name = "turned by a right angle", .phi = std::numbers::pi / 2}};

const SpatialTwin kSpatialTwins[] = {{.name = "turned", .turn = {0.7, -0.4, 1.1}},
                                     {.name = "moved", .d = {3.1, -1.7, 0.9}},
                                     {.name = "in other units", .lambda = 4, .kappa = 0.125, .tau = 2},
                                     {.name = "reordered", .reversed = true},
                                     {.name = "turned by a right angle", .turn = {0, std::numbers::pi / 2, 0}}};

template <class Space> const TwinOf<Space>& twin_number(std::uint64_t number) {
  if constexpr (kPlanar<Space>)
    return kTwins[number % std::size(kTwins)];
  else
    return kSpatialTwins[number % std::size(kSpatialTwins)];
}

/// [m/s] of b's surface, at most.
double surface_speed(const Contact& contact) {
  return std::visit([](const auto& x) { return std::abs(ContactLaw(x.law).belt); }, contact);
}
double surface_speed(const spatial::Contact& contact) {
  const SurfaceLaw s = std::visit([](const auto& x) { return x.law.surface; }, contact);
  return s.velocity.norm() + 10 * s.omega.norm();
}
double torque_of(const Load& l) { return std::abs(l.torque); }
double torque_of(const spatial::Load& l) { return l.moment.norm(); }
/// [N m] about the body's centre, at most.
double moment_of(const Load& l) { return torque_of(l) + l.point.norm() * l.force.norm(); }
double moment_of(const spatial::Load& l) { return torque_of(l) + l.point.norm() * l.force.norm(); }
double least_inertia_of(const Scene& scene, const Measure& /*measure*/, BodyId b) {
  return scene.bodies[static_cast<std::size_t>(b)].inertia;
}
double least_inertia_of(const spatial::Scene& /*scene*/, const SpatialMeasure& measure, BodyId b) {
  return measure.least_inertia(b);
}
double spin_of(const Body& b) { return std::abs(b.omega); }
double spin_of(const spatial::Body& b) { return b.omega.norm(); }

std::vector<ContactLaw> laws_of(const Scene& scene) {
  std::vector<ContactLaw> all;
  for (const Contact& c : scene.contacts) all.push_back(std::visit([](const auto& x) { return ContactLaw(x.law); }, c));
  return all;
}
std::vector<ContactLaw> laws_of(const spatial::Scene& scene) {
  std::vector<ContactLaw> all;
  for (const spatial::Contact& c : scene.contacts) all.push_back(std::visit([](const auto& x) { return x.law; }, c));
  for (const spatial::Collision& c : scene.collisions) all.push_back(c.law);
  return all;
}

template <class Space> class Court {
  using Scene = SceneOf<Space>;

 public:
  Court(const Scene& scene, std::uint64_t number, const Limits& limits)
      : scene_(scene), twin_(twin_number<Space>(number)), limits_(limits) {
    for (const auto& j : scene.joints) driven_ = driven_ || driven(j);
    for (const auto& b : scene.bodies) mass_ += b.mass;
  }

  Verdict judge(const std::string& spec) {
    Verdict v{spec};
    try {
      v.result = result(spec, v.why);
    } catch (const std::exception& error) {
      v.result = Result::crashed, v.why = error.what();
    }
    return v;
  }

 private:
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
    return run(spec, "nudged by " + text_of(by), own_step(spec), {.nudge = by});
  }

  /// The first fault of the figures, in words; of schemes of fixed step those that a quarter of the step does not mend.
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

  static double size_of(Result what, const Seen& s) {
    if (what == Result::joints) return s.figures.joint.value;
    if (what == Result::penetration) return s.figures.depth.value;
    return s.figures.gain.value / s.figures.energy;
  }

  Result figures_fault(const std::string& spec, const Seen& s, std::string& why) {
    const Figures& f = s.figures;
    const double h = precise(spec) ? 0 : own_step(spec);
    if (!f.finite) return why = "numbers that are none", Result::nan;
    if (f.joint.value > 1e-6 * f.size + h * f.speed) return why = f.joint.where, Result::joints;
    const Admissibility& reported = s.trace.run.motion;
    const bool warned = h > 0 && reported.deep() && f.depth.value <= 1.1 * reported.max_overlap;
    if (f.depth_share.value > 1 && !warned) return why = f.depth.where, Result::penetration;
    if (f.passed.value > 0.2 && s.trace.run.passages == 0) return why = f.passed.where, Result::passage;
    const bool exact = event_driven(spec) && s.trace.run.crossings == 0;
    const double share = exact ? 1e-6 : precise(spec) ? 1e-3 : 0.05;
    if (!driven_ && f.overlap < 1e-9 && f.gain.value > share * f.energy + kLeast * mass_)
      return why = f.gain.where + " of " + text_of(f.energy), Result::energy;
    if (f.speed > 100 * expected_speed() && !others_as_fast(spec))
      return why = "points at " + text_of(f.speed) + " m/s, expected are some " + text_of(expected_speed()),
             Result::energy;
    return Result::solved;
  }

  /// Whether two other schemes make points as fast, those of fixed step with a 32nd of the step, or the other precise
  /// one comes to the same motion: a disc between faces that a drive closes to
  /// a wedge is pressed out the faster the sharper that is.
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
    stored += std::abs(measure.potential(SystemOf<Space>(scene_).initial_state().q)) * (scene_.springs.empty() ? 0 : 1);
    return spun + (speed + std::sqrt(2 * stored / light)) * std::sqrt(heavy / light);
  }

  /// A reference that knows this motion: it ends solved, is admissible, and hardly changes when it is nudged.
  const std::string* reference() {
    if (looked_) return reference_ ? &*reference_ : nullptr;
    looked_ = true;
    for (const char* spec : {"event-driven", "adaptive:rtol=1e-9"}) {
      std::string why;
      const Seen& s = base(spec);
      if (!s.trace.solved() || s.trace.run.crossings > 0 || figures_fault(spec, s, why) != Result::solved) continue;
      const Seen& n = nudged(spec, kNudge);
      if (!n.trace.solved()) continue;
      moved_ = difference<Space>(s.trace.rows, n.trace.rows, s.figures.size);
      if (moved_ > kWell) return nullptr;
      reference_ = spec;
      return &*reference_;
    }
    return nullptr;
  }

  Result result(const std::string& spec, std::string& why) {
    const Seen& s = base(spec);
    if (!s.trace.refused.empty()) return Result::refused;
    if (!s.trace.threw.empty()) return why = s.trace.threw, Result::crashed;
    if (s.trace.late || s.trace.seconds > limits_.time + limits_.grace)
      return why = (s.trace.late ? "has to be killed" : text_of(s.trace.seconds) + " s") + ", the limit was " +
                   text_of(limits_.time) + " s",
             Result::late;
    if (!s.trace.solved()) {
      if (!s.figures.finite) return why = "rows that are no numbers", Result::nan;
      return ended_early(spec, why);
    }
    if (const Result r = admissible(spec, why); r != Result::solved) return r;
    if (reference() == nullptr) return Result::solved;
    if (precise(spec)) {
      const Seen& coarse = run(spec, "coarse", scene_.duration / kCoarse);
      if (differs(spec, s, coarse, "with the output step " + text_of(scene_.duration / kCoarse), why) &&
          (kPlanar<Space> || !several_motions(spec)))
        return Result::output_step;
      why.clear();
    }
    const Seen& twin = run(spec, "twin", own_step(spec), twin_);
    const bool apart = differs(spec, s, twin, std::string(twin_.name), why);
    if (apart && (precise(spec) || differs_still(spec, s, twin)) && !several_motions(spec)) return Result::twin;
    why.clear();
    const Result last = astray(spec, why);
    return last == Result::solved || several_motions(spec) ? Result::solved : last;
  }

  /// [sizes, rad] What two runs of a scheme on a well-conditioned motion may differ by. Where rounding decides in the
  /// scheme, one nudge shows only one of the motions that are possible; `more` of them do not miss the others.
  double slack(const std::string& spec, bool more = false) {
    const Seen& s = base(spec);
    double most = 0;
    const auto nudge = [&](double by) {
      most = std::max(most, difference<Space>(s.trace.rows, nudged(spec, by).trace.rows, s.figures.size));
    };
    if (precise(spec) && more) std::ranges::for_each(kFineNudges, nudge);
    if (spec == "event-driven" && more)  // ends of series of impacts, too, are as good as the tolerance
      if (const Seen& tight = base("event-driven:rtol=1e-11,atol=1e-12,accumulation=1e-12"); tight.trace.solved())
        most = std::max(most, difference<Space>(s.trace.rows, tight.trace.rows, s.figures.size));
    if (event_driven(spec)) return 1e-6 + 10 * std::max(moved_, most);
    if (precise(spec)) return 1e-3 + 1e-6 * 100 * moved_ / kNudge + 10 * most;
    nudge(kOwnNudge), nudge(-kOwnNudge);  // a gap that is zero to rounding is closed on one side only
    if (more) std::ranges::for_each(kMoreNudges, nudge);
    // Where several contacts of different μ share a load, the model has many motions, and rounding of coordinates
    // decides which: a nudge shows it only where it happens to change the contacts that carry.
    const double way = own_step(spec) * s.figures.speed / s.figures.size;  // a step's; errors are of its first order
    return 1e-6 + way * way + 10 * most + friction_left_open(scene_, s.trace, s.figures.size);
  }

  bool differs(const std::string& spec, const Seen& s, const Seen& other, const std::string& how, std::string& why) {
    const double apart = difference<Space>(s.trace.rows, other.trace.rows, s.figures.size);
    if (other.trace.late || other.trace.run.status == Status::time_limit) return false;  // depends on the machine
    const bool denied = other.trace.run.status == Status::infeasible || !other.trace.threw.empty();
    const bool same_end = other.trace.solved() || !denied;  // a stop that gives a reason contradicts nothing before it
    if (same_end && apart <= 1e-6) return false;
    const double most = slack(spec);
    if (same_end && apart <= most) return false;
    const double open = precise(spec) ? friction_left_open(scene_, s.trace, s.figures.size) : 0;
    if (same_end && (apart <= most + open || apart <= slack(spec, true) + open)) return false;
    why = how + (same_end ? " it is off by " + text_of(apart) + ", " + text_of(most) + " allowed"
                          : " it ends as " + std::string(name(other.trace.run.status)) + " at t = " +
                                text_of(other.trace.end()) + ": " + other.trace.threw + other.trace.run.why);
    return true;
  }

  /// Whether friction can jam (Painlevé) in some state of the motion: then the model has several there, of which one
  /// strikes without an approach, and rounding decides.
  bool several_motions(const std::string& spec) {
    return std::ranges::any_of(base(spec).trace.rows,
                               [&](const State& x) { return painleve_possible(scene_, x, kClosed, false); });
  }

  /// Whether the twin of a scheme of fixed step differs with a quarter of the step, too, by more than half as much.
  /// Else a single step decided by rounding between open and closed, or stick and slip, and errs by as much in both.
  bool differs_still(const std::string& spec, const Seen& s, const Seen& twin) {
    const Seen &q = quarter(spec), &other = run(spec, "twin h/4", own_step(spec) / 4, twin_);
    if (twin.trace.run.status == Status::infeasible) return other.trace.run.status == Status::infeasible;
    return difference<Space>(q.trace.rows, other.trace.rows, q.figures.size) >
           difference<Space>(s.trace.rows, twin.trace.rows, s.figures.size) / 2;
  }

  Result astray(const std::string& spec, std::string& why) {
    const std::string& known = *reference();
    if (known == spec) return Result::solved;
    if (known.starts_with(spec + ":")) return outvoted(spec, why);
    const Seen &s = base(spec), &r = base(known);
    if (s.figures.overlap > 1e-9) return Result::solved;  // the reference moves bodies apart first
    if (other_friction(spec)) return Result::solved;
    const double off = difference<Space>(s.trace.rows, r.trace.rows, r.figures.size);
    double most = precise(spec) ? slack("adaptive") : 0.05;
    if (off > most) most += friction_left_open(scene_, s.trace, s.figures.size);
    if (off <= most) return Result::solved;
    if (other_impacts(spec)) return Result::solved;
    if (s.trace.run.motion.energy_off()) return Result::solved;  // and is warned of
    if (precise(spec) && !others_nearer(r, off)) return Result::solved;
    if (spec == "adaptive" && finer_agrees(r, most)) return Result::solved;
    if (event_driven(spec) && !others_agree(spec, r)) return Result::solved;  // then adaptive is astray, or none is
    if (!precise(spec)) {
      if (merges_impacts(r.trace.events, own_step(spec) / kFinest)) return Result::solved;
      const Seen& q = quarter(spec);
      if (!q.trace.solved() || !others_agree(spec, r)) return Result::solved;
      const double still = difference<Space>(q.trace.rows, r.trace.rows, r.figures.size);
      if (still <= most || still < 0.6 * off) return Result::solved;
      const Seen& fine = run(spec, "h/32", own_step(spec) / 32);
      if (!fine.trace.solved() || difference<Space>(fine.trace.rows, r.trace.rows, r.figures.size) < 0.6 * still)
        return Result::solved;
      const Seen& finest = run(spec, "h/256", own_step(spec) / kFinest);  // order 1, but with a large constant
      if (!finest.trace.solved()) return Result::solved;
      const double rest = difference<Space>(finest.trace.rows, r.trace.rows, r.figures.size);
      if (rest <= most || rest < 0.5 * difference<Space>(fine.trace.rows, r.trace.rows, r.figures.size))
        return Result::solved;
    }
    why = "off by " + text_of(off) + " from " + known;
    return Result::astray;
  }

  /// Where adaptive is its own reference: astray when event-driven and a scheme of fixed step come to another motion.
  Result outvoted(const std::string& spec, std::string& why) {
    const Seen &s = base(spec), &e = base("event-driven");
    if (!e.trace.solved() || s.figures.overlap > 1e-9) return Result::solved;
    const double off = difference<Space>(s.trace.rows, e.trace.rows, e.figures.size);
    for (const char* other : {"moreau-jean", "rattle"}) {
      const Seen& q = quarter(other);
      if (off < 0.05 || !q.trace.solved() || difference<Space>(q.trace.rows, e.trace.rows, e.figures.size) > 0.01)
        continue;
      why = "off by " + text_of(off) + " from event-driven and " + other;
      return Result::astray;
    }
    return Result::solved;
  }

  /// Whether two others of fixed step come to the reference's motion: where several contacts strike or are struck at
  /// once, a gap of rounding decides in which order they do, and all of them may differ from it.
  bool others_agree(const std::string& spec, const Seen& known) {
    int agree = 0;
    for (const char* other : {"moreau-jean", "stewart-trinkle", "rattle"}) {
      if (other == spec) continue;
      const Seen& q = quarter(other);
      agree += q.trace.solved() && difference<Space>(q.trace.rows, known.trace.rows, known.figures.size) < 0.05;
    }
    return agree >= 2;
  }

  /// Whether two schemes of fixed step are nearer to this motion than half of `off` with a 32nd of the step. Where none
  /// is, impacts within rounding of each other decide the order, and two references may differ.
  bool others_nearer(const Seen& known, double off) {
    int near = 0;
    for (const char* other : {"moreau-jean", "stewart-trinkle", "rattle"}) {
      const Seen& fine = run(other, "h/32", own_step(other) / 32);
      near += fine.trace.solved() && difference<Space>(fine.trace.rows, known.trace.rows, known.figures.size) < off / 2;
    }
    return near >= 2;
  }

  /// Whether the scheme has another law of friction than the reference, whatever its step: anitescu-potra's contacts
  /// open as they slide; paoli-schatzman's friction acts in both steps of an impact that rebounds.
  bool other_friction(const std::string& spec) const {
    const bool relaxed = spec.starts_with("anitescu-potra"), twice = spec.starts_with("paoli-schatzman");
    const std::vector<ContactLaw> laws = laws_of(scene_);
    return std::ranges::any_of(
        laws, [&](const ContactLaw& law) { return law.frictional() && (relaxed || (twice && law.e > 0)); });
  }

  /// Whether the scheme comes to the reference with a tighter tolerance: events that the default one cannot tell apart
  /// are its error, which experiments/tolerance.py counts.
  bool finer_agrees(const Seen& known, double most) {
    const Seen& fine = base("adaptive:rtol=1e-9");
    return fine.trace.solved() && difference<Space>(fine.trace.rows, known.trace.rows, known.figures.size) <= most;
  }

  /// Whether two contacts strike one after the other within a step: there they strike at once, by another law. Only
  /// what exchanges a thousandth of the largest impulse, or more, counts.
  static bool merges_impacts(const std::vector<Event>& events, double step) {
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

  /// Whether the scheme has another law of multiple impacts than the reference: at the start of a scene a contact that
  /// opens may touch while others strike. What drives it shut is an impact of its own there, with restitution, and with
  /// gaps held at the end of the step (stewart_trinkle.h) it stays shut.
  bool other_impacts(const std::string& spec) const {
    if (!spec.starts_with("stewart-trinkle") && !spec.starts_with("anitescu-potra")) return false;
    const SystemOf<Space> system(scene_);
    const State x = system.initial_state();
    const auto terms = closed_terms(system, x, kClosed);
    bool opens = false, strikes = false;
    for (const auto& c : terms.closed) {
      const double rate = dense(c.rows.normal, system.dof()).dot(x.v);
      opens = opens || (rate > kStrikes && system.law(c.contact).e > 0);
      strikes = strikes || rate < -kStrikes;
    }
    return opens && strikes;
  }

  Result ended_early(const std::string& spec, std::string& why) {
    const Run& run = base(spec).trace.run;
    const bool painleve = run.why.find("Painlev") != std::string::npos;
    if (run.status != Status::infeasible && !painleve) return Result::stopped;
    const double t = base(spec).trace.end(), past = t + std::max(0.1 * (scene_.duration - t), 20 * scene_.step);
    if (past >= scene_.duration) return Result::stopped;
    const State& last = base(spec).trace.rows.back();
    if (painleve && (painleve_possible(scene_, last, kClosed) || painleve_begins(scene_, last, kClosed)))
      return Result::stopped;
    if (run.why.starts_with("Newton's law of impact") && impact_impossible(scene_, last, kClosed))
      return Result::stopped;
    for (const std::string& other : all_integrators<Space>()) {
      if (other == spec) continue;
      const Seen& s = base(other);
      if (!s.trace.ran() || s.trace.end() < past) continue;
      Seen part{s.trace, examine(scene_, s.trace, allowance(other, own_step(other)), past)};
      std::string bad;
      if (figures_fault(other, part, bad) != Result::solved || s.trace.run.passages > 0) continue;
      why = "ends at t = " + text_of(t) + ": " + run.why + "; " + other + " goes on";
      return Result::infeasible;
    }
    return Result::stopped;
  }

  const Scene& scene_;
  const TwinOf<Space>& twin_;
  const Limits& limits_;
  bool driven_ = false, looked_ = false;
  std::optional<std::string> reference_;
  double moved_ = 0;  // by the nudge
  double mass_ = 0;   // [kg] of all
  std::map<Key, Seen> seen_;
};

template <class Space> std::vector<Verdict> verdicts(const SceneOf<Space>& scene,
                                                     const std::vector<std::string>& integrators, std::uint64_t number,
                                                     const Limits& limits) {
  Court<Space> court(scene, number, limits);
  std::vector<Verdict> all;
  for (const std::string& spec : integrators) all.push_back(court.judge(spec));
  return all;
}

}  // namespace

std::vector<Verdict> judge(const Scene& scene, const std::vector<std::string>& integrators, std::uint64_t number,
                           const Limits& limits) {
  return verdicts<Planar>(scene, integrators, number, limits);
}
std::vector<Verdict> judge(const spatial::Scene& scene, const std::vector<std::string>& integrators,
                           std::uint64_t number, const Limits& limits) {
  return verdicts<Spatial>(scene, integrators, number, limits);
}

template <class Space> std::vector<std::string> all_integrators() {
  std::vector<std::string> all;
  for (const IntegratorEntry& entry : integrators())
    if (kPlanar<Space> || entry.make_spatial != nullptr) all.emplace_back(entry.name);
  return all;
}
template std::vector<std::string> all_integrators<Planar>();
template std::vector<std::string> all_integrators<Spatial>();

}  // namespace orthant::motion_storm
