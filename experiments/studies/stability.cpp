// How far do the numbers carry? Mass ratios, stiffness, step sizes, clearances, no gravity, places far away, long runs.
//
// Each study moves one number of one scene over its decades, by every integrator with Lemke's method and by moreau-jean
// with every solver: the worst residual, joint drift, penetration, energy defect (most above what it had been, over the
// largest kinetic energy), and how the run ended. Writes stability.csv, a row a run, and stability.md, a table a study,
// and at its end one of all solvers. Long runs are by some solvers only. With --dimension 3 the scenes are in space and
// have exact answers: the tables have the errors (support/spatial_stability.h).
#include "experiments/runs/manifest.h"
#include "experiments/studies/support/equivalent_scene.h"
#include "experiments/studies/support/spatial_stability_tables.h"
#include "experiments/support/between.h"
#include "experiments/support/command_line.h"
#include "experiments/support/progress.h"

#include <orthant/core/scenes/bouncing_ball.h>
#include <orthant/core/scenes/pendulum.h>
#include <orthant/core/scenes/slider_crank.h>
#include <orthant/core/support/file.h>
#include <orthant/core/support/options.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <CLI/CLI.hpp>

#include <cmath>
#include <filesystem>
#include <iostream>
#include <map>

using namespace orthant;

namespace {

struct Study {
  std::string name;
  std::vector<double> values;
  std::function<Scene(double)> scene;  // its step and duration are those of the run
  bool is_long() const { return name.starts_with("steps"); }
};

std::vector<double> decades(int from, int to, int stride = 1) {
  std::vector<double> values;
  for (int k = from; from < to ? k <= to : k >= to; k += from < to ? stride : -stride)
    values.push_back(std::pow(10.0, k));
  return values;
}

Scene timed(Scene s, double step, double duration) {
  s.step = step, s.duration = duration;
  return s;
}

/// A ball of 1 kg on the floor, a ball of `ratio` kg falls on it.
Scene stack(double ratio) {
  Scene s;
  s.gravity = {0, -kGravity};
  const auto low = s.body({.name = "low", .mass = 1, .inertia = 0.1, .position = {0, 0.5}});
  const auto high = s.body({.name = "high", .mass = ratio, .inertia = 0.1 * ratio, .position = {0, 1.6}});
  s.contact(DiscWall{"floor", low, {0, 0}, 0.5, kGround, {0, 0}, {0, 1}, {.mu = 0.3, .e = 0.2}});
  s.contact(DiscDisc{"between", high, {0, 0}, 0.5, low, {0, 0}, 0.5, {.mu = 0.3, .e = 0.2}});
  return timed(s, 1e-3, 1);
}

/// A mass of 1 kg at 1 m/s between a spring and a floor 0.7 mm below, which it reaches up to 1e6 N/m.
Scene sprung(double stiffness) {
  Scene s;
  s.gravity = {0, -kGravity};
  const auto body = s.body({.name = "body", .position = {0, 7e-4}, .velocity = {0, -1}});
  s.spring(PointSpring{"spring", body, kGround, {0, 0}, {0, 1 + 7e-4}, stiffness, 0, 1});
  s.contact(CornerWall{"floor", body, {0, 0}, kGround, {0, 0}, {0, 1}, {.e = 0.2}});
  return timed(s, 1e-3, 1);
}

std::vector<Study> studies(bool quick) {
  const int stride = quick ? 3 : 1;
  const double most = quick ? 200 : 2000, many = quick ? 1e5 : 1e7;  // steps
  const auto crank = [](double clearance) { return slider_crank({.mu = 0.1, .clearance = clearance}); };
  return {
      {"mass ratio", decades(0, 12, stride), stack},
      {"stiffness [N/m]", decades(0, 12, stride), sprung},
      {"step [s]", decades(-1, -9, quick ? 2 : 1),
       [=](double h) { return timed(crank(1e-3), h, std::min(0.2, most * h)); }},
      {"clearance [m]", decades(-2, -7, quick ? 2 : 1), [=](double c) { return timed(crank(c), 1e-5, most * 1e-5); }},
      {"gravity [m/s2]", {9.81, 0}, [=](double g) { return timed(slider_crank({.g = g}), 1e-5, most * 1e-5); }},
      {"offset [m]", decades(0, 6, quick ? 3 : 1),
       [=](double far) {
         return timed(moved(crank(1e-3), 0, {far, far}), 1e-5, most * 1e-5);
       }},
      {"steps, pendulum", {many / 100, many}, [](double n) { return timed(pendulum(Pendulum{}), 1e-3, 1e-3 * n); }},
      {"steps, ball", {many / 100, many}, [](double n) { return timed(bouncing_ball({.e = 1}), 1e-3, 1e-3 * n); }},
  };
}

struct Row {
  std::string study, integrator, solver, end, why;
  double value = 0, steps = 0, residual = 0, drift = 0, penetration = 0, defect = 0, seconds = 0;
};

Row visit(const Study& study, double value, const std::string& integrator, const std::string& solver, double limit) {
  Row row{.study = study.name, .integrator = integrator, .solver = solver, .value = value};
  try {
    const System system(study.scene(value));
    double least = kInf, kinetic = 0, rise = 0;
    const auto see = [&](const RunSample& m) {
      const double e = energy(system, m.state);
      kinetic = std::max(kinetic, 0.5 * m.state.v.dot(system.mass().cwiseProduct(m.state.v)));
      least = std::min(least, e), rise = std::max(rise, e - least);
    };
    const Scene& scene = system.scene();
    const long every = std::max(1L, std::lround(scene.duration / scene.step / 1e5));
    const Run run =
        simulate(*make_integrator(integrator, system), *make_solver(solver),
                 {.step = scene.step, .duration = scene.duration, .every = every, .time_limit = limit}, see);
    row.end = name(run.status), row.why = run.why, row.steps = static_cast<double>(run.steps);
    row.residual = run.max_lcp_residual, row.drift = run.max_joint_residual, row.penetration = run.max_penetration;
    row.defect = kinetic > 0 ? rise / kinetic : 0, row.seconds = run.seconds;
  } catch (const std::invalid_argument& error) {
    row.end = "refused", row.why = error.what();
  }
  return row;
}

std::string brief(double x) {
  std::ostringstream text;
  text << std::setprecision(1) << std::scientific << x;
  return x == 0 ? "0" : text.str();
}

/// Of one integrator and solver: the worst of the runs that ended well, and the values at which others did not.
std::string line_of(const std::vector<Row>& rows) {
  std::array<double, 4> worst{};
  std::string failed;
  for (const Row& r : rows) {
    if (r.end != "solved") {
      failed += (failed.empty() ? "" : ", ") + brief(r.value) + ": " + r.end;
      continue;
    }
    const std::array<double, 4> all = {r.residual, r.drift, r.penetration, r.defect};
    for (std::size_t k = 0; k < all.size(); ++k) worst[k] = std::max(worst[k], all[k]);
  }
  std::string line = "| `" + rows[0].integrator + "` | `" + rows[0].solver + "` |";
  for (const double x : worst) line += ' ' + brief(x) + " |";
  return line + ' ' + (failed.empty() ? "-" : failed) + " |\n";
}

/// Of one solver: how many of its runs ended well or were refused, the worst residual of the former, and where others
/// ended:
/// by study the values, neighbours as a range.
std::string line_of_solver(const std::string& solver, const std::vector<Row>& rows) {
  std::string failed;
  double residual = 0;
  int solved = 0, refused = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (rows[k].end == "unsupported" || rows[k].end == "refused") ++refused;
    if (rows[k].end == "solved") ++solved, residual = std::max(residual, rows[k].residual);
  }
  const auto fails = [&](std::size_t k, const std::string& study) {
    if (k >= rows.size() || rows[k].study != study) return false;
    return rows[k].end != "solved" && rows[k].end != "unsupported" && rows[k].end != "refused";
  };
  std::string last;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const std::string& study = rows[k].study;
    if (!fails(k, study)) continue;
    failed += study == last ? ", " : (failed.empty() ? "" : "; ") + study + ' ';
    last = study;
    failed += brief(rows[k].value);
    if (!fails(k + 1, study)) continue;
    while (fails(k + 1, study)) ++k;
    failed += " to " + brief(rows[k].value);
  }
  return "| `" + solver + "` | " + std::to_string(solved) + " | " + std::to_string(refused) + " | " +
         std::to_string(static_cast<int>(rows.size()) - solved - refused) + " | " +
         (solved > 0 ? brief(residual) : "-") + " | " + (failed.empty() ? "-" : failed) + " |\n";
}

