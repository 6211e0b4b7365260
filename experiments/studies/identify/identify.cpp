// Parameters from motions: what derivatives of event-driven motions are worth in three searches.
//
//   fit           friction, restitution and clearance of the slider-crank from a noisy crank angle (fit.h)
//   contact_loss  the crank speed from which on the slider leaves its guide (contact_loss.h)
//   shot          a billiard shot that brings two balls to given places (shot.h)
// Each prints a table and writes PART.csv.
#include "experiments/runs/manifest.h"
#include "experiments/studies/identify/contact_loss.h"
#include "experiments/studies/identify/fit.h"
#include "experiments/studies/identify/nlopt_search.h"
#include "experiments/studies/identify/shot.h"
#include "experiments/studies/identify/timed.h"
#include "experiments/support/between.h"
#include "experiments/support/command_line.h"

#include <orthant/core/support/file.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <iostream>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <vector>

using namespace orthant;

namespace {

Table contact_loss() {
  constexpr double kLow = 5, kHigh = 60, kNear = 1e-12;
  std::cout << "Crank speed at which contact loss begins: slider resting on its guide, e = 0, between " << kLow
            << " and " << kHigh
            << " rad/s\nNewton, Illinois: root of the least normal force; bisection: does a run have "
            << "a release?\n\n";
  std::ostringstream found;
  Table table{"mu",          "method",
              "derivatives", "crank speed [rad/s]",
              "error",       "release below, above",
              "runs",        "runs with derivatives",
              "seconds",     "failure"};
  const struct {
    const char *name, *derivatives;
    double (ContactLoss::*find)(double, double);
  } methods[] = {{"Newton", "yes", &ContactLoss::by_newton},
                 {"Illinois", "no", &ContactLoss::by_chords},
                 {"bisection", "no", &ContactLoss::by_halving}};
  for (const double mu : {0.0, 0.01}) {
    const GuidedSlider slider{.mu = mu};
    const double exact = frictionless_contact_loss(slider.clearance);
    for (const auto& method : methods) {
      ContactLoss search(slider);
      double speed = std::numeric_limits<double>::quiet_NaN();
      const Timed timed = time_of([&] { speed = (search.*method.find)(kLow, kHigh); });
      const int runs = search.runs, tangents = search.tangents;
      std::string releases = "-";
      if (timed.failure.empty())
        releases = std::string(search.release(speed * (1 - kNear)) ? "yes" : "no") + "; " +
                   (search.release(speed * (1 + kNear)) ? "yes" : "no");
      table.row({Table::Number{mu}, method.name, method.derivatives, Table::Number{speed, 15},
                 mu > 0 ? Table::Cell("-") : Table::Number{std::abs(speed / exact - 1), 2}, releases, runs, tangents,
                 Table::Number{timed.seconds, 3}, timed.failure});
    }
    ContactLoss search(slider);
    const LeastForce at = search.least(search.by_newton(kLow, kHigh), true);
    found << "mu = " << mu << ": contact is lost at t = " << at.t << " s, theta_1 = " << at.angle
          << " rad; the least force falls by " << -at.slope << " N s/rad\n";
  }
  std::cout << "\nerror: relative, of the closed form for mu = 0; releases: at the crank speed times 1 -+ " << kNear
            << '\n'
            << found.str() << '\n';
  return table;
}

Table shot() {
  constexpr double kEnough = 1e-9;  // [m]
  std::cout << "Billiard shot: places of two balls at the end, to " << kEnough
            << " m; draw shot in the plane, bank shot in space\n\n";
  std::ostringstream found;
  found << std::setprecision(12);
  Table table{"shot", "method", "derivatives", "miss [m]", "runs", "runs with derivatives", "seconds", "failure"};
  struct Method {
    const char *name, *derivatives;
    nlopt_algorithm algorithm;  // NLOPT_NUM_ALGORITHMS: Newton's method
  };
  const Method methods[] = {
      {"Newton", "J", NLOPT_NUM_ALGORITHMS},       {"NLopt L-BFGS", "gradient", NLOPT_LD_LBFGS},
      {"NLopt SLSQP", "gradient", NLOPT_LD_SLSQP}, {"NLopt BOBYQA", "no", NLOPT_LN_BOBYQA},
      {"NLopt COBYLA", "no", NLOPT_LN_COBYLA},     {"NLopt Nelder-Mead", "no", NLOPT_LN_NELDERMEAD},
      {"NLopt Sbplx", "no", NLOPT_LN_SBPLX}};
  for (const int dimension : {2, 3}) {
    for (const Method& method : methods) {
      Shot shot(dimension);
      Eigen::VectorXd x = shot.start.cwiseQuotient(shot.unit);
      const Timed timed = time_of([&] {
        if (method.algorithm == NLOPT_NUM_ALGORITHMS) return shot.by_newton(x, kEnough);
        search(
            {.algorithm = method.algorithm,
             .low = shot.low.cwiseQuotient(shot.unit),
             .high = shot.high.cwiseQuotient(shot.unit),
             .x_relative = 1e-13,
             .enough = kEnough * kEnough / 2,
             .most = 1000},
            [&](const Eigen::VectorXd& at, Eigen::VectorXd* gradient) {
              Eigen::MatrixXd J;
              const Eigen::VectorXd r = gradient != nullptr ? shot.miss(at, J) : shot.miss(at);
              if (gradient != nullptr) *gradient = J.transpose() * r;
              return r.squaredNorm() / 2;
            },
            x);
      });
      const int runs = shot.runs, tangents = shot.tangents;
      table.row({dimension == 2 ? "draw" : "bank", method.name, method.derivatives,
                 Table::Number{shot.miss(x).norm(), 2}, runs, tangents, Table::Number{timed.seconds, 3},
                 timed.failure});
      if (method.algorithm != NLOPT_NUM_ALGORITHMS) continue;
      found << (dimension == 2 ? "draw:" : "bank:");
      for (std::size_t k = 0; k < shot.names.size(); ++k)
        found << ' ' << shot.names[k] << ' ' << (x.cwiseProduct(shot.unit))[static_cast<Eigen::Index>(k)];
      found << " (SI units)\n";
    }
  }
  std::cout << '\n' << found.str() << '\n';
  return table;
}

}  // namespace

