// Growth of the cost of a mechanism with its size: chains, trees and nets of joints in the plane and in space, tracks.
//
//   chain  rods of 1 m and 1 kg, one after the other, released from the horizontal
//   tree   the same, two at the end of each
//   net    bodies of 1 kg in a square, each held by bars of 1 m to the next one in its row and the one above, the upper
//          row by the ground; every body begins with some velocity
//   track  a vehicle: links in a closed chain round two wheels, on the ground (studies/support/track.h); in the plane
// In space rods have ball joints, and nets may leave their plane. Joints: revolute or spherical, bars: distance. Only
// the track has contacts: else a step is the evaluation of the joints, a factorization of the saddle matrix, its
// solves, and the projection of positions onto the joints.
//
// A Markdown table, or a CSV file with --data: processor time of a step per body, the median of the counted ones; that
// of the first step with the integrator's construction (the order of elimination is found there, once) per body; memory
// at its peak per body, less that of an empty process. Each case is a process of its own. The last column is the slope
// of ln(time of a step) over ln(bodies) against the row before: 1 is linear.
#include "experiments/studies/support/track.h"
#include "experiments/support/between.h"
#include "experiments/support/clock.h"
#include "experiments/support/command_line.h"
#include "experiments/support/isolated.h"
#include "experiments/support/memory.h"
#include "experiments/support/rows_file.h"

#include <orthant/core/mechanics/scene/scene.h>
#include <orthant/core/mechanics/spatial/scene.h>
#include <orthant/core/mechanics/spatial/solid.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

using namespace orthant;

namespace {

constexpr double kGravity = 9.81;

/// Elements of both dimensions by the same names: positions are (across, up) in the plane, (across, 0, up) in space.
struct PlaneKind {
  using Space = Planar;
  using Scene = orthant::Scene;
  static Vector2d at(double x, double up) { return {x, up}; }
  static void weigh(Scene& s) { s.gravity = {0, -kGravity}; }
  static BodyId rod(Scene& s, double x, double up, double angle) {
    return s.body({.mass = 1, .inertia = 1.0 / 12, .position = {x, up}, .angle = angle});
  }
  static BodyId knot(Scene& s, double x, double up, const Vector2d& v) {
    return s.body({.mass = 1, .inertia = 0.01, .position = {x, up}, .velocity = v});
  }
  static void hinge(Scene& s, BodyId a, double end, BodyId b, double x, double up) {
    s.joint(Revolute{"", a, b, a == kGround ? Vector2d(x, up) : Vector2d(end, 0), {-0.5, 0}});
  }
  static void bar(Scene& s, BodyId a, const Vector2d& on_a, BodyId b) { s.joint(Distance{"", a, b, on_a, {0, 0}, 1}); }
};

struct SpaceKind {
  using Space = Spatial;
  using Scene = spatial::Scene;
  static Vector3d at(double x, double up) { return {x, 0, up}; }
  static void weigh(Scene& s) { s.gravity = {0, 0, -kGravity}; }
  static BodyId rod(Scene& s, double x, double up, double angle) {  // along its x; turned about −y
    const Vector3d moments(1e-3, 1.0 / 12, 1.0 / 12);
    return s.body({.mass = 1,
                   .inertia = moments.asDiagonal(),
                   .position = {x, 0, up},
                   .orientation = {std::cos(angle / 2), 0, -std::sin(angle / 2), 0}});
  }
  static BodyId knot(Scene& s, double x, double up, const Vector2d& v) {
    return s.body({.mass = 1,
                   .inertia = 0.01 * Eigen::Matrix3d::Identity(),
                   .position = {x, 0, up},
                   .velocity = {0, v.x() + v.y(), 0}});  // out of the net
  }
  static void hinge(Scene& s, BodyId a, double end, BodyId b, double x, double up) {
    s.joint(spatial::Spherical{"", a, b, a == kGround ? Vector3d(x, 0, up) : Vector3d(end, 0, 0), {-0.5, 0, 0}});
  }
  static void bar(Scene& s, BodyId a, const Vector3d& on_a, BodyId b) {
    s.joint(spatial::Distance{"", a, b, on_a, {0, 0, 0}, 1});
  }
};

/// Rod i > 0 hangs at the end of its parent.
template <class Kind> typename Kind::Scene rods(int count, bool tree) {
  typename Kind::Scene s;
  Kind::weigh(s);
  struct Tip {
    double x = 0, up = 0, angle = 0;
  };
  std::vector<Tip> tips;
  for (int i = 0; i < count; ++i) {
    const int parent = i == 0 ? -1 : tree ? (i - 1) / 2 : i - 1;
    const Tip from = parent < 0 ? Tip{} : tips[static_cast<std::size_t>(parent)];
    // The branches of a tree spread, less from level to level.
    const double level = std::floor(std::log2(i + 1.0));
    const double angle = from.angle + (tree && i > 0 ? (i % 2 == 0 ? -1 : 1) * 0.5 / (1 + level) : 0);
    const double x = std::cos(angle), up = std::sin(angle);
    const BodyId rod = Kind::rod(s, from.x + x / 2, from.up + up / 2, angle);
    Kind::hinge(s, parent < 0 ? kGround : parent, 0.5, rod, 0, 0);
    tips.push_back({from.x + x, from.up + up, angle});
  }
  return s;
}

template <class Kind> typename Kind::Scene net(int count) {
  const int side = std::max(2, static_cast<int>(std::lround(std::sqrt(count))));
  typename Kind::Scene s;
  Kind::weigh(s);
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      // In the plane rows swing as a whole: bars do not change their lengths at first.
      const BodyId knot = Kind::knot(s, column, -row - 1.0, {0.1 * std::sin(1.0 + row), 0});
      if (column > 0) Kind::bar(s, knot - 1, Kind::at(0, 0), knot);
      if (row > 0)
        Kind::bar(s, knot - side, Kind::at(0, 0), knot);
      else
        Kind::bar(s, kGround, Kind::at(column, 0), knot);
    }
  return s;
}