std::string planar_tables(const std::filesystem::path& output, bool quick, double limit, const std::string& only) {
  std::string csv = "study,value,integrator,solver,end,steps,residual,drift,penetration,energy_defect,seconds\n",
              tables;
  std::vector<std::pair<std::string, std::string>> few, every;
  for (const auto& entry : integrators()) few.emplace_back(entry.name, "lemke");
  every = few;
  for (const char* solver : {"auto", "path", "newton-fb", "pgs"}) few.emplace_back("moreau-jean", solver);
  for (const auto& entry : solvers())
    if (entry.name != "lemke") every.emplace_back("moreau-jean", entry.name);
  std::map<std::string, std::vector<Row>> by_solver;
  auto all = studies(quick);
  std::erase_if(all, [&](const Study& study) { return study.name.find(only) == std::string::npos; });
  if (all.empty()) throw std::invalid_argument("--only '" + only + "': no study's name has it");
  std::filesystem::create_directories(output);
  double lines = 0;
  for (const Study& study : all) lines += static_cast<double>((study.is_long() ? few : every).size());
  Progress progress("stability", lines);
  for (const Study& study : all) {
    tables += "\n**" + study.name + "**, " + brief(study.values.front()) + " to " + brief(study.values.back()) +
              ":\n\n| integrator | solver | residual [m/s] | drift [m] | penetration [m] | energy | not solved |\n"
              "|---|---|---|---|---|---|---|\n";
    for (const auto& [integrator, solver] : study.is_long() ? few : every) {
      std::vector<Row> rows;
      for (const double value : study.values) {
        const Row& r = rows.emplace_back(visit(study, value, integrator, solver, limit));
        csv += '"' + r.study + "\"," + detail::text_of(r.value) + ',' + r.integrator + ',' + r.solver + ',' + r.end;
        for (const double x : {r.steps, r.residual, r.drift, r.penetration, r.defect, r.seconds})
          csv += ',' + detail::text_of(x);
        csv += '\n';
      }
      tables += line_of(rows);
      if (integrator == "moreau-jean" && !study.is_long()) {
        auto& known = by_solver[solver];
        known.insert(known.end(), rows.begin(), rows.end());
      }
      progress.add(1, false);
    }
  }
  if (!by_solver.empty())
    tables +=
        "\n**Solvers**, by `moreau-jean`, all studies but the long ones:\n\n"
        "| solver | solved | refused | failed | residual [m/s] | failed at |\n|---|---|---|---|---|---|\n";
  for (const auto& [solver, rows] : by_solver) tables += line_of_solver(solver, rows);
  write_whole(output / "stability.csv", csv);
  write_whole(output / "stability.md", tables);
  return tables;
}

}  // namespace