int main(int argc, char** argv) {
  FitPlan plan;
  std::filesystem::path output;
  const std::map<std::string, std::function<Table()>> parts{
      {"fit", [&] { return fit_parameters(plan); }}, {"contact_loss", contact_loss}, {"shot", shot}};
  std::vector<std::string> chosen{"fit", "contact_loss", "shot"};
  CLI::App app("identify: parameters from motions, by derivatives and without: a fit, contact loss, a billiard shot");
  app.add_option("--sigma", plan.sigma, "of the fit: standard deviation of the noise [rad]")
      ->check(between(1e-12, 1))
      ->capture_default_str();
  app.add_option("--duration", plan.duration, "of the fit: of the measurement [s]")
      ->check(between(1e-3, 10))
      ->capture_default_str();
  app.add_option("--samples", plan.samples, "of the fit: angles measured")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  app.add_option("--seed", plan.seed, "of the fit: of the noise")->capture_default_str();
  app.add_option("--parts", chosen, "fit, contact_loss, shot")
      ->check(CLI::IsMember({"fit", "contact_loss", "shot"}))
      ->capture_default_str();
  app.add_option("--output", output, "folder for PART.csv and manifest.json; none: nothing is written");
  if (const auto code = parse(app, argc, argv)) return *code;
  try {
    if (!output.empty()) {
      std::filesystem::create_directories(output);
      check_writable(output / "manifest.json");
    }
    for (const std::string& part : chosen) {
      const Table table = parts.at(part)();
      if (!output.empty()) write_whole(output / (part + ".csv"), table.csv());
    }
    if (!output.empty()) write_whole(output / "manifest.json", manifest().dump(2) + "\n");
  } catch (const std::exception& error) {
    std::cerr << "identify: " << error.what() << '\n';
    return 1;
  }
}
