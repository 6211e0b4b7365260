#include "experiments/runs/warnings.h"

#include <orthant/core/mechanics/dynamics/assemble.h>
#include <orthant/core/mechanics/dynamics/broad_phase.h>
#include <orthant/core/mechanics/dynamics/redundancy.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace orthant {
namespace {

template <class... Words> std::string words_of(const Words&... words) {
  std::ostringstream text;
  (text << ... << words);
  return text.str();
}

bool along_an_angle(const Contact& contact) {
  const auto* limit = std::get_if<Limit>(&contact);
  return limit != nullptr && std::holds_alternative<Angle>(limit->of.kind());
}

template <class Scene> void add_energy(const Scene& scene, const Run& run, std::vector<std::string>& to) {
  if (run.energy_rises == 0) return;
  to.push_back(words_of("impacts raised the energy ", run.energy_rises, run.energy_rises == 1 ? " time" : " times",
                        ", at most by ", run.max_energy_rise, " J at t = ", run.max_energy_rise_time, " s: ",
                        scene.restitution == Restitution::newton
                            ? "Newton's law with friction or several e can; restitution = \"poisson\" is safer there"
                            : "friction with tangential restitution or several e can",
                        "; so can steps in which bodies move as far as they are wide"));
}

template <class Scene> void add_passages(const Scene& scene, const Run& run, std::vector<std::string>& to) {
  if (run.passages == 0) return;
  const auto name = [&](BodyId body) {
    return body < 0 ? "the ground" : "\"" + scene.bodies[static_cast<std::size_t>(body)].name + "\"";
  };
  const Passage& first = run.first_passage;
  to.push_back(words_of("bodies passed through each other, unseen, in ", run.passages,
                        run.passages == 1 ? " step" : " steps", ": first ", name(first.body), " and ",
                        name(first.other), " at t = ", run.first_passage_time, " s, where the one moved ", first.moved,
                        " m in a step and the thinner is ", first.width, " m wide: a smaller step sees them"));
}

void add_rounded(const Run& run, std::vector<std::string>& to) {
  if (run.rounded_steps == 0) return;
  to.push_back(words_of("the problems of ", run.rounded_steps, run.rounded_steps == 1 ? " step are" : " steps are",
                        " rounded only: right for data that differ in their last digits, and no double is known to be "
                        "better; first at t = ",
                        run.first_rounded_time, " s: ", run.first_rounded,
                        ". Smaller mass ratios help; rounded=stop ends the run instead"));
}

void add_plastic(const Run& run, std::vector<std::string>& to) {
  if (run.plastic_steps == 0) return;
  to.push_back(words_of("friction kept bodies from rebounding in ", run.plastic_steps,
                        run.plastic_steps == 1 ? " step" : " steps", ", first at t = ", run.first_plastic_time,
                        " s: Newton's law of impact with friction has no solution there (jamming), these impacts have "
                        "e_n = e_t = 0"));
}

void add_undetermined(const Run& run, std::vector<std::string>& to) {
  if (run.undetermined_steps == 0) return;
  to.push_back(
      words_of("contacts of a body share its load in a way that rigid bodies leave open, and friction depends on the "
               "share, in ",
               run.undetermined_steps, run.undetermined_steps == 1 ? " step" : " steps", ", first at t = ",
               run.first_undetermined_time, " s: the most even shares are taken; the model has other motions, too"));
}

template <class Scene> void add_rotation(const Scene& scene, const Run& run, std::vector<std::string>& to) {
  if (!(run.rotation_error > kMisturned)) return;
  to.push_back(words_of("\"", scene.bodies[static_cast<std::size_t>(run.rotation_body)].name,
                        "\" turns freely with an error of about ", run.rotation_error,
                        " rad: the steps do not resolve how its axes turn; take a smaller step, moreau-jean, "
                        "generalized-alpha or adaptive"));
}

}  // namespace