int main(int argc, char** argv) {
  std::filesystem::path output;
  bool quick = false;
  int dimension = 2;
  double limit = 60;
  std::string only;
  CLI::App app("Mass ratios, stiffness, steps, clearances, offsets: how far the numbers carry");
  app.add_option("--output", output, "folder for the tables and the manifest; default: results/stability, _space");
  app.add_option("--dimension", dimension, "2: planar scenes; 3: scenes in space with exact answers, by solver auto")
      ->check(CLI::IsMember({2, 3}))
      ->capture_default_str();
  app.add_option("--time-limit", limit, "of each run [s]")->check(between(1e-3, 1e6))->capture_default_str();
  app.add_option("--only", only, "studies whose name has this text");
  app.add_flag("--quick", quick, "every third decade, shorter runs");
  if (const auto end = parse(app, argc, argv)) return *end;
  std::string command_line;
  for (int i = 0; i < argc; ++i) command_line += (i > 0 ? " " : "") + std::string(argv[i]);
  if (output.empty()) output = dimension == 3 ? "results/stability_space" : "results/stability";
  try {
    const std::string tables =
        dimension == 3 ? spatial_stability({output, quick, limit, only}) : planar_tables(output, quick, limit, only);
    auto about = manifest();
    about["command"] = command_line;
    write_whole(output / "manifest.json", about.dump(2) + "\n");
    std::cout << tables;
  } catch (const std::exception& error) {
    std::cerr << "stability: " << error.what() << '\n';
    return 1;
  }
}