template <class Kind> typename Kind::Scene mechanism(const std::string& kind, int count) {
  if constexpr (std::is_same_v<Kind, PlaneKind>)
    if (kind == "track") return track({.links = std::max(24, 6 * ((count + 3) / 6))});
  return kind == "net" ? net<Kind>(count) : rods<Kind>(count, kind == "tree");
}

/// "bodies first-step-seconds step-seconds bytes joint-residual".
template <class Kind> std::string measured(const std::string& kind, int count, const std::string& scheme, int steps) {
  using Space = typename Kind::Space;
  const double before = peak_memory(), begin = rival::processor_time();
  const SystemOf<Space> system(mechanism<Kind>(kind, count));
  const auto integrator = make_integrator(scheme, system);
  const auto solver = make_solver("auto");
  State x = system.initial_state();
  double first = 0, residual = 0;
  std::vector<double> times;
  for (int k = 0; k <= steps; ++k) {
    const double start = rival::processor_time();
    const StepReport report = integrator->step(1e-3, *solver, x);
    const double now = rival::processor_time();
    if (report.status != Status::solved)
      throw std::runtime_error("step " + std::to_string(k + 1) + ": " + std::string(name(report.status)) + ' ' +
                               integrator->why());
    residual = std::max(residual, report.joint_residual);
    if (k == 0)
      first = now - begin;
    else
      times.push_back(now - start);
  }
  std::nth_element(times.begin(), times.begin() + std::ssize(times) / 2, times.end());
  std::ostringstream said;
  said << std::setprecision(17) << system.bodies() << ' ' << first << ' ' << times[times.size() / 2] << ' '
       << peak_memory() - before << ' ' << residual;
  return said.str();
}

struct Plan {
  std::vector<int> dimensions{2, 3}, sizes{100, 1000, 10000, 100000};
  std::vector<std::string> kinds{"chain", "tree", "net", "track"}, schemes{"moreau-jean"};
  int steps = 5;
  double limit = 600;  // of a case [s]
};

struct CaseRow {
  std::string kind;
  int dimension;
  std::string scheme;
  double bodies = 0, step = 0, first = 0, bytes = 0, residual = 0;  // [s, s, B, m]
  double growth = 0;                                                // NaN: there is no row before
  std::string status = "solved";                                    // else the reason; without figures
};