namespace {

constexpr double kSmall = 1e-6;  // [m, rad], [m/s, rad/s]: what a scene file's digits may leave

bool limits_an_angle(const Contact& contact) { return along_an_angle(contact); }
bool limits_an_angle(const spatial::Contact& contact) {
  const auto* limit = std::get_if<spatial::Limit>(&contact);
  return limit != nullptr && limit->of.angle();
}

template <class Space> std::vector<Remark> wrong_at_start(const SystemOf<Space>& system) {
  std::vector<Remark> remarks;
  const State x = system.initial_state();
  TermsOf<Space> terms(system);
  set_poses(system, x.t, x.q, terms.at);
  evaluate_joint_residual(system, terms);
  evaluate_joint_rows(system, terms);
  BroadPhaseOf<Space>(system).find(Eigen::VectorXd::Zero(system.dof()), terms);
  evaluate_gaps(system, terms);
  double rate = 0;
  for (Index i = 0; i < terms.phi.size(); ++i) rate = std::max(rate, std::abs(terms.missing_rate(i, x.v)));
  const auto warn = [&](const char* what, double size, const char* unit, const char* then) {
    remarks.push_back({true, words_of("at the start ", what, " by ", size, " ", unit, ": ", then)});
  };
  if (const OffMost most = off_most(system, x.t, x.q); most.off > kSmall)
    warn("joints are off", most.off, ("m or rad, \"" + most.joint + "\" most").c_str(),
         "the bodies are moved onto them, except with joints=none (assemble = true in the scene: by the least motion)");
  if (rate > kSmall * (1 + x.v.template lpNorm<Eigen::Infinity>()))
    warn("velocities break joints", rate, "m/s or rad/s", "they are changed to keep them");
  Index deepest = 0;
  if (const double deep = terms.gap.size() > 0 ? -terms.gap.minCoeff(&deepest) : 0; deep > kSmall) {
    const bool listed = deepest < system.listed();
    const bool turns = listed && limits_an_angle(system.scene().contacts[static_cast<std::size_t>(deepest)]);
    warn("contacts penetrate", deep, turns ? "rad" : "m",
         "moreau-jean leaves it, paoli-schatzman throws them apart, the others differ");
  }
  return remarks;
}

}  // namespace

std::vector<Remark> remarks_on_start(const System& system) {
  std::vector<Remark> remarks = wrong_at_start(system);
  constexpr int kMostRows = 600;  // more would take longer than a word is worth
  if (system.joint_rows() > kMostRows) return remarks;
  if (const std::string words = describe(find_redundancy(system, system.initial_state().q), system); !words.empty())
    remarks.push_back({false, "at the start " + words});
  return remarks;
}

std::vector<Remark> remarks_on_start(const SystemOf<Spatial>& system) {
  std::vector<Remark> remarks = wrong_at_start(system);
  for (const std::string& note : system.scene().notes) remarks.push_back({false, note});
  return remarks;
}

namespace {

constexpr std::size_t entry_of(BodyId b) { return static_cast<std::size_t>(b); }

template <class Space> void add_mass_ratios(const SystemOf<Space>& system, std::vector<std::string>& to) {
  const auto& bodies = system.scene().bodies;
  std::vector<std::size_t> light(bodies.size()), heavy(bodies.size());  // of each cluster, by its first body
  for (std::size_t b = 0; b < bodies.size(); ++b) light[b] = heavy[b] = b;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::size_t first = entry_of(system.cluster()[b]);
    if (bodies[b].mass < bodies[light[first]].mass) light[first] = b;
    if (bodies[b].mass > bodies[heavy[first]].mass) heavy[first] = b;
  }
  for (std::size_t b = 0; b < bodies.size(); ++b)
    if (const double ratio = bodies[heavy[b]].mass / bodies[light[b]].mass; ratio > kMassRatio)
      to.push_back(words_of("\"", bodies[heavy[b]].name, "\" has ", ratio, " times the mass of \"",
                            bodies[light[b]].name, "\": beyond ", kMassRatio,
                            " contacts between such bodies may not be solved"));
}

void add_crossings(const Run& run, std::vector<std::string>& to) {
  if (run.crossings == 0) return;
  to.push_back(words_of("crowds of events, or instants without a single answer, were crossed in ", run.crossings,
                        run.crossings == 1 ? " step" : " steps",
                        " of first order, whatever the tolerance: the motion may depend on that; they leave ",
                        run.error_estimate, " m or rad, which it may magnify"));
}

