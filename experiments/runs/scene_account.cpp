#include "experiments/runs/scene_account.h"

#include "experiments/runs/event_table.h"
#include "experiments/runs/warnings.h"

#include <orthant/core/mechanics/dynamics/assemble.h>
#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/step/jam.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

namespace orthant {
namespace {

constexpr int kMostRanked = 600;  // joint rows: more would take seconds
constexpr int kMostContactsAdaptive = 30;
constexpr double kShareOfPeriod = 0.02;  // of the fastest motion's 1/ω: some 300 steps a period
constexpr int kFewestSteps = 100;

template <class Named> std::string name_in(const Named& element) {
  return std::visit([](const auto& x) { return x.name; }, element);
}

double least_moment(const Body& body) { return body.inertia; }
double least_moment(const spatial::Body& body) { return spatial::principal(body.inertia).moments.minCoeff(); }

template <class Scene> double stiffest_swing(const Scene& scene) {
  double fastest = 0;
  for (const auto& one : scene.springs) {
    const auto swing = [&](const auto& spring) {
      double inverse = 0;
      if constexpr (requires { spring.a; }) {
        for (const BodyId b : {spring.a, spring.b})
          if (b >= 0) {
            const auto& body = scene.bodies[static_cast<std::size_t>(b)];
            inverse += 1 / (requires { spring.point_a; } ? body.mass : least_moment(body));
          }
      } else {
        for (const auto& body : scene.bodies)  // whichever it moves: the lightest
          inverse = std::max(inverse, 1 / std::min(body.mass, least_moment(body)));
      }
      return std::sqrt(spring.stiffness * inverse);
    };
    fastest = std::max(fastest, std::visit(swing, one));
  }
  return fastest;
}

/// ∫ |r|² dm about the centre of mass.
double second_moment(const Body& body) { return body.inertia; }
double second_moment(const spatial::Body& body) { return body.inertia.trace() / 2; }

double speed_of_turn(const Body& body) { return std::abs(body.omega); }
double speed_of_turn(const spatial::Body& body) { return body.omega.norm(); }

template <class Space> double suggested_step(const SystemOf<Space>& system) {
  const auto& scene = system.scene();
  double time = scene.duration / kFewestSteps / kShareOfPeriod;
  const auto at_most = [&](double seconds) {
    if (seconds > 0 && std::isfinite(seconds)) time = std::min(time, seconds);
  };
  at_most(1 / stiffest_swing(scene)), at_most(1 / system.swing());
  for (const auto& body : scene.bodies) {
    const double radius = std::sqrt(second_moment(body) / body.mass);
    at_most(std::sqrt(radius / scene.gravity.norm()));
    at_most(radius / body.velocity.norm()), at_most(1 / speed_of_turn(body));
  }
  const double step = kShareOfPeriod * time, ten = std::pow(10, std::floor(std::log10(step)));
  return step >= 5 * ten ? 5 * ten : step >= 2 * ten ? 2 * ten : ten;  // a round number below it
}

void choose_integrator(const System& system, SceneAccount& account) {
  try {
    make_integrator("adaptive", system);
  } catch (const std::invalid_argument& error) {
    account.integrator = "moreau-jean", account.why_integrator = error.what();
    return;
  }
  if (account.contacts + account.pairs > kMostContactsAdaptive) {
    account.integrator = "moreau-jean";
    account.why_integrator = "many contacts: events would be crowded";
  } else {
    account.integrator = "adaptive";
    account.why_integrator = "few contacts: an error tolerance costs little";
  }
}

void choose_integrator(const SystemOf<Spatial>& system, SceneAccount& account) {
  const spatial::Scene& scene = system.scene();
  const bool rolls = std::any_of(scene.contacts.begin(), scene.contacts.end(), [](const spatial::Contact& c) {
    return std::holds_alternative<spatial::RimPlane>(c) || std::holds_alternative<spatial::EllipsoidPlane>(c);
  });
  if (rolls) {
    account.integrator = "stewart-trinkle";
    account.why_integrator = "rims and ellipsoids roll: moreau-jean lets them sink by O(h)";
  } else if (account.contacts + account.pairs == 0 && scene.frictions.empty()) {
    account.integrator = "generalized-alpha";
    account.why_integrator = "no contacts: its error falls with the square of the step";
  } else {
    account.integrator = "moreau-jean";
    account.why_integrator = "contacts in space: robust at a fixed step";
  }
}

/// The scene with its bodies moved into their joints, where they start off them; nothing, where they do not.
template <class Space> std::optional<SystemOf<Space>> in_joints(const SystemOf<Space>& system) {
  constexpr double kOff = 1e-6;  // [m, rad] what a scene file's digits may leave
  const State x = system.initial_state();
  if (!(off_most(system, x.t, x.q).off > kOff)) return std::nullopt;
  try {
    return SystemOf<Space>(assembled(system.scene()));
  } catch (const std::invalid_argument&) {  // no such place: the remarks on the start say how far they are off
    return std::nullopt;
  }
}

template <class Space> void find_jam(const SystemOf<Space>& system, SceneAccount& account) {
  const auto& scene = system.scene();
  for (const auto& joint : scene.joints)
    if (driven(joint)) account.driven.push_back(name_in(joint));
  if (account.driven.empty()) return;
  JamSearchOf<Space> search(system);
  const auto jam = search.find(system.initial_state(), scene.duration);
  account.jam_looked_until = jam ? scene.duration : search.looked_until();
  if (jam) account.jam = words(*jam);
}

template <class Space> SceneAccount account_for(const SystemOf<Space>& given) {
  const std::optional<SystemOf<Space>> moved = in_joints(given);
  const SystemOf<Space>& system = moved ? *moved : given;
  const auto& scene = system.scene();
  SceneAccount account;
  account.dimension = Space::kTranslations;
  account.bodies = system.bodies(), account.joints = static_cast<int>(scene.joints.size());
  account.joint_rows = system.joint_rows(), account.contacts = system.listed();
  account.collisions = static_cast<int>(scene.collisions.size()), account.pairs = system.pairs().back();
  for (const auto& body : scene.bodies) account.mass += body.mass;
  account.gruebler = system.dof() - system.joint_rows();
  const Eigen::VectorXd q = system.initial_state().q;
  account.ranked = system.joint_rows() <= kMostRanked;
  if (account.ranked) {
    account.redundancy = find_redundancy(system, q);
    account.redundant_rows = describe(account.redundancy, system);
  }
  TermsOf<Space> terms(system);
  set_poses(system, system.initial_state().t, q, terms.at);
  const auto names = event_contacts(scene);
  for (int i = 0; i < system.listed(); ++i)
    account.clearances.push_back({names[static_cast<std::size_t>(i)], gap_of(system, {}, i, terms.at)});
  for (const Remark& remark : remarks_on_start(given))
    if (remark.warning) account.remarks.push_back(remark.words);  // the others are redundant rows
  find_jam(system, account);
  account.step = suggested_step(system);
  choose_integrator(system, account);
  return account;
}

}  // namespace

SceneAccount account_of(const System& given) { return account_for(given); }
SceneAccount account_of(const SystemOf<Spatial>& given) { return account_for(given); }

std::string in_words(const SceneAccount& a) {
  constexpr std::size_t kMostNamed = 12;
  std::ostringstream out;
  out.precision(4);
  const auto count = [](int n, const char* one, const char* many) {
    return std::to_string(n) + ' ' + (n == 1 ? one : many);
  };
  out << "bodies: " << a.bodies << ", " << a.mass << " kg in all\n"
      << "joints: " << a.joints << " with " << count(a.joint_rows, "row", "rows") << '\n'
      << "contacts: " << a.contacts;
  if (a.collisions > 0) out << "; " << count(a.collisions, "collision", "collisions") << " of " << a.pairs << " pairs";
  out << "\nmobility: " << a.gruebler << " by Grübler (" << (a.dimension == 3 ? 6 : 3) << " bodies - joint rows)";
  if (a.ranked) {
    out << ", " << a.redundancy.dof << " by rank (" << a.redundancy.rank << " independent rows)\n";
    out << "redundant rows: " << (a.redundant_rows.empty() ? "none" : a.redundant_rows) << '\n';
  } else {
    out << "; too many rows to look for redundant ones\n";
  }
  if (!a.driven.empty()) {
    out << "drives:";
    for (const std::string& name : a.driven) out << ' ' << name;
    out << "; " << (a.jam.empty() ? "no jam" : a.jam) << " (looked at until t = " << a.jam_looked_until << " s)\n";
  }
  if (!a.clearances.empty()) {
    auto sorted = a.clearances;
    std::stable_sort(sorted.begin(), sorted.end(), [](const auto& p, const auto& q) { return p.gap < q.gap; });
    out << "clearances at the start [m or rad]:";
    for (std::size_t i = 0; i < std::min(kMostNamed, sorted.size()); ++i)
      out << (i > 0 ? "," : "") << ' ' << sorted[i].name << ' ' << sorted[i].gap;
    out << (sorted.size() > kMostNamed ? ", ...\n" : "\n");
  }
  for (const std::string& remark : a.remarks) out << "warning: " << remark << '\n';
  out << "suggested: --integrator " << a.integrator << " (" << a.why_integrator << "), fixed steps of " << a.step
      << " s\n";
  return out.str();
}

nlohmann::ordered_json as_json(const SceneAccount& a) {
  nlohmann::ordered_json json = {
      {"dimension", a.dimension},   {"bodies", a.bodies},         {"mass", a.mass},
      {"joints", a.joints},         {"joint_rows", a.joint_rows}, {"contacts", a.contacts},
      {"collisions", a.collisions}, {"pairs", a.pairs},           {"mobility_gruebler", a.gruebler}};
  if (a.ranked) {
    json["mobility_rank"] = a.redundancy.dof, json["rank"] = a.redundancy.rank;
    json["redundant_rows"] = a.redundant_rows;
  }
  json["drives"] = a.driven, json["jam"] = a.jam;
  json["clearances"] = nlohmann::ordered_json::object();
  for (const auto& one : a.clearances) json["clearances"][one.name] = one.gap;
  json["warnings"] = a.remarks;
  json["suggested_integrator"] = a.integrator, json["why"] = a.why_integrator, json["suggested_step"] = a.step;
  return json;
}

}  // namespace orthant
