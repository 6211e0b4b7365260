// Growth of the cost of a pile with its size: discs in a trough, spheres in a well, or bodies poured into a box.
//
// Each pile settles; `--by` solves its steps. Two Markdown tables. The first has, of the last steps: sweeps (or other
// iterations of the solver), processor time per contact of a whole step, memory per body (scene, system, integrator)
// and per contact (all that steps add), the peak of the process, the residual as a share of g h, the largest overlap.
// Contacts are those of a step's problem.
// With several numbers of threads the last steps take them by turns, on one motion, and wall times follow. Below it
// stands the slope of each quantity in a log-log fit over the number of contacts. The second table has each solver's
// time on the last step's problem, from a cold start, until the judge accepts a residual (relative to the problem's
// data).
// With --data there is one CSV file instead, of all --kinds. The last steps of each pile are taken again, from the same
// settled state, by each of --solvers to each of --tolerances in each number of threads. Each is a line, from a process
// of its own, with the status of its end and the hash of its last state. Where the status is not `solved`, time, sweeps
// and residual are those of the step that ends without an answer.
// With --columns there is one table only: of spheres on top of one another, at rest, the iterations of each solver and
// its factorizations from a cold start to the first of the residuals.
#include "experiments/support/between.h"
#include "experiments/support/clock.h"
#include "experiments/support/command_line.h"
#include "experiments/support/isolated.h"
#include "experiments/support/memory.h"
#include "experiments/support/reference_kernel.h"
#include "experiments/support/rows_file.h"

#include <orthant/core/lcp/judge/certify_cones.h>
#include <orthant/core/mechanics/spatial/solid.h>
#include <orthant/core/scenes/pile.h>
#include <orthant/core/scenes/spheres.h>
#include <orthant/core/support/hash.h>
#include <orthant/integrators/fixed_step/velocity_stepping.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

using namespace orthant;

namespace {

std::string with(const std::string& spec, double tolerance, int threads = 1) {
  std::ostringstream full;
  full << spec << (spec.find(':') == std::string::npos ? ':' : ',') << "tolerance=" << tolerance;
  if (threads > 1) full << ",threads=" << threads;
  return full.str();
}

/// Time in ms, or why there is none.
std::string cold(const Lcp& problem, const std::string& spec, double tolerance, double time_limit) {
  const auto solver = make_solver(with(spec, tolerance));
  solver->set_time_limit(time_limit);
  Solution s;
  const double begin = thread_time();
  if (solver->solve(problem, s).status != Status::solved) return std::string(name(s.status));
  std::ostringstream time;
  time << std::setprecision(3) << 1e3 * (thread_time() - begin);
  return time.str();
}

constexpr double kSettling = 1e-6;  // default tolerance of the steps

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

std::uint64_t hash_of(const Eigen::VectorXd& x, std::uint64_t hash) {
  return fnv1a({reinterpret_cast<const char*>(x.data()), static_cast<std::size_t>(x.size()) * sizeof(double)}, hash);
}

double wall_time() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// The solver of the steps in each number of threads.
std::vector<std::unique_ptr<Solver>> solvers_of(const Settling& way) {
  std::vector<std::unique_ptr<Solver>> solvers;
  for (const int threads : way.threads) {
    solvers.push_back(make_solver(with(way.by, way.tolerance, threads)));
    solvers.back()->set_time_limit(way.time_limit);
  }
  return solvers;
}

/// A pile and its motion. Memory counts from here on.
template <class Space> class Motion {
 public:
  using System = SystemOf<Space>;
  template <class Scene> Motion(Scene&& scene, double gravity) : system_(std::forward<Scene>(scene)), g_(gravity) {}

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

/// The problem of a column of spheres at rest, each on the next one.
Lcp column(int count, double h) {
  constexpr double kRadius = 0.05;
  const spatial::Solid solid = spatial::sphere(kRadius);
  spatial::Scene s;
  s.gravity = {0, 0, -kGravity};
  spatial::Collision all{.name = "column", .shapes = {}, .law = {.mu = 0.3}};
  for (int i = 0; i < count; ++i) {
    const BodyId body = s.body({.name = "sphere" + std::to_string(i + 1),
                                .mass = 1000 * solid.volume,
                                .inertia = 1000 * solid.volume * solid.inertia,
                                .position = {0, 0, (2 * i + 1) * kRadius}});
    all.shapes.push_back({body, {Vector3d::Zero()}, kRadius});
    if (i > 0) continue;
    spatial::SpherePlane floor{.name = "floor", .a = body, .law = all.law};
    floor.radius = kRadius;
    s.contact(floor);
  }
  s.collision(std::move(all));
  const SystemOf<Spatial> system(std::move(s));
  const auto scheme = make_integrator("moreau-jean", system);
  const auto solver = make_solver("auto:tolerance=1e-6");
  State x = system.initial_state();
  scheme->step(h, *solver, x);
  return scheme->problem();
}

void columns(const std::vector<int>& heights, const std::vector<std::string>& specs, double tolerance,
             const Settling& way) {
  std::cout << "| spheres | contacts |";
  for (const std::string& spec : specs) std::cout << " `" << spec << "` |";
  std::cout << "\n|---|---|";
  for (std::size_t i = 0; i < specs.size(); ++i) std::cout << "---|";
  std::cout << std::endl;
  for (const int height : heights) {
    const Lcp problem = column(height, way.h);
    std::cout << "| " << height << " | " << problem.friction.size() << " |";
    for (const std::string& spec : specs) {
      const auto solver = make_solver(with(spec, tolerance));
      solver->set_time_limit(way.time_limit);
      Solution s;
      const Status status = solver->solve(problem, s).status;
      std::cout << ' ';
      if (has_answer(status))
        std::cout << s.iterations;
      else
        std::cout << name(status);
      if (s.factorizations > 0) std::cout << " (" << s.factorizations << " factorizations)";
      std::cout << " |" << std::flush;
    }
    std::cout << '\n';
  }
}

/// Slope of the least-squares line through (log x, log y).
double slope(const std::vector<double>& x, const std::vector<double>& y) {
  double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!(x[i] > 0 && y[i] > 0)) continue;
    const double a = std::log(x[i]), b = std::log(y[i]);
    n += 1, sx += a, sy += b, sxx += a * a, sxy += a * b;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

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
    return kind == Kind::pour   ? see(Motion<Spatial>(pour(all), all.g))
           : kind == Kind::well ? see(Motion<Spatial>(spheres({.count = count}), kGravity))
                                : see(Motion<Planar>(pile({.discs = count}), kGravity));
  }
};