CaseRow one_case(const Plan& plan, const std::string& kind, int dimension, const std::string& scheme, int size,
                 const CaseRow* last) {
  CaseRow row{kind, dimension, scheme};
  Isolated isolated(1, 0);
  const auto work = [&] {
    return dimension == 2 ? measured<PlaneKind>(kind, size, scheme, plan.steps)
                          : measured<SpaceKind>(kind, size, scheme, plan.steps);
  };
  isolated.start(work, plan.limit, [&](const Outcome& outcome) {
    std::istringstream words(outcome.text);
    if (outcome.kind != Outcome::finished ||
        !(words >> row.bodies >> row.first >> row.step >> row.bytes >> row.residual))
      row.bodies = size, row.status = outcome.kind == Outcome::killed ? "late" : outcome.text;
  });
  isolated.wait_for_all();
  const bool comparable = row.status == "solved" && last != nullptr && last->status == "solved";
  row.growth = comparable ? std::log(row.step / last->step) / std::log(row.bodies / last->bodies) : std::nan("");
  return row;
}

/// The cells of a row from its time on: of both forms.
std::string cells(const CaseRow& row, const char* between, const char* none) {
  std::ostringstream line;
  line << std::setprecision(3);
  if (row.status == "solved") {
    line << 1e6 * row.step / row.bodies << between << 1e6 * row.first / row.bodies << between
         << 1e-3 * row.bytes / row.bodies << between << row.residual << between;
    if (std::isnan(row.growth))
      line << none;
    else
      line << row.growth;
  } else {
    line << none << between << none << between << none << between << none << between << none;
  }
  return line.str();
}

/// Every case, in order; see(row) as soon as it is there.
template <class See> void all_cases(const Plan& plan, See&& see) {
  for (const int dimension : plan.dimensions)
    for (const std::string& kind : plan.kinds)
      for (const std::string& scheme : plan.schemes) {
        if (kind == "track" && dimension == 3) continue;
        std::optional<CaseRow> last;
        for (const int size : plan.sizes) {
          last = one_case(plan, kind, dimension, scheme, size, last ? &*last : nullptr);
          see(*last);
        }
      }
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("Growth of the cost of chains, trees, nets and tracks: time of a step and memory per body");
  Plan plan;
  std::string data;
  bool append = false;
  app.add_option("--dimensions", plan.dimensions, "2, 3")->check(CLI::IsMember({2, 3}))->capture_default_str();
  app.add_option("--kinds", plan.kinds, "of mechanisms")
      ->check(CLI::IsMember({"chain", "tree", "net", "track"}))
      ->capture_default_str();
  app.add_option("--integrators", plan.schemes, "with their options")->capture_default_str();
  app.add_option("--sizes", plan.sizes,
                 "numbers of bodies; of nets the nearest square, of links the nearest multiple of 6")
      ->check(CLI::Range(2, 1000000))
      ->capture_default_str();
  app.add_option("--steps", plan.steps, "counted, after the first one")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--time-limit", plan.limit, "of a case [s]")->check(between(1e-3, 1e6))->capture_default_str();
  CLI::Option* file = app.add_option("--data", data, "CSV file in place of the table");
  app.add_flag("--append", append, "to the file of --data")->needs(file);
  if (const auto end = parse(app, argc, argv)) return *end;
  if (!data.empty()) {
    RowsFile rows(data, append,
                  "kind,dimension,integrator,bodies,status,step_us_a_body,first_us_a_body,kB_a_body,joints_m,growth");
    all_cases(plan, [&](const CaseRow& row) {
      std::ostringstream line;
      line << row.kind << ',' << row.dimension << ',' << text_cell(row.scheme) << ',' << row.bodies << ','
           << text_cell(row.status) << ',' << cells(row, ",", "");
      rows.row(line.str());
    });
    return 0;
  }
  std::cout << "| mechanism | dimension | integrator | bodies | step, µs a body | start, µs a body | "
               "memory, kB a body | "
               "joints | growth |\n|---|---|---|---|---|---|---|---|---|\n";
  all_cases(plan, [](const CaseRow& row) {
    std::cout << "| " << row.kind << " | " << row.dimension << " | `" << row.scheme << "` | " << row.bodies << " | "
              << (row.status == "solved" ? "" : row.status + ": ") << cells(row, " | ", "–") << " |" << std::endl;
  });
} catch (const std::exception& error) {
  std::cerr << "mechanism_scaling: " << error.what() << '\n';
  return 1;
}