template <class Space> void add_rounding(const SystemOf<Space>& system, const Run& run, std::vector<std::string>& to) {
  double far = 0, turned = 0;
  for (const State& x : {system.initial_state(), run.final})
    for (Index b = 0; b < std::ssize(system.scene().bodies); ++b) {
      far = std::max(far, orthant::place_of<Space>(x.q, b).template lpNorm<Eigen::Infinity>());
      if constexpr (kPlanar<Space>) turned = std::max(turned, std::abs(x.q[3 * b + 2]));
    }
  if (far > kFar)
    to.push_back(words_of("bodies are ", far, " m from the origin: places are rounded to ", far * 0x1p-52,
                          " m, rates to that over the step"));
  if (turned > kFar)
    to.push_back(words_of("bodies are turned by ", turned, " rad: angles are rounded to ", turned * 0x1p-52,
                          " rad, rates to that over the step"));
}

/// Σ 1/m or 1/J of the bodies that a spring or damper acts on. 0 of one between joints; of drag only its first axis
/// counts.
template <class Body, class Spring> double inverse_mass_of(const std::vector<Body>& bodies, const Spring& spring) {
  double sum = 0;
  if constexpr (requires { spring.component; })
    if (spring.component != 0) return 0;
  if constexpr (requires { spring.a; })
    for (const BodyId b : {spring.a, spring.b}) {
      if (b < 0) continue;
      const Body& body = bodies[entry_of(b)];
      if constexpr (requires { spring.turning; })
        sum += 1 / (spring.turning ? body.inertia.trace() / 3 : body.mass);
      else if constexpr (requires { spring.point_a; })
        sum += 1 / body.mass;
      else
        sum += 1 / body.inertia;
    }
  return sum;
}

template <class Space>
void add_coarse_steps(const SystemOf<Space>& system, const Run& run, double step, std::vector<std::string>& to) {
  const auto& bodies = system.scene().bodies;
  for (const auto& any : system.scene().springs)
    std::visit(
        [&](const auto& spring) {
          const double inverse = inverse_mass_of(bodies, spring);
          if (const double angle = step * std::sqrt(spring.stiffness * inverse); angle > kSwing)
            to.push_back(words_of("spring \"", spring.name, "\" swings by ", angle,
                                  " rad in a step: its motion is not resolved, and near contacts energy may rise"));
          if (const double share = step * spring.damping * inverse; share > kDamped)
            to.push_back(words_of("spring \"", spring.name, "\" has a damping of ", share,
                                  " times mass over step: velocities may swing from step to step, and bodies drift"));
        },
        any);
  double turn = 0;
  std::size_t fastest = 0;
  for (const State& x : {system.initial_state(), run.final})
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      constexpr Index n = Space::kVelocities, places = kPlanar<Space> ? 2 : 3;
      const double by = step * x.v.segment(n * static_cast<Index>(b) + places, n - places).norm();
      if (by > turn) turn = by, fastest = b;
    }
  if (turn > kTurn)
    to.push_back(words_of("\"", bodies[fastest].name, "\" turns by ", turn, " rad in a step: a smaller step is right"));
}

}  // namespace

template <class Space> std::vector<std::string> limits_entered(const SystemOf<Space>& system, const Run& run,
                                                               std::string_view integrator, double step) {
  std::vector<std::string> limits;
  add_mass_ratios(system, limits);
  add_crossings(run, limits);
  add_rounding(system, run, limits);
  if (!integrator.starts_with("adaptive") && !integrator.starts_with("event-driven"))
    add_coarse_steps(system, run, step, limits);
  return limits;
}

template <class Space> std::vector<std::string> warnings_of(const SystemOf<Space>& system, const Run& run,
                                                            std::string_view integrator, double step) {
  std::vector<std::string> all;
  add_energy(system.scene(), run, all);
  add_passages(system.scene(), run, all);
  add_rounded(run, all), add_plastic(run, all), add_undetermined(run, all);
  add_rotation(system.scene(), run, all);
  for (std::string& limit : warnings_of(run.motion)) all.push_back(std::move(limit));
  for (std::string& limit : limits_entered(system, run, integrator, step)) all.push_back(std::move(limit));
  return all;
}

#define ORTHANT_WARNINGS(Space)                                                                                   \
  template std::vector<std::string> limits_entered(const SystemOf<Space>&, const Run&, std::string_view, double); \
  template std::vector<std::string> warnings_of(const SystemOf<Space>&, const Run&, std::string_view, double);
ORTHANT_WARNINGS(Planar)
ORTHANT_WARNINGS(Spatial)
#undef ORTHANT_WARNINGS

}  // namespace orthant
