// Growth of the cost of a pile with its size: discs in a trough, spheres in a well, or bodies poured into a box.
//
// Each pile settles; `--by` solves its steps. Two Markdown tables. The first has, of the last steps: sweeps (or other
// iterations of the solver), processor time per contact of a whole step, memory per body (scene, system, integrator)
// and per contact (all that steps add), the peak of the process, the residual as a share of g h, the largest overlap.
// With several numbers of threads the last steps take them by turns, on one motion, and wall times follow. Below it
// stands the slope of each quantity in a log-log fit over the number of contacts. The second table has each solver's
// time on the last step's problem, from a cold start, until the judge accepts a residual (relative to the problem's
// data).
// With --data there is one CSV file instead: a line for each number of bodies and of threads, each of a process of its
// own from the start on, with the hash of its last state.
// With --columns there is one table only: of spheres on top of one another, at rest, the iterations of each solver and
// its factorizations from a cold start to the first of the residuals.
#include "experiments/support/between.h"
#include "experiments/support/clock.h"
#include "experiments/support/command_line.h"
#include "experiments/support/isolated.h"
#include "experiments/support/reference_kernel.h"

#include <orthant/core/lcp/judge/certify_cones.h>
#include <orthant/core/mechanics/spatial/solid.h>
#include <orthant/core/scenes/pile.h>
#include <orthant/core/scenes/spheres.h>
#include <orthant/core/support/hash.h>
#include <orthant/integrators/fixed_step/velocity_stepping.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <CLI/CLI.hpp>

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
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
};

/// What the last steps cost and reached.
struct Cost {
  double contacts = 0, iterations = 0, seconds = 0;  // of a step; processor time with one thread
  std::vector<double> wall;                          // [s] a step, of each number of threads
  double body_bytes = 0, contact_bytes = 0;          // of one
  double residual = 0, penetration = 0;              // the largest [g h, m]
  Index rows = 0;
  double processor = 0;                  // [s] a step, of all threads
  double peak = 0;                       // [B] of the process
  double scale_free = 0;                 // residual of the last step's problem (certify_cones.h)
  std::uint64_t state = kHashOfNothing;  // of the last q and v
  Lcp problem;                           // of the last step, where it is wanted
};

double peak_memory() {  // [B]
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return 1024.0 * static_cast<double>(usage.ru_maxrss);
}

