// experiments/studies/pile_scaling/pile_motion.h — a pile that settles, and what its last steps cost.
#pragma once

#include "experiments/support/clock.h"
#include "experiments/support/memory.h"
#include "experiments/support/reference_kernel.h"

#include <orthant/core/lcp/judge/certify_cones.h>
#include <orthant/core/scenes/pile.h>
#include <orthant/core/scenes/spheres.h>
#include <orthant/core/support/hash.h>
#include <orthant/integrators/fixed_step/velocity_stepping.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace orthant {

constexpr double kSettling = 1e-6;  // default tolerance of the steps

/// The solver `spec` with a tolerance and a number of threads.
std::string with(const std::string& spec, double tolerance, int threads = 1);

struct Settling {
  std::string by;
  double fall, h, tolerance, time_limit;  // [s], –, [s]
  long counted;                           // of the last steps
  std::vector<int> threads;               // by turns in these

  long steps() const { return std::max(1L, std::lround(fall / h)); }
  long last_steps() const { return std::min(steps(), counted); }
};

/// What the last steps cost and reached.
struct Cost {
  double contacts = 0, iterations = 0, seconds = 0;  // of a step's problem; processor time with one thread
  std::vector<double> wall;                          // [s] a step, of each number of threads
  double body_bytes = 0, contact_bytes = 0;          // of one
  double residual = 0, penetration = 0;              // the largest [g h, m]
  Index rows = 0;
  double processor = 0;                  // [s] a step, of all threads
  double peak = 0;                       // [B] of the process
  double scale_free = 0;                 // residual of the last step's problem (certify_cones.h)
  std::uint64_t state = kHashOfNothing;  // of the last q and v
  Lcp problem;                           // of the last step, where it is wanted
  Status status = Status::solved;        // else of the step without an answer: only its sweeps, time, residual are set
  std::string end;                       // that step and its reason
};

/// Hash of the bits of x, after those that `hash` has been made of.
std::uint64_t hash_of(const Eigen::VectorXd& x, std::uint64_t hash);

/// [s]
double wall_time();

/// The solver of the steps in each number of threads.
std::vector<std::unique_ptr<Solver>> solvers_of(const Settling& way);

/// A pile and its motion. Memory counts from here on.
template <class Space> class PileMotion {
 public:
  using System = SystemOf<Space>;
  template <class Scene> PileMotion(Scene&& scene, double gravity) : system_(std::forward<Scene>(scene)), g_(gravity) {}

  /// The steps before those that count, by the last number of threads.
  Cost settle(const Settling& way) {
    Cost cost;
    const auto solvers = solvers_of(way);
    for (steps_ = 0; steps_ < way.steps() - way.last_steps(); ++steps_)
      if (!step(way.h, *solvers.back(), cost)) break;
    return cost;
  }

  /// The steps that count, by each number of threads in turn.
  Cost last_steps(const Settling& way) {
    Cost cost;
    const auto solvers = solvers_of(way);
    const auto turns = static_cast<long>(solvers.size()), counted = way.last_steps();
    std::vector<long> taken(solvers.size());
    cost.wall.resize(solvers.size());
    for (long k = 0; k < counted; ++k, ++steps_) {
      const auto turn = static_cast<std::size_t>(steps_ % turns);
      const double begin = thread_time(), wall = wall_time(), processor = rival::processor_time();
      const bool solved = step(way.h, *solvers[turn], cost);
      const double seconds = thread_time() - begin, of_process = rival::processor_time() - processor;
      if (!solved) {
        cost.wall[turn] = wall_time() - wall, cost.processor = of_process;
        look_at_problem(cost);
        return cost;
      }
      cost.contacts += closed_contacts() / static_cast<double>(counted);
      cost.iterations += report_.lcp_iterations / static_cast<double>(counted);
      cost.processor += of_process / static_cast<double>(counted);
      ++taken[turn], cost.wall[turn] += wall_time() - wall;
      if (way.threads[turn] == 1) cost.seconds += seconds;
      cost.residual = std::max(cost.residual, report_.lcp_residual / (g_ * way.h));
      cost.penetration = std::max(cost.penetration, report_.penetration);
      cost.rows = report_.lcp_rows;
    }
    for (std::size_t turn = 0; turn < solvers.size(); ++turn) {
      if (taken[turn] == 0) continue;
      cost.wall[turn] /= static_cast<double>(taken[turn]);
      if (way.threads[turn] == 1) cost.seconds /= static_cast<double>(taken[turn]);
    }
    cost.body_bytes = (built_ - before_) / system_.bodies();
    cost.contact_bytes = cost.contacts > 0 ? bytes_ / cost.contacts : 0;
    cost.peak = peak_memory();
    cost.state = hash_of(state_.v, hash_of(state_.q, cost.state));
    look_at_problem(cost);
    return cost;
  }

  const Lcp& problem() const { return scheme_->problem(); }

 private:
  /// False where it has no answer: then `cost` has the reason.
  bool step(double h, Solver& solver, Cost& cost) {
    report_ = scheme_->step(h, solver, state_);
    bytes_ = std::max(bytes_, resident_memory() - built_);
    if (report_.status == Status::solved) return true;
    cost.status = report_.status, cost.iterations = report_.lcp_iterations;
    cost.end =
        "step " + std::to_string(steps_) + ": " + std::string(name(report_.status)) + " " + std::string(scheme_->why());
    return false;
  }

  /// Contacts of the last step's problem, all of them with friction.
  double closed_contacts() const {
    const auto* stepping = dynamic_cast<const VelocitySteppingOf<Space>*>(scheme_.get());
    return stepping == nullptr ? 0 : static_cast<double>(stepping->formulation().step_problem().friction().size());
  }

  void look_at_problem(Cost& cost) const {
    if (const auto* stepping = dynamic_cast<const VelocitySteppingOf<Space>*>(scheme_.get()))
      if (const Vector& z = stepping->formulation().solution().z; z.size() == problem().size())
        cost.scale_free = cone_residuals(problem(), z).scale_free;
  }

  double before_ = resident_memory();  // [B]
  System system_;
  double g_;
  std::unique_ptr<IntegratorOf<Space>> scheme_ = make_integrator("moreau-jean", system_);
  State state_ = system_.initial_state();
  double built_ = resident_memory(), bytes_ = 0;  // [B] with the pile; that steps add
  StepReport report_;
  long steps_ = 0;
};

enum class Kind { discs, well, pour };

/// What piles up.
struct Bodies {
  std::string name;
  Kind kind = Kind::discs;
  Pour pouring;  // of Kind::pour

  /// Returns see(the pile at rest, its gravity).
  template <class See> auto in_motion(int count, See&& see) const {
    Pour all = pouring;
    all.count = count;
    return kind == Kind::pour   ? see(PileMotion<Spatial>(pour(all), all.g))
           : kind == Kind::well ? see(PileMotion<Spatial>(spheres({.count = count}), kGravity))
                                : see(PileMotion<Planar>(pile({.discs = count}), kGravity));
  }
};

/// Of a name: discs, well (spheres in it), or one of Pour::kBodiesNames.
Bodies bodies_of(const std::string& name, const Pour& pouring);

}  // namespace orthant
