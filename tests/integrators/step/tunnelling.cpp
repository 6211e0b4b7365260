// Steps that are too long for what moves: bodies through each other, thrown out of each other, or one inside the other.
#include "tests/support/runs.h"

#include <doctest/doctest.h>

using namespace orthant;

namespace {

constexpr const char* kPassing[] = {"moreau-jean",     "stewart-trinkle",   "anitescu-potra",
                                    "paoli-schatzman", "generalized-alpha", "rattle"};

/// A disc flies at a triangle, `aside` of its middle.
Scene shot(double speed, double aside, const ContactLaw& law = {}) {
  Scene s{.duration = 10 / speed};
  const auto disc = s.body({.name = "disc", .inertia = 0.01, .position = {-5, 0}, .velocity = {speed, 0}}),
             target = s.body({.name = "target", .inertia = 0.01, .position = {0, aside}});
  s.collision({"all", {{disc, {0, 0}, 0.1, {}}, {target, {0, 0}, 1, {{-0.5, -0.5}, {0.5, -0.5}, {0, 0.5}}}}, law, 6});
  return s;
}

}  // namespace

TEST_CASE("bodies that pass through each other within a step are told, with figures; those that pass by are not") {
  for (const std::string scheme : kPassing) {
    CAPTURE(scheme);
    for (const bool listed : {false, true}) {
      const auto shoot = [&](double aside, double h) {
        const Scene s = shot(100, aside);
        return run(listed ? with_pairs_listed(s) : s, scheme, h);
      };
      const Run through = shoot(0.1, 0.03);  // 3 m a step: from x = −2 to 1
      CHECK(through.status == Status::solved);
      CHECK(through.final.v[0] == 100);
      CHECK(through.passages == 1);
      CHECK(through.first_passage.body == 0);
      CHECK(through.first_passage.other == 1);
      CHECK(through.first_passage.moved == doctest::Approx(3).epsilon(1e-12));
      CHECK(through.first_passage.width == doctest::Approx(0.2).epsilon(1e-12));
      CHECK(through.first_passage_time == doctest::Approx(0.06).epsilon(1e-12));
      CHECK(shoot(0.65, 0.03).passages == 0);   // goes by below
      CHECK(shoot(-0.65, 0.03).passages == 0);  // and above
      const Run hit = shoot(0.1, 1e-4);
      CHECK(hit.passages == 0);
      CHECK(hit.final.v[0] < 90);
    }
  }
}

TEST_CASE("energy that a scheme makes where bodies come deep into each other in one step is told") {
  const auto made = [](const Run& r) { return r.energy_final - r.energy_initial; };
  int raised = 0;
  for (const std::string scheme : kPassing)
    for (const double speed : {20.0, 30.0, 45.0})
      for (const double aside : {-0.3, -0.1, 0.1, 0.3}) {
        CAPTURE(scheme);
        CAPTURE(speed);
        CAPTURE(aside);
        const Run coarse = run(shot(speed, aside, {.e = 1}), scheme, 1e-2);
        if (made(coarse) > 1e-2 * coarse.energy_initial) {
          ++raised;
          CHECK(coarse.energy_rises > 0);
          CHECK(coarse.max_energy_rise > 0.5 * made(coarse));
        }
        const Run fine = run(shot(speed, aside, {.e = 1}), scheme, 1e-4);
        CHECK(fine.max_energy_rise < 0.05 * fine.energy_initial);
        CHECK(std::abs(made(fine)) < 0.05 * fine.energy_initial);
      }
  CHECK(raised > 0);
}

TEST_CASE("discs with their centres in one place have no normal: an error that names them, no answer") {
  for (const std::string scheme : kPassing) {
    CAPTURE(scheme);
    Scene s{.gravity = {0, -9.81}};
    const auto a = s.body({.name = "a"}), b = s.body({.name = "b"});
    s.collision({"pair", {{a, {0, 0}, 0.1, {}}, {b, {0, 0}, 0.1, {}}}, {}, 6});
    const Run r = run(s, scheme, 1e-3);
    CHECK(r.status == Status::numerical_error);
    CHECK(r.why ==
          "contact of collision \"pair\" between \"a\" and \"b\" has no normal: its centres, or points, are in one "
          "place");
    CHECK(r.steps == 0);
    CHECK(run(with_pairs_listed(s), scheme, 1e-3).why.starts_with("contact \"pair_1\" has no normal"));
  }
}
