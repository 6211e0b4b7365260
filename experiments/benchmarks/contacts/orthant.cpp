// Orthant in the comparison of contacts.py: runs a scene in space, and prints what the last step did.
//
//   contact_record FILE INTEGRATOR SOLVER STEP DURATION
//
//   JSON: seconds (processor time of the steps alone), steps, velocities before and after the last step, poses at which
//   it has its rows and after it, and its contacts: bodies a and b (−1: the ground), point on a, point on b, normal
//   to a, impulse on a [N s], gap.
#include "experiments/benchmarks/contacts/thread_clock.h"

#include <orthant/core/scenes/registry.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <stdexcept>
#include <string_view>

using namespace orthant;
using Json = nlohmann::json;

namespace {

Json numbers(const Vector3d& x) { return {x.x(), x.y(), x.z()}; }

Json state_of(const SystemOf<Spatial>& system, const State& x, TermsOf<Spatial>& terms) {
  set_poses(system, x.t, x.q, terms.at);
  set_twists(system, x.v, terms.at);
  Json places = Json::array(), rotations = places, velocities = places, omegas = places;
  for (BodyId i = 0; i < system.bodies(); ++i) {
    const spatial::Pose& pose = terms.at.at(i);
    places.push_back(numbers(pose.x));
    rotations.push_back({numbers(pose.R.row(0)), numbers(pose.R.row(1)), numbers(pose.R.row(2))});
    velocities.push_back(numbers(terms.at.rate(i).v)), omegas.push_back(numbers(terms.at.rate(i).omega));
  }
  return {{"place", places}, {"rotation", rotations}, {"velocity", velocities}, {"omega", omegas}};
}

/// The velocities at the end of the step if nothing touched.
Eigen::VectorXd free_flight(const SystemOf<Spatial>& system, const State& x, double h, TermsOf<Spatial>& terms) {
  set_poses(system, x.t, x.q, terms.at);
  set_twists(system, x.v, terms.at);
  evaluate_forces(system, x.t, x.v, terms);
  Eigen::VectorXd f = terms.f;
  add_gyroscopic(system, x.v, f);
  return x.v + h * system.inverse_mass().cwiseProduct(f);
}

/// Contacts with an impulse or without a gap, in the poses of q. Gaps are those before a flight of `back` from there.
Json contacts_of(const IntegratorOf<Spatial>& integrator, double t, const Eigen::VectorXd& q,
                 const Eigen::VectorXd& back) {
  const SystemOf<Spatial>& system = integrator.system();
  TermsOf<Spatial> terms(system);
  terms.pairs.assign(integrator.pairs().begin(), integrator.pairs().end());
  set_poses(system, t, q, terms.at);
  evaluate_gaps(system, terms);
  Json all = Json::array();
  const auto& impulses = integrator.impulses();
  for (int i = 0; i < system.contacts(); ++i) {
    const auto& impulse = impulses[static_cast<std::size_t>(i)];
    if (!(impulse.normal > 0) && !(terms.gap[i] <= 0)) continue;
    const int one[] = {i};
    evaluate_closed(system, std::span<const int>(one), terms);
    const auto& rows = terms.closed[0].rows;
    const Vector3d n = spatial::direction_of(rows.normal);
    const Vector3d push = impulse.normal * n + impulse.tangent.first * spatial::direction_of(rows.tangents[0]) +
                          impulse.tangent.second * spatial::direction_of(rows.tangents[1]);
    // Listed contacts act at one point of both bodies, searched ones at a point of each.
    const Vector3d on_a = i < system.listed() ? rows.point : Vector3d(rows.point + terms.gap[i] * n);
    all.push_back({rows.normal.a, rows.normal.b, numbers(on_a), numbers(rows.point), numbers(n), numbers(push),
                   terms.gap[i] - apply(rows.normal, back.data())});
  }
  return all;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 6) throw std::invalid_argument("contact_record FILE INTEGRATOR SOLVER STEP DURATION");
  const AnyScene scene = make_any_scene(argv[1]);
  if (!std::holds_alternative<spatial::Scene>(scene)) throw std::invalid_argument("FILE: must be a scene in space");
  const SystemOf<Spatial> system(std::get<spatial::Scene>(scene));
  const auto integrator = make_integrator(argv[2], system);
  const auto solver = make_solver(argv[3]);
  const double step = std::atof(argv[4]), duration = std::atof(argv[5]);
  if (!(step > 0) || !(duration >= step)) throw std::invalid_argument("STEP, DURATION: must be 0 < STEP <= DURATION");
  State x = system.initial_state(), before = x;
  const long steps = std::lround(duration / step);
  double seconds = 0;
  for (long k = 0; k < steps; ++k) {
    before = x;
    const double begin = rival::thread_time();
    const StepReport report = integrator->step(step, *solver, x);
    seconds += rival::thread_time() - begin;
    if (report.status != Status::solved)
      throw std::runtime_error("step " + std::to_string(k + 1) + ": " + std::string(name(report.status)) + ' ' +
                               integrator->why());
  }
  TermsOf<Spatial> terms(system);
  State at = before;  // the poses of the step's rows: its middle, for gaps the end of free flight
  Eigen::VectorXd back = Eigen::VectorXd::Zero(before.v.size());
  if (std::string_view(argv[2]).starts_with("stewart-trinkle")) {
    back = step * free_flight(system, before, step, terms);
    move<Spatial>(before.q, back, at.q);
  } else {
    move<Spatial>(before.q, step / 2 * before.v, at.q);
  }
  std::cout << Json{{"seconds", seconds},
                    {"steps", steps},
                    {"before", state_of(system, at, terms)},
                    {"after", state_of(system, x, terms)},
                    {"contacts", contacts_of(*integrator, at.t, at.q, back)}}
            << '\n';
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
