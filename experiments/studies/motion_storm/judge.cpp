#include "experiments/studies/motion_storm/judge.h"

#include "experiments/studies/motion_storm/closed_rows.h"
#include "experiments/studies/motion_storm/painleve.h"
#include "experiments/studies/motion_storm/scene_runs.h"
#include "experiments/studies/motion_storm/scenes.h"
#include "experiments/studies/motion_storm/shared_load.h"

#include <orthant/core/support/options.h>
#include <orthant/integrators/registry.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace orthant::motion_storm {
namespace {

using detail::text_of;

constexpr int kFinest = 256;        // parts of a step
constexpr double kNudge = 1e-9;     // for conditioning of references
constexpr double kWell = 1e-5;      // difference that such a nudge makes at the most in a well-conditioned motion
constexpr double kOwnNudge = 1e-7;  // of schemes of fixed step: more than rounding, less than h
constexpr double kMoreNudges[] = {3e-8, -1e-8, 1e-9};                // where a fault depends on what that one shows
constexpr double kFineNudges[] = {-1e-9, 5e-10, 2e-9, -2e-9, 1e-8};  // likewise, of precise ones
constexpr double kClosed = 1e-6;   // [m] contacts with no larger gap, where a run says that it cannot go on
constexpr double kStrikes = 1e-9;  // [m/s]
constexpr double kFarAway = 100;   // [m] rounding there is that of a nudge

const Twin kTwins[] = {{.name = "mirrored", .m = -1},
                       {.name = "turned", .phi = 0.7},
                       {.name = "moved", .d = {3.1, -1.7}},
                       {.name = "in other units", .lambda = 4, .kappa = 0.125, .tau = 2},
                       {.name = "reordered", .reversed = true},
                       {.name = "turned by a right angle", .phi = std::numbers::pi / 2},
                       {.name = "moved far", .d = {4321.9, -1234.5}}};

const SpatialTwin kSpatialTwins[] = {{.name = "turned", .turn = {0.7, -0.4, 1.1}},
                                     {.name = "moved", .d = {3.1, -1.7, 0.9}},
                                     {.name = "in other units", .lambda = 4, .kappa = 0.125, .tau = 2},
                                     {.name = "reordered", .reversed = true},
                                     {.name = "turned by a right angle", .turn = {0, std::numbers::pi / 2, 0}}};

template <class Space> const TwinOf<Space>& twin_number(std::uint64_t number) {
  if constexpr (kPlanar<Space>)
    return of_further_kinds(number) ? kTwins[(number / 12 + 1) % std::size(kTwins)]  // far away, too
                                    : kTwins[number % (std::size(kTwins) - 1)];
  else
    return kSpatialTwins[number % std::size(kSpatialTwins)];
}

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

template <class Space> class Court : private SceneRuns<Space> {
  using Runs = SceneRuns<Space>;
  using Seen = typename Runs::Seen;
  using Runs::admissible;
  using Runs::allowance;
  using Runs::base;
  using Runs::expected_speed;
  using Runs::figures_fault;
  using Runs::nudged;
  using Runs::own_step;
  using Runs::quarter;
  using Runs::run;
  using Scene = SceneOf<Space>;
  static constexpr const char* kOtherTolerances = "event-driven:rtol=1e-11,atol=1e-12,accumulation=1e-12";

 public:
  Court(const Scene& scene, std::uint64_t number, const Limits& limits)
      : Runs(scene, limits), scene_(scene), twin_(twin_number<Space>(number)), limits_(limits) {}

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
  /// A reference that knows this motion: it ends solved, is admissible, and hardly changes when it is nudged.
  const std::string* reference() {
    if (looked_) return reference_ ? &*reference_ : nullptr;
    looked_ = true;
    for (const char* spec : {"event-driven", "adaptive:rtol=1e-9"}) {
      std::string why;
      const Seen& s = base(spec);
      if (!s.trace.solved() || s.trace.run.crossings > 0 || figures_fault(spec, s, why) != Result::solved) continue;
      if (s.figures.speed > 100 * expected_speed()) continue;  // crushed: it magnifies more than nudges show
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
    const bool apart = differs(spec, s, twin, std::string(twin_.name), why) && !rounding_decides(spec, s, twin);
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
      if (const Seen& tight = base(kOtherTolerances); tight.trace.solved())
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

  /// Whether the twin's motion is ill-conditioned though the scene's own was not seen to be. The reference with other
  /// tolerances, among them the height of the bounces that end a series, comes to another one; or rounding of places
  /// decides, and the twin, moved on a little, differs from itself. That is no fault at the end of a series of impacts,
  /// which leaves gaps of rounding, nor where it is less than the error of a scheme of fixed step, nor far away.
  bool rounding_decides(const std::string& spec, const Seen& s, const Seen& twin) {
    const auto differ = [&](const Seen& a, const Seen& b) {
      return difference<Space>(a.trace.rows, b.trace.rows, s.figures.size);
    };
    const double apart = differ(twin, s);
    if (spec == "event-driven") {
      const Seen& other = run(kOtherTolerances, "twin", own_step(spec), twin_);
      if (other.trace.solved() && 10 * differ(twin, other) > apart) return true;
    }
    if (!twin.trace.solved()) return false;
    const bool far = twin_.d.norm() > kFarAway;
    if (!precise(spec) && !(apart <= differ(s, quarter(spec)))) return false;
    if (!precise(spec) && far) return true;
    TwinOf<Space> moved = twin_;
    moved.d.x() += 0.7, moved.d.y() -= 0.3;
    const Seen& other = run(spec, "twin moved on", own_step(spec), moved);
    if (!other.trace.solved() || !(10 * differ(twin, other) > apart)) return false;
    const auto ends_series = [](const Event& e) { return e.kind == EventKind::accumulation; };
    return !precise(spec) || far || std::ranges::any_of(s.trace.events, ends_series);
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
    if (s.trace.run.motion.energy_off()) return Result::solved;       // and is warned of
    if (s.trace.run.rotation_error > off / 4) return Result::solved;  // the run's own estimate says so
    if (precise(spec) && !others_nearer(r, off)) return Result::solved;
    if (spec == "adaptive" && finer_agrees(r, most)) return Result::solved;
    if (event_driven(spec) && !others_agree(spec, r)) return Result::solved;  // then adaptive is astray, or none is
    if (!precise(spec)) {
      if (strikes_in_turn(r.trace.events, own_step(spec) / kFinest)) return Result::solved;
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

  /// Whether the scheme has another law of multiple impacts than the reference: at the start of a scene a contact that
  /// opens may touch while others strike. What drives it shut is an impact of its own there, with restitution, and with
  /// gaps held at the end of the step (stewart_trinkle.h) it stays shut.
  bool other_impacts(const std::string& spec) const {
    if (!spec.starts_with("stewart-trinkle") && !spec.starts_with("anitescu-potra")) return false;
    const State x = start_of(scene_);
    bool opens = false, strikes = false;
    for (const ClosedContactRows& c : closed_rows(scene_, x, kClosed).contacts) {
      const double rate = c.normal.dot(x.v);
      opens = opens || (rate > kStrikes && c.law.e > 0);
      strikes = strikes || rate < -kStrikes;
    }
    return opens && strikes;
  }

  /// Whether a run of this scheme, its step divided, is admissible until `past`.
  bool goes_on(const std::string& spec, const Seen& s, double divided, double past) {
    if (!s.trace.ran() || s.trace.end() < past || s.trace.run.passages > 0) return false;
    const Seen part{s.trace, examine(scene_, s.trace, allowance(spec, own_step(spec) / divided), past)};
    std::string bad;
    return figures_fault(spec, part, bad) == Result::solved;
  }

  Result ended_early(const std::string& spec, std::string& why) {
    const Run& ended = base(spec).trace.run;
    const bool painleve = ended.why.find("Painlev") != std::string::npos;
    if (ended.status != Status::infeasible && !painleve) return Result::stopped;
    const double t = base(spec).trace.end(), past = t + std::max(0.1 * (scene_.duration - t), 20 * scene_.step);
    if (past >= scene_.duration) return Result::stopped;
    const State& last = base(spec).trace.rows.back();
    if (painleve && (painleve_possible(scene_, last, kClosed) || painleve_begins(scene_, last, kClosed)))
      return Result::stopped;
    if (impact_impossible(scene_, last, kClosed)) return Result::stopped;
    for (const std::string& other : all_integrators<Space>()) {
      if (other == spec) continue;
      if (!goes_on(other, base(other), 1, past)) continue;
      // Steps that overlap go through jams, one after the other: the same at any step.
      if (!precise(other) && (!goes_on(other, quarter(other), 4, past) ||
                              !goes_on(other, run(other, "h/32", own_step(other) / 32), 32, past)))
        continue;
      why = "ends at t = " + text_of(t) + ": " + ended.why + "; " + other + " goes on";
      return Result::infeasible;
    }
    return Result::stopped;
  }

  const Scene& scene_;
  const TwinOf<Space>& twin_;
  const Limits& limits_;
  bool looked_ = false;
  std::optional<std::string> reference_;
  double moved_ = 0;  // by the nudge
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
