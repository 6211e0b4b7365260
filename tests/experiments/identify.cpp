// Searches in motions: the crank speed at which contact loss begins, and billiard shots.
#include <doctest/doctest.h>

#include "experiments/studies/identify/contact_loss.h"
#include "experiments/studies/identify/shot.h"
#include "tests/support/folder.h"

#include <orthant/integrators/event_driven/event_driven.h>
#include <orthant/integrators/event_driven/spatial_event_driven.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <cmath>

using namespace orthant;

TEST_CASE("contact of the slider is lost above the crank speed that Newton's method finds, and kept below it") {
  for (const GuidedSlider& p : {GuidedSlider{.mu = 0}, GuidedSlider{.mu = 0.01}, GuidedSlider{.clearance = 0.002}}) {
    CAPTURE(p.mu);
    CAPTURE(p.clearance);
    ContactLoss search(p);
    const double speed = search.by_newton(5, 60);
    CHECK_FALSE(search.release(speed * (1 - 1e-11)));
    const auto lost = search.release(speed * (1 + 1e-11));
    REQUIRE(lost);
    CHECK(std::abs(*lost - search.least(speed, false).t) < 1e-4);
    if (p.mu == 0) CHECK(std::abs(speed / frictionless_contact_loss(p.clearance) - 1) < 1e-12);
  }
}

TEST_CASE("the least force on the slider has the derivative that differences give, kept or lost") {
  ContactLoss search({});
  for (const double speed : {12.0, 20.0, 25.0}) {
    CAPTURE(speed);
    const double step = 1e-4 * speed;
    const double by_difference =
        (search.least(speed + step, false).force - search.least(speed - step, false).force) / (2 * step);
    CHECK(std::abs(search.least(speed, true).slope / by_difference - 1) < 1e-5);
  }
}

TEST_CASE("derivatives of the least force take less than half the runs of a bisection") {
  ContactLoss newton({}), chords({}), halving({});
  const double speed = newton.by_newton(5, 60);
  CHECK(std::abs(chords.by_chords(5, 60) / speed - 1) < 1e-12);
  CHECK(std::abs(halving.by_halving(5, 60) / speed - 1) < 1e-12);
  CHECK(2 * (newton.runs + newton.tangents) < halving.runs);
  CHECK(newton.runs < chords.runs);
}

TEST_CASE("a bracket without the onset of contact loss is refused") {
  ContactLoss search({});
  for (const auto& [low, high] : {std::pair{30.0, 60.0}, std::pair{5.0, 20.0}}) {
    CHECK_THROWS_AS(search.by_newton(low, high), std::invalid_argument);
    CHECK_THROWS_AS(search.by_chords(low, high), std::invalid_argument);
    CHECK_THROWS_AS(search.by_halving(low, high), std::invalid_argument);
  }
}

namespace {

/// [m] How far another integrator's balls end from the aim; coordinates: those of the places.
template <class System> double missed(const System& system, double duration, std::initializer_list<Eigen::Index> places,
                                      const Eigen::VectorXd& aim, std::string& order) {
  const auto other = make_integrator("adaptive:rtol=1e-10", system);
  const Run run =
      simulate(*other, *make_solver("auto"), {.step = duration, .duration = duration}, [&](const auto& moment) {
        for (const Event& event : moment.events)
          if (event.kind == EventKind::impact) order += std::to_string(event.contact);
      });
  REQUIRE(run.status == Status::solved);
  double sum = 0;
  Eigen::Index i = 0;
  for (const Eigen::Index place : places) sum += std::pow(run.final.q[place] - aim[i++], 2);
  return std::sqrt(sum);
}

}  // namespace

TEST_CASE("a draw shot by derivatives of its motion meets both places to 1e-9") {
  Shot shot(2);
  Eigen::VectorXd x = shot.start.cwiseQuotient(shot.unit);
  CHECK(shot.miss(x).norm() > 0.1);
  shot.by_newton(x, 1e-9);
  CHECK(shot.miss(x).norm() <= 1e-9);
  std::string order;
  CHECK(missed(System(draw_shot(x.cwiseProduct(shot.unit))), 2, {0, 3}, shot.aim, order) < 1e-6);

  Eigen::MatrixXd J;
  shot.miss(x, J);
  for (Eigen::Index k = 0; k < x.size(); ++k) {
    const Eigen::VectorXd step = 1e-5 * Eigen::VectorXd::Unit(x.size(), k);
    CHECK((J.col(k) - (shot.miss(x + step) - shot.miss(x - step)) / 2e-5).norm() < 1e-7 * J.norm());
  }
}

TEST_CASE("a bank shot in space by derivatives meets the places of two balls to 1e-9" * doctest::test_suite("slow")) {
  Shot shot(3);
  Eigen::VectorXd x = shot.start.cwiseQuotient(shot.unit);
  CHECK(shot.miss(x).norm() > 0.1);
  shot.by_newton(x, 1e-9);
  CHECK(shot.miss(x).norm() <= 1e-9);
  std::string order;
  const SystemOf<Spatial> system(bank_shot(x.cwiseProduct(shot.unit)));
  CHECK(missed(system, 1.5, {0, 1, 7, 8}, shot.aim, order) < 1e-6);
  CAPTURE(order);
  CHECK(order.find('1') < order.find('4'));  // the cushion, then ball 2
}

TEST_CASE("the program writes a row a search, as printed, with its manifest") {
  const std::string program = ORTHANT_EXPERIMENTS "/identify";
  if (!std::filesystem::exists(program)) return;  // a build without Ipopt or NLopt
  const Folder folder;
  const Reply reply = folder.run("'" + program + "' --parts contact_loss --output results");
  REQUIRE(reply.exit_code == 0);
  const std::string csv = slurp(folder.path / "results/contact_loss.csv");
  CHECK(csv.starts_with("mu,method,derivatives,crank speed [rad/s],error,\"release below, above\",runs,"));
  CHECK(lines(csv) == 7);
  std::size_t found = 0;
  for (std::size_t at = 0; (at = csv.find(",no; yes,", at)) != std::string::npos; ++at) ++found;
  CHECK(found == 6);
  CHECK(reply.out.find("| 0.01 | Newton | yes | 23.70923117964") != std::string::npos);
  CHECK(std::filesystem::exists(folder.path / "results/manifest.json"));
}
