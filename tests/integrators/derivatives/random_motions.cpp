// Derivatives of random motions of one body on a plane, against differences of runs on both sides of each parameter.
//
// A derivative without a warning must be that of both sides; with one, that of the side that the warning names; or it
// is refused. Starts at rest, on two corners, on slopes, flat landings and moving tables are where sides differ.
#include <doctest/doctest.h>

#include "tests/integrators/derivatives/motion_trials.h"
#include "tests/support/scene_draws.h"

#include <array>

using namespace orthant;

namespace {

struct RandomMotion {
  std::string text;
  std::vector<MotionTrial> keys;
};

std::string text_of(double x) { return override_text("", x).substr(1); }
std::string pair_of(double x, double y) { return "[" + text_of(x) + ", " + text_of(y) + "]"; }

RandomMotion random_motion(unsigned seed) {
  SceneDraws dice(seed);
  const bool flies = dice.one_in(3), ball = dice.one_in(4), table = !flies && dice.one_in(4);
  const double pull = dice.zero_or(-4, 4), y = flies ? dice.between(0.16, 0.4) : 0.15;
  const double vx = dice.zero_or(-2, 2), vy = table ? 1.5 : flies ? dice.zero_or(-2, 1) : 0;
  const double turns = flies ? dice.zero_or(-3, 3) : 0, angle = flies ? dice.zero_or(-0.5, 0.5) : 0;
  const double mu = dice.zero_or(0.05, 0.9), e = dice.zero_or(0, 0.8), mass = dice.between(0.5, 2);
  const double e_t = dice.one_in(3) ? dice.between(0.1, 0.4) : 0;
  RandomMotion motion;
  std::string& text = motion.text;
  text = "gravity = " + pair_of(pull, -9.81) + "\n";
  std::string wall = "wall = {normal = [0, 1]}\n";
  if (table) {
    text +=
        "[[body]]\nname = \"table\"\nmass = 20\ninertia = 1\nvelocity = [0, 1.5]\n[[joint]]\nname = \"column\"\n"
        "type = \"prismatic\"\nbodies = [\"ground\", \"table\"]\naxis = [0, 1]\n[[joint]]\nname = \"shaker\"\n"
        "type = \"drive\"\njoint = \"column\"\namplitude = 0.1\nomega = 15\n";
    wall = "wall = {body = \"table\", normal = [0, 1]}\n";
    motion.keys.push_back({"joint.shaker.omega", "", "", 15});
  }
  text += "[[body]]\nname = \"b\"\nmass = " + text_of(mass) + "\ninertia = " + text_of(dice.between(0.01, 0.05)) +
          "\nposition = " + pair_of(0, y) + "\nvelocity = " + pair_of(vx, vy) + "\nomega = " + text_of(turns) +
          "\nangle = " + text_of(angle) + "\n";
  const std::string law = wall + "mu = " + text_of(mu) + "\ne_n = " + text_of(e) + "\ne_t = " + text_of(e_t) + "\n";
  if (ball) text += "[[contact]]\nname = \"c\"\ntype = \"disc-wall\"\nbody = \"b\"\nradius = 0.15\n" + law;
  const double width = dice.between(0.1, 0.3);
  for (const double x : {-0.2, width})
    if (!ball)
      text += std::string("[[contact]]\nname = \"") + (x < 0 ? "c" : "d") +
              "\"\ntype = \"corner-wall\"\nbody = \"b\"\npoint = " + pair_of(x, -0.15) + "\n" + law;
  if (dice.one_in(2))
    text += "[[load]]\nname = \"push\"\nbody = \"b\"\npoint = " + pair_of(0, dice.zero_or(-0.1, 0.1)) +
            "\nforce = " + pair_of(dice.between(-3, 3), 0) + "\n";
  motion.keys.push_back({"body.b.position", "[0, ", "]", y});
  motion.keys.push_back({"body.b.angle", "", "", angle});
  motion.keys.push_back({"body.b.velocity", "[", ", " + text_of(vy) + "]", vx});
  motion.keys.push_back({"body.b.velocity", "[" + text_of(vx) + ", ", "]", vy});
  motion.keys.push_back({"body.b.omega", "", "", turns});
  motion.keys.push_back({"body.b.mass", "", "", mass});
  motion.keys.push_back({"contact.c.mu", "", "", mu});
  motion.keys.push_back({"contact.c.e_n", "", "", e});
  if (e_t != 0) motion.keys.push_back({"contact.c.e_t", "", "", e_t});
  motion.keys.push_back({"gravity", "[", ", -9.81]", pull});
  return motion;
}

constexpr double kTime = 0.3, kStep = 1e-3;

Scene scene_at(const RandomMotion& motion, const MotionTrial& key, double value) {
  return from_text(motion.text)({set_of(key, value)});
}

/// (q, v) of the body at the end; empty: the run does not get there.
Eigen::VectorXd final_of(const Scene& scene, const std::string& method, Solver& solver) {
  const System system(scene);
  Run run;
  if (method == "event-driven") {
    EventDriven integrator(system);
    run = simulate(integrator, solver, {.step = kTime, .duration = kTime});
  } else {
    run = run_by(system, method == "rattle" ? StepScheme(RattleOptions{}) : StepScheme(MoreauJeanOptions{}), solver,
                 {.step = kStep, .duration = kTime});
  }
  if (run.status != Status::solved) return {};
  Eigen::VectorXd end(6);
  end << run.final.q.tail(3), run.final.v.tail(3);
  return end;
}

struct FoundDerivative {
  Eigen::VectorXd of;  // empty: refused
  std::vector<std::string> warnings;
  bool weak = false;  // steps with weakly active contacts
};

FoundDerivative derivative_of(const RandomMotion& motion, const MotionTrial& key, const std::string& method,
                              Solver& solver) {
  const System system(from_text(motion.text)({}));
  const std::vector<RunParameter> parameters = {
      {key.key, key.value, [&](double x) { return scene_at(motion, key, x); }}};
  FoundDerivative found;
  found.of.resize(6);
  try {
    if (method == "event-driven") {
      const MotionTangent t = differentiate_motion(system, parameters, {}, solver, kTime);
      if (t.status != Status::solved || !t.none.empty()) return {};
      found.of << t.q.col(0).tail(3), t.v.col(0).tail(3);
      found.warnings = t.warnings;
    } else {
      const RunTangent t = differentiate_run(
          system, parameters, method == "rattle" ? StepScheme(RattleOptions{}) : StepScheme(MoreauJeanOptions{}),
          solver, {.step = kStep, .duration = kTime});
      found.of << t.q.col(0).tail(3), t.v.col(0).tail(3);
      found.warnings = t.warnings, found.weak = !t.degenerate.empty() || t.inconsistent > 0;
    }
  } catch (const std::invalid_argument&) {
    return {};
  } catch (const std::runtime_error&) {
    return {};
  }
  return found;
}

bool is_of_side(const RandomMotion& motion, const MotionTrial& key, const std::string& method, Solver& solver, int side,
                const Eigen::VectorXd& exact, double& off) {
  off = kInf;
  const Eigen::VectorXd here = final_of(scene_at(motion, key, key.value), method, solver);
  for (const double h : {1e-5, 1e-6, 3e-7, 1e-7, 1e-8}) {  // fixed steps may keep their contacts on a short way only
    std::array<Eigen::VectorXd, 2> there;
    try {
      for (const int k : {1, 2})
        there[static_cast<std::size_t>(k - 1)] =
            final_of(scene_at(motion, key, key.value + side * k * h), method, solver);
    } catch (const std::invalid_argument&) {
      return true;  // out of its range: there is no such side
    }
    if (here.size() == 0 || there[0].size() == 0 || there[1].size() == 0) continue;
    const Eigen::VectorXd difference = side * (4 * there[0] - 3 * here - there[1]) / (2 * h);
    const double scale = std::max({difference.lpNorm<Eigen::Infinity>(), exact.lpNorm<Eigen::Infinity>(), 1e-2});
    off = std::min(off, (difference - exact).lpNorm<Eigen::Infinity>() / scale);
  }
  return off < 2e-3;
}

}  // namespace