Bodies bodies_of(const std::string& name, const Pour& pouring) {
  Bodies bodies{name, name == "discs" ? Kind::discs : name == "well" ? Kind::well : Kind::pour, pouring};
  for (std::size_t i = 0; i < Pour::kBodiesNames.size(); ++i)
    if (name == Pour::kBodiesNames[i]) bodies.pouring.bodies = static_cast<Pour::Bodies>(i);
  return bodies;
}

/// The cases of --data.
struct Cases {
  std::vector<Bodies> kinds;
  std::vector<int> sizes;
  std::vector<std::string> solvers;
  std::vector<double> tolerances;
};

/// Cells that the lines of one case begin with.
std::string beginning(const Bodies& bodies, int count, const Settling& way) {
  std::ostringstream line;
  line << bodies.name << ',' << count << ',' << way.steps() - way.last_steps() << ',' << text_cell(way.by) << ','
       << way.tolerance << ',' << way.threads[0] << ',';
  return line.str();
}

std::string cells(const Cost& cost) {
  std::ostringstream line;
  line << std::setprecision(4) << name(cost.status) << ',';
  if (cost.status != Status::solved) {
    line << ',' << cost.iterations << ",," << 1e3 * cost.wall[0] << ',' << cost.scale_free << ",,,,";
    return line.str();
  }
  line << std::lround(cost.contacts) << ',' << cost.iterations << ',' << 1e6 * cost.processor / cost.contacts << ','
       << 1e3 * cost.wall[0] << ',' << cost.scale_free << ',' << 1e6 * cost.penetration << ','
       << std::lround(1e-6 * cost.peak) << ',' << std::lround(cost.peak / cost.contacts) << ',' << std::hex
       << cost.state;
  return line.str();
}

/// All lines of one pile: it settles, and its last steps are taken from there in each way, by a process each.
template <class Space>
std::string lines_of(Motion<Space>&& pile, const Bodies& bodies, int count, const Cases& cases, const Settling& way) {
  Settling before = way;
  before.threads = {1};
  const Cost settled = pile.settle(before);
  std::string lines;
  for (const std::string& solver : cases.solvers)
    for (const double tolerance : cases.tolerances)
      for (const int threads : way.threads) {
        Settling one = way;
        one.by = solver, one.tolerance = tolerance, one.threads = {threads};
        lines += beginning(bodies, count, one);
        if (settled.status != Status::solved) {
          lines += "settling: " + std::string(name(settled.status)) + ",,,,,,,,,\n";
          continue;
        }
        Isolated child(1, 0);
        child.start([&] { return cells(pile.last_steps(one)); }, 1e7,
                    [&](const Outcome& outcome) {
                      lines +=
                          (outcome.kind == Outcome::finished ? outcome.text : text_cell(outcome.text) + ",,,,,,,,,") +
                          '\n';
                    });
        child.wait_for_all();
      }
  if (!settled.end.empty()) std::cerr << "pile_scaling: " << count << ' ' << bodies.name << ", " << settled.end << '\n';
  return lines;
}

