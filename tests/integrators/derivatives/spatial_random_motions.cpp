// Derivatives of random runs in space of one body on a plane, against differences of runs on both sides.
//
// The rules are those of random_motions.cpp: without a warning a derivative must be that of both sides, with one that
// of the side which it names. Bodies fly, roll, slide and spin; they begin above the plane or on it.
#include <doctest/doctest.h>

#include "tests/integrators/derivatives/spatial_trials.h"
#include "tests/support/sanitized.h"
#include "tests/support/scene_draws.h"

#include <algorithm>
#include <array>

using namespace orthant;

namespace {

std::string array_of(std::initializer_list<double> values) {
  std::string text = "[";
  for (const double x : values) text += (text.size() > 1 ? ", " : "") + override_text("", x).substr(1);
  return text + "]";
}

struct SpatialMotion {
  std::string text;
  std::vector<SpatialParameter> parameters;
};

SpatialMotion random_spatial_motion(unsigned seed) {
  SceneDraws dice(seed);
  const std::array<std::string, 6> shapes = {"sphere", "ellipsoid", "box", "cylinder", "cone", "feet"};
  const std::string& shape = shapes[seed % shapes.size()];
  const bool flies = dice.one_in(2), slope = dice.one_in(2);
  const double height = shape == "cylinder" ? 0.12 : 0.1, z = flies ? dice.between(0.25, 0.4) : height;
  const double mu = dice.zero_or(0.05, 0.8), e = dice.zero_or(0.1, 0.7), mass = dice.between(0.5, 2);
  const double e_t = dice.one_in(3) ? dice.between(0.1, 0.4) : 0;
  SpatialMotion motion;
  std::string& text = motion.text;
  text = "dimension = 3\ngravity = " + array_of({slope ? dice.between(-3, 3) : 0, 0, -9.81}) +
         "\n[[body]]\nname = \"b\"\nmass = " + override_text("", mass).substr(1) + "\ninertia = " +
         array_of({dice.between(0.008, 0.01), dice.between(0.008, 0.011), dice.between(0.006, 0.012)}) +
         "\nposition = " + array_of({0, 0, z}) +
         "\nvelocity = " + array_of({dice.zero_or(-2, 2), dice.zero_or(-2, 2), flies ? dice.zero_or(-2, 1) : 0}) + "\n";
  if (flies) text += "orientation = " + array_of({1, dice.between(-0.3, 0.3), dice.between(-0.3, 0.3), 0.1}) + "\n";
  const bool turns = flies || shape == "sphere";
  text +=
      "omega = " + array_of({turns ? dice.between(-6, 6) : 0, turns ? dice.between(-6, 6) : 0, dice.zero_or(-6, 6)}) +
      "\n";
  std::vector<std::pair<std::string, double>> keys = {
      {"body.b.mass", mass}, {"contact.c.mu", mu}, {"contact.c.e_n", e}};
  std::string law = "wall = {normal = [0, 0, 1]}\nmu = " + override_text("", mu).substr(1) +
                    "\ne_n = " + override_text("", e).substr(1) + "\ne_t = " + override_text("", e_t).substr(1) + "\n";
  if (e_t != 0) keys.emplace_back("contact.c.e_t", e_t);
  if (mu > 0 && dice.one_in(3)) {
    law += "rolling = 0.004\nspinning = 0.002\n";
    keys.emplace_back("contact.c.rolling", 0.004), keys.emplace_back("contact.c.spinning", 0.002);
  }
  const auto contact = [&](const std::string& type, const std::string& what, const std::string& name = "c") {
    text += "[[contact]]\nname = \"" + name + "\"\nbody = \"b\"\ntype = \"" + type + "\"\n" + what + law;
  };
  if (shape == "sphere") contact("sphere-wall", "radius = 0.1\n"), keys.emplace_back("contact.c.radius", 0.1);
  if (shape == "ellipsoid") contact("ellipsoid-wall", "semi_axes = [0.12, 0.08, 0.1]\n");
  if (shape == "box") contact("box-wall", "size = [0.3, 0.24, 0.2]\n");
  if (shape == "cylinder")
    contact("cylinder-wall", "radius = 0.1\nheight = 0.24\n"), keys.emplace_back("contact.c.radius", 0.1);
  if (shape == "cone") contact("cone-wall", "radius = 0.1\nheight = 0.4\ncentre = [0, 0, -0.1]\n");
  if (shape == "feet") {
    contact("corner-wall", "point = [0.15, 0, -0.1]\n");
    contact("corner-wall", "point = [-0.1, 0.12, -0.1]\n", "d");
    contact("corner-wall", "point = [-0.1, -0.12, -0.1]\n", "e");
  }
  for (const auto& [key, value] : keys) motion.parameters.push_back(by_key(text, key, value));
  const spatial::Scene base = spatial_from_text(text);
  for (Index entry = 0; entry < 12; ++entry) motion.parameters.push_back(by_start(base, entry));
  return motion;
}

/// A body that hangs with clearance in the ground: in a socket, a bush, a channel, or on a ball.
SpatialMotion random_hanging_body(unsigned seed) {
  SceneDraws dice(seed);
  const double clearance = std::array{1e-2, 1e-3, 1e-4, 1e-5}[(seed / 5) % 4];
  const double mu = dice.zero_or(0.05, 0.8), e = dice.zero_or(0.1, 0.7);
  const std::string law =
      "mu = " + override_text("", mu).substr(1) + "\ne_n = " + override_text("", e).substr(1) + "\n";
  const std::string radii = "radius_a = 0.05\nradius_b = " + override_text("", 0.05 + clearance).substr(1) + "\n";
  const std::array<std::string, 5> kinds = {
      "type = \"socket\"\ncentre_a = [0, 0, 0.2]\n" + radii,
      "type = \"sphere-bush\"\ncentre_a = [0, 0, 0.2]\naxis_b = [0, 1, 0]\n" + radii,
      "type = \"pin-bush\"\ncentre_a = [0, 0, 0.2]\naxis = [0, 1, 0]\naxis_b = [0, 1, 0]\nlength_a = 0.1\n" + radii,
      "type = \"block-channel\"\ncentre_a = [0, 0, 0.2]\nsize = [0.2, 0.1, 0.1]\naxis = [1, 0, 0]\nup = [0, 0, "
      "1]\nwidth = " +
          override_text("", 0.1 + 2 * clearance).substr(1) +
          "\nheight = " + override_text("", 0.1 + 2 * clearance).substr(1) + "\n",
      "type = \"sphere-sphere\"\ncentre_a = [0, 0, 0.2]\ncentre_b = [0, 0, -0.08]\nradius_a = 0.05\nradius_b = " +
          override_text("", 0.03 - clearance).substr(1) + "\n"};
  SpatialMotion motion;
  motion.text = "dimension = 3\ngravity = " + array_of({dice.between(-3, 3), dice.between(-3, 3), -9.81}) +
                "\n[[body]]\nname = \"b\"\nmass = 1\ninertia = [0.02, 0.021, 0.005]\nposition = " +
                array_of({0.3 * clearance, -0.1 * clearance, 0.2 * clearance - 0.2}) +
                "\nomega = " + array_of({dice.zero_or(-1, 1), dice.zero_or(-1, 1), dice.zero_or(-1, 1)}) +
                "\n[[contact]]\nname = \"c\"\nbodies = [\"b\", \"ground\"]\n" + kinds[seed % 5] + law;
  for (const auto& [key, value] :
       {std::pair<std::string, double>{"body.b.mass", 1}, {"contact.c.mu", mu}, {"contact.c.e_n", e}})
    motion.parameters.push_back(by_key(motion.text, key, value));
  if (seed % 5 < 3) motion.parameters.push_back(by_key(motion.text, "contact.c.radius_b", 0.05 + clearance));
  if (seed % 5 < 3)
    motion.parameters.push_back(by_change(motion.text, "centre_b.z", 0, [](spatial::Scene& s, double x) {
      for (auto& contact : s.contacts)
        std::visit(
            [x](auto& c) {
              if constexpr (requires { c.centre_b; }) c.centre_b.z() = x;
            },
            contact);
    }));
  const spatial::Scene base = spatial_from_text(motion.text);
  for (Index entry = 0; entry < 12; ++entry) motion.parameters.push_back(by_start(base, entry));
  return motion;
}

constexpr Clock kClock{.step = 1e-3, .duration = 0.2, .every = 1000000};

/// All columns at the end; empty: the run does not get there.
Eigen::VectorXd spatial_end(const spatial::Scene& scene, Solver& solver) {
  const SystemOf<Spatial> system(scene);
  MoreauJeanOf<Spatial> integrator(system, MoreauJeanOptions{});
  const Run run = simulate(integrator, solver, kClock);
  if (run.status != Status::solved) return {};
  const std::vector<RunColumn> columns = state_columns(system);
  ColumnSlopesOf<Spatial> values(system, columns);
  Eigen::VectorXd end(std::ssize(columns));
  for (std::size_t i = 0; i < columns.size(); ++i) end[static_cast<Index>(i)] = values.value(i, run.final);
  return end;
}

/// Fixed steps may keep their contacts on a short way only.
bool is_of_spatial_side(const SpatialParameter& parameter, Solver& solver, int side, const Eigen::VectorXd& exact,
                        double& off) {
  off = kInf;
  const Eigen::VectorXd here = spatial_end(parameter.scene(parameter.value), solver);
  for (const double h : {1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10}) {
    std::array<Eigen::VectorXd, 2> there;
    try {
      for (const int k : {1, 2})
        there[static_cast<std::size_t>(k - 1)] = spatial_end(parameter.scene(parameter.value + side * k * h), solver);
    } catch (const std::invalid_argument&) {
      return true;  // out of its range
    }
    if (here.size() == 0 || there[0].size() == 0 || there[1].size() == 0) continue;
    const Eigen::VectorXd difference = side * (4 * there[0] - 3 * here - there[1]) / (2 * h);
    const double scale = std::max({difference.lpNorm<Eigen::Infinity>(), exact.lpNorm<Eigen::Infinity>(), 1e-2});
    off = std::min(off, (difference - exact).lpNorm<Eigen::Infinity>() / scale);
    if (off < 2e-3) return true;
  }
  return false;
}

void check_sides(unsigned seeds, SpatialMotion (*motion_of)(unsigned)) {
  const auto solver = make_solver("auto");
  int both = 0, one = 0, shared = 0, refused = 0;
  for (unsigned seed = 0; seed < seeds; ++seed) {
    CAPTURE(seed);
    const SpatialMotion motion = motion_of(seed);
    for (const SpatialParameter& parameter : motion.parameters) {
      CAPTURE(parameter.name);
      const SystemOf<Spatial> system(spatial_from_text(motion.text));
      SpatialParameter asked = parameter;
      if (asked.start >= 0) asked.scene = {};
      Eigen::VectorXd by;
      RunTangent tangent;
      try {
        tangent = differentiate_run(system, {asked}, MoreauJeanOptions{}, *solver, kClock, state_columns(system),
                                    [&](double, const Eigen::VectorXd&, const Eigen::MatrixXd& x) { by = x.col(0); });
      } catch (const std::invalid_argument&) {
        ++refused;
        continue;
      } catch (const std::runtime_error&) {
        ++refused;
        continue;
      }
      if (!tangent.degenerate.empty() || tangent.inconsistent > 0 || tangent.run.status != Status::solved) {
        ++refused;
        continue;
      }
      double off_larger = 0, off_smaller = 0;
      const bool larger = is_of_spatial_side(parameter, *solver, 1, by, off_larger);
      const bool smaller = is_of_spatial_side(parameter, *solver, -1, by, off_smaller);
      CAPTURE(off_larger);
      CAPTURE(off_smaller);
      const auto of_shares = [](const std::string& w) { return w.find("depend on the shares") != std::string::npos; };
      if (std::ranges::any_of(tangent.warnings, of_shares)) {
        ++shared;  // the solver's choice for other data may differ
        continue;
      }
      check_side(tangent.warnings, larger, smaller);
      ++(tangent.warnings.empty() ? both : one);
    }
  }
  MESSAGE("of both sides " << both << ", with a warning " << one << ", shared " << shared << ", none " << refused);
  CHECK(both > refused);
}

}  // namespace

TEST_CASE("derivatives of random runs in space are those of both sides, or of the one that is named, or are refused") {
  check_sides(kSanitized ? 6 : 48, random_spatial_motion);
}

TEST_CASE("derivatives of random runs of bodies that hang with clearance are those of both sides, or are refused") {
  check_sides(kSanitized ? 5 : 40, random_hanging_body);
}