TEST_CASE("derivatives of random motions are those of both sides, or of the one that is named, or are refused") {
  const auto solver = make_solver("auto");
  for (const std::string method : {"event-driven", "rattle", "moreau-jean"}) {
    CAPTURE(method);
    int both = 0, one = 0, refused = 0;
    for (unsigned seed = 0; seed < (method == "event-driven" ? 60u : 20u); ++seed) {
      CAPTURE(seed);
      const RandomMotion motion = random_motion(seed);
      for (const MotionTrial& key : motion.keys) {
        CAPTURE(key.key);
        CAPTURE(key.before);
        const FoundDerivative found = derivative_of(motion, key, method, *solver);
        if (found.of.size() == 0 || found.weak) {
          ++refused;
          continue;
        }
        double off_larger = 0, off_smaller = 0;
        const bool larger = is_of_side(motion, key, method, *solver, 1, found.of, off_larger);
        const bool smaller = is_of_side(motion, key, method, *solver, -1, found.of, off_smaller);
        CAPTURE(off_larger);
        CAPTURE(off_smaller);
        check_side(found.warnings, larger, smaller);
        ++(found.warnings.empty() ? both : one);
      }
    }
    MESSAGE(method << ": of both sides " << both << ", with a warning " << one << ", none " << refused);
    CHECK(both > refused);
  }
}