/// The file of --data. Returns the exit code: 3 where two numbers of threads differ. Cases without an answer are lines.
int write_data(const std::string& path, bool append, const Cases& cases, const Settling& way) {
  RowsFile file(path, append,
                "kind,bodies,settling,solver,tolerance,threads,status,contacts,sweeps,processor_us_a_contact,wall_ms,"
                "scale_free,overlap_um,peak_MB,B_a_contact,state");
  Isolated children(1, 0);
  bool same = true;
  for (const Bodies& bodies : cases.kinds)
    for (const int count : cases.sizes) {
      const auto work = [&] {
        return bodies.in_motion(count,
                                [&](auto&& pile) { return lines_of(std::move(pile), bodies, count, cases, way); });
      };
      children.start(work, 1e7, [&](const Outcome& outcome) {
        if (outcome.kind != Outcome::finished) {
          file.row(bodies.name + ',' + std::to_string(count) + ",,,,," + text_cell(outcome.text) + ",,,,,,,,,");
          return;
        }
        std::istringstream lines(outcome.text);
        std::vector<std::string> states;
        for (std::string line; std::getline(lines, line);) {
          file.row(line);
          states.push_back(line.substr(line.rfind(',') + 1));
        }
        const std::size_t threads = way.threads.size();
        for (std::size_t i = 0; i < states.size(); ++i)
          if (const std::string& first = states[i - i % threads];
              states[i] != first && states[i] != "" && first != "") {
            std::cerr << "pile_scaling: " << count << ' ' << bodies.name
                      << ": the state depends on the number of threads\n";
            same = false;
          }
      });
      children.wait_for_all();
    }
  return same ? 0 : 3;
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("Growth of the cost of a pile: steps per body and contact, memory, solvers at equal residual");
  std::vector<int> sizes{10, 30, 100, 300, 1000, 3000, 10000};
  std::vector<std::string> specs{"pgs", "nncg", "newton-min", "newton-fb", "auto"};
  std::vector<double> tolerances{1e-3, 1e-6, 1e-9};
  int dimension = 2;
  bool steps_only = false;
  std::string poured, data;
  std::vector<std::string> kinds;
  bool append = false;
  std::vector<int> heights;
  Pour pouring;
  Settling way{
      .by = "nncg", .fall = 0.3, .h = 1e-3, .tolerance = kSettling, .time_limit = 5, .counted = 20, .threads = {1}};
  CLI::Option* dimension_option = app.add_option("--dimension", dimension, "2: discs in a trough, 3: spheres in a well")
                                      ->check(CLI::IsMember({2, 3}))
                                      ->capture_default_str();
  CLI::Option* pour_option =
      app.add_option("--pour", poured,
                     "in space, into a box of the ground's shapes: these bodies (core/scenes/spheres.h)")
          ->check(CLI::IsMember(std::vector<std::string>(Pour::kBodiesNames.begin(), Pour::kBodiesNames.end())));
  app.add_option("--apart", pouring.apart, "places of --pour, in diameters")
      ->check(between(1.0, 10.0))
      ->capture_default_str();
  app.add_option("--spread", pouring.spread, "of the sizes of --pour")->check(between(0.0, 0.5))->capture_default_str();
  app.add_option("--columns", heights, "the other table: of columns of so many spheres")->check(CLI::Range(1, 100000));
  app.add_option("--sizes", sizes, "numbers of bodies")->check(CLI::Range(1, 1000000))->capture_default_str();
  app.add_option("--solvers", specs, "of the second table, or of the last steps of --data; without a tolerance")
      ->capture_default_str();
  app.add_flag("--steps-only", steps_only, "without the second table");
  app.add_option("--tolerances", tolerances, "relative residuals")->check(between(1e-14, 1.0))->capture_default_str();
  app.add_option("--by", way.by, "solver of the steps while the pile settles")->capture_default_str();
  app.add_option("--by-tolerance", way.tolerance, "its relative residual")
      ->check(between(1e-14, 1.0))
      ->capture_default_str();
  app.add_option("--fall", way.fall, "time to settle [s]")->check(between(1e-3, 1e3))->capture_default_str();
  app.add_option("--step", way.h, "[s]")->check(between(1e-6, 1e-1))->capture_default_str();
  app.add_option("--counted", way.counted, "last steps that count")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  app.add_option("--threads", way.threads, "inside the solver, by turns; of pgs, psor, sgs, nncg in space")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  CLI::Option* file = app.add_option("--data", data, "CSV file in place of the tables, with the cases that fail");
  app.add_option("--kinds", kinds, "of --data: discs, well (spheres in it), spheres, boxes, capsules, mixed (poured)")
      ->check(CLI::IsMember({"discs", "well", "spheres", "boxes", "capsules", "mixed"}))
      ->needs(file)
      ->excludes(pour_option)
      ->excludes(dimension_option);
  app.add_flag("--append", append, "to the file of --data")->needs(file);
  app.add_option("--time-limit", way.time_limit, "of a solve [s]")->check(between(1e-3, 1e6))->capture_default_str();
  if (const auto end = parse(app, argc, argv)) return *end;
  if (!steps_only || !data.empty())  // an unknown one is refused before the table
    for (const std::string& spec : specs)
      for (const int threads : data.empty() ? std::vector{1} : way.threads) make_solver(with(spec, kSettling, threads));
  for (const int threads : data.empty() ? way.threads : std::vector{1}) make_solver(with(way.by, kSettling, threads));
  if (kinds.empty()) kinds = {!poured.empty() ? poured : dimension == 3 ? "well" : "discs"};

  if (!heights.empty()) {
    columns(heights, specs, tolerances.front(), way);
    return 0;
  }
  if (!data.empty()) {
    Cases cases{{}, sizes, specs, tolerances};
    for (const std::string& kind : kinds) cases.kinds.push_back(bodies_of(kind, pouring));
    return write_data(data, append, cases, way);
  }
  const Bodies piled = bodies_of(kinds[0], pouring);
  const std::string bodies = piled.kind == Kind::well ? "spheres" : piled.name;
  std::ostringstream solves;
  solves << "| " << bodies << " | rows | residual |";
  for (const std::string& spec : specs) solves << " `" << spec << "`, ms |";
  solves << "\n|---|---|---|";
  for (std::size_t i = 0; i < specs.size(); ++i) solves << "---|";
  solves << '\n' << std::setprecision(3);
  std::cout << "| " << bodies
            << " | contacts | sweeps | a step, µs a contact | B a body | B a contact | peak, MB | residual, g h "
               "| overlap, mm |";
  for (const int threads : way.threads) std::cout << " wall in " << threads << ", ms a step |";
  std::cout << "\n|---|---|---|---|---|---|---|---|---|";
  for (std::size_t i = 0; i < way.threads.size(); ++i) std::cout << "---|";
  std::cout << '\n' << std::setprecision(3);
  std::vector<double> contacts, seconds, sweeps, memory;
  for (const int count : sizes) {
    const Cost cost = piled.in_motion(count, [&](auto&& pile) {
      Cost last = pile.settle(way);
      if (last.status == Status::solved) last = pile.last_steps(way);
      if (!steps_only) last.problem = pile.problem();
      return last;
    });
    if (cost.status != Status::solved) {
      std::cerr << "pile_scaling: " << count << ' ' << bodies << ", " << cost.end << '\n';
      return 3;
    }
    contacts.push_back(cost.contacts), seconds.push_back(cost.seconds), sweeps.push_back(cost.iterations);
    memory.push_back(cost.body_bytes * count + cost.contact_bytes * cost.contacts);
    std::cout << "| " << count << " | " << std::lround(cost.contacts) << " | " << cost.iterations << " | "
              << (cost.contacts > 0 ? 1e6 * cost.seconds / cost.contacts : 0) << " | " << std::lround(cost.body_bytes)
              << " | " << std::lround(cost.contact_bytes) << " | " << std::lround(1e-6 * peak_memory()) << " | "
              << cost.residual << " | " << 1e3 * cost.penetration << " |";
    for (const double wall : cost.wall) std::cout << ' ' << 1e3 * wall << " |";
    std::cout << std::endl;
    if (steps_only || cost.contacts == 0) continue;
    for (const double tolerance : tolerances) {
      solves << "| " << count << " | " << cost.problem.size() << " | " << tolerance << " |";
      for (const std::string& spec : specs)
        solves << ' ' << cold(cost.problem, spec, tolerance, way.time_limit) << " |";
      solves << '\n';
    }
  }
  if (sizes.size() > 1)
    std::cout << "\nSlopes over the number of contacts: time " << slope(contacts, seconds) << ", sweeps "
              << slope(contacts, sweeps) << ", memory " << slope(contacts, memory) << '\n';
  if (!steps_only) std::cout << '\n' << solves.str();
} catch (const std::exception& error) {  // an unknown solver or option
  std::cerr << "pile_scaling: " << error.what() << '\n';
  return 1;
}