double resident_memory() {  // [B]
  std::ifstream file("/proc/self/statm");
  double all = 0, resident = 0;
  file >> all >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

std::uint64_t hash_of(const Eigen::VectorXd& x, std::uint64_t hash) {
  return fnv1a({reinterpret_cast<const char*>(x.data()), static_cast<std::size_t>(x.size()) * sizeof(double)}, hash);
}

double wall_time() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Throws std::runtime_error with the reason where a step ends without an answer.
template <class Space, class Scene> Cost settled(Scene&& scene, double gravity, const Settling& way, bool problem) {
  using System = SystemOf<Space>;
  Cost cost;
  const double before = resident_memory();
  const System system(std::forward<Scene>(scene));
  const auto scheme = make_integrator("moreau-jean", system);
  std::vector<std::unique_ptr<Solver>> solvers;
  for (const int threads : way.threads) {
    solvers.push_back(make_solver(with(way.by, way.tolerance, threads)));
    solvers.back()->set_time_limit(way.time_limit);
  }
  State x = system.initial_state();
  const double built = resident_memory();
  cost.body_bytes = (built - before) / system.bodies();
  const long steps = std::max(1L, std::lround(way.fall / way.h)), counted = std::min(steps, way.counted);
  const auto turns = static_cast<long>(solvers.size());
  std::vector<long> taken(solvers.size());
  cost.wall.resize(solvers.size());
  double bytes = 0;
  for (long k = 0; k < steps; ++k) {
    const auto turn = static_cast<std::size_t>(k < steps - counted ? turns - 1 : k % turns);
    const double begin = thread_time(), wall = wall_time(), processor = rival::processor_time();
    const StepReport report = scheme->step(way.h, *solvers[turn], x);
    const double seconds = thread_time() - begin;
    const double of_process = rival::processor_time() - processor;
    if (report.status != Status::solved)
      throw std::runtime_error("step " + std::to_string(k) + ": " + std::string(name(report.status)) + " " +
                               std::string(scheme->why()));
    bytes = std::max(bytes, resident_memory() - built);
    if (k < steps - counted) continue;
    double contacts = 0;
    for (const auto& impulse : scheme->impulses()) contacts += impulse.normal > 0;
    cost.contacts += contacts / static_cast<double>(counted);
    cost.iterations += report.lcp_iterations / static_cast<double>(counted);
    cost.processor += of_process / static_cast<double>(counted);
    ++taken[turn], cost.wall[turn] += wall_time() - wall;
    if (way.threads[turn] == 1) cost.seconds += seconds;
    cost.residual = std::max(cost.residual, report.lcp_residual / (gravity * way.h));
    cost.penetration = std::max(cost.penetration, report.penetration);
    cost.rows = report.lcp_rows;
  }
  for (std::size_t turn = 0; turn < solvers.size(); ++turn) {
    if (taken[turn] == 0) continue;
    cost.wall[turn] /= static_cast<double>(taken[turn]);
    if (way.threads[turn] == 1) cost.seconds /= static_cast<double>(taken[turn]);
  }
  cost.contact_bytes = cost.contacts > 0 ? bytes / cost.contacts : 0;
  cost.peak = peak_memory();
  cost.state = hash_of(x.v, hash_of(x.q, cost.state));
  if (const auto* stepping = dynamic_cast<const VelocitySteppingOf<Space>*>(scheme.get()))
    if (const Vector& z = stepping->formulation().solution().z; z.size() == scheme->problem().size())
      cost.scale_free = cone_residuals(scheme->problem(), z).scale_free;
  if (problem) cost.problem = scheme->problem();
  return cost;
}

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

enum class Kind { discs, spheres, pour };

Cost by_kind(Kind kind, int count, Pour pouring, const Settling& way, bool problem) {
  pouring.count = count;
  return kind == Kind::pour      ? settled<Spatial>(pour(pouring), pouring.g, way, problem)
         : kind == Kind::spheres ? settled<Spatial>(spheres({.count = count}), kGravity, way, problem)
                                 : settled<Planar>(pile({.discs = count}), kGravity, way, problem);
}

/// The file of --data. Returns the exit code: 3 where a case ends without an answer, or two numbers of threads differ.
int write_data(const std::string& path, Kind kind, const std::vector<int>& sizes, const Pour& pouring,
               const Settling& way) {
  std::ofstream file(path);
  file << "bodies,contacts,threads,sweeps,processor_us_a_contact,wall_ms,scale_free,overlap_um,peak_MB,B_a_contact,"
          "state\n";
  Isolated children(1, 0);
  bool all = true;
  for (const int count : sizes) {
    std::string state;
    for (const int threads : way.threads) {
      Settling one = way;
      one.threads = {threads};
      const auto work = [&] {
        const Cost cost = by_kind(kind, count, pouring, one, false);
        std::ostringstream line;
        line << std::setprecision(4) << count << ',' << std::lround(cost.contacts) << ',' << threads << ','
             << cost.iterations << ',' << 1e6 * cost.processor / cost.contacts << ',' << 1e3 * cost.wall[0] << ','
             << cost.scale_free << ',' << 1e6 * cost.penetration << ',' << std::lround(1e-6 * cost.peak) << ','
             << std::lround(cost.peak / cost.contacts) << ',' << std::hex << cost.state;
        return line.str();
      };
      children.start(work, 1e7, [&](const Outcome& outcome) {
        if (outcome.kind != Outcome::finished) {
          std::cerr << "pile_scaling: " << count << " bodies, " << outcome.text << '\n';
          all = false;
          return;
        }
        file << outcome.text << std::endl;
        std::cout << outcome.text << std::endl;
        const std::string hash = outcome.text.substr(outcome.text.rfind(',') + 1);
        if (!state.empty() && hash != state) {
          std::cerr << "pile_scaling: " << count << " bodies: the state depends on the number of threads\n";
          all = false;
        }
        state = hash;
      });
      children.wait_for_all();
    }
  }
  return all && file ? 0 : 3;
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
  std::vector<int> heights;
  Pour pouring;
  Settling way{
      .by = "nncg", .fall = 0.3, .h = 1e-3, .tolerance = kSettling, .time_limit = 5, .counted = 20, .threads = {1}};
  app.add_option("--dimension", dimension, "2: discs in a trough, 3: spheres in a well")
      ->check(CLI::IsMember({2, 3}))
      ->capture_default_str();
  app.add_option("--pour", poured, "in space, into a box of the ground's shapes: these bodies (core/scenes/spheres.h)")
      ->check(CLI::IsMember(std::vector<std::string>(Pour::kBodiesNames.begin(), Pour::kBodiesNames.end())));
  app.add_option("--apart", pouring.apart, "places of --pour, in diameters")
      ->check(between(1.0, 10.0))
      ->capture_default_str();
  app.add_option("--spread", pouring.spread, "of the sizes of --pour")->check(between(0.0, 0.5))->capture_default_str();
  app.add_option("--columns", heights, "the other table: of columns of so many spheres")->check(CLI::Range(1, 100000));
  app.add_option("--sizes", sizes, "numbers of bodies")->check(CLI::Range(1, 1000000))->capture_default_str();
  app.add_option("--solvers", specs, "without a tolerance")->capture_default_str();
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
  app.add_option("--data", data, "CSV file in place of the tables: each case in a process of its own");
  app.add_option("--time-limit", way.time_limit, "of a solve [s]")->check(between(1e-3, 1e6))->capture_default_str();
  if (const auto end = parse(app, argc, argv)) return *end;
  const Kind kind = !poured.empty() ? Kind::pour : dimension == 3 ? Kind::spheres : Kind::discs;
  if (!steps_only)
    for (const std::string& spec : specs) make_solver(with(spec, kSettling));
  for (const int threads : way.threads)
    make_solver(with(way.by, kSettling, threads));  // an unknown one is refused before the table
  for (std::size_t i = 0; i < Pour::kBodiesNames.size(); ++i)
    if (poured == Pour::kBodiesNames[i]) pouring.bodies = static_cast<Pour::Bodies>(i);

  if (!heights.empty()) {
    columns(heights, specs, tolerances.front(), way);
    return 0;
  }
  if (!data.empty()) return write_data(data, kind, sizes, pouring, way);
  const std::string bodies = kind == Kind::pour ? poured : kind == Kind::discs ? "discs" : "spheres";
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
    Cost cost;
    try {
      cost = by_kind(kind, count, pouring, way, !steps_only);
    } catch (const std::runtime_error& error) {
      std::cerr << "pile_scaling: " << count << ' ' << bodies << ", " << error.what() << '\n';
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
