// Joints and contacts from outside: the same motion as the built-in ones; wrong derivatives are told.
#include <orthant/core/mechanics/scene/derivatives.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/core/scenes/slider_crank.h>
#include <orthant/integrators/registry.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>
#include <cmath>

using namespace orthant;

namespace {

/// A pin as somebody else would write it, by components and a small error where one is asked for.
struct Pin {
  static constexpr int kRows = 2;
  enum Wrong { nothing, sign, lever, bias_part, stranger };
  std::string name;
  BodyId a, b;
  Vector2d p, q;  // [m] in the bodies' frames
  Wrong wrong = nothing;

  static std::array<double, 2> arm(const Pose& pose, const Vector2d& r) {
    return {std::cos(pose.theta) * r.x() - std::sin(pose.theta) * r.y(),
            std::sin(pose.theta) * r.x() + std::cos(pose.theta) * r.y()};
  }
  void residual(const Kinematics& k, double* phi) const {
    const auto r = arm(k.at(a), p), s = arm(k.at(b), q);
    for (int i = 0; i < 2; ++i)
      phi[i] = k.at(a).x[i] + r[static_cast<std::size_t>(i)] - k.at(b).x[i] - s[static_cast<std::size_t>(i)];
  }
  void rows(const Kinematics& k, Row* G) const {
    const auto r = arm(k.at(a), p), s = arm(k.at(b), q);
    G[0] = {a, b, {1, 0, wrong == lever ? -2 * r[1] : -r[1]}, {-1, 0, s[1]}};
    G[1] = {a, wrong == stranger ? 2 : b, {0, 1, r[0]}, {0, wrong == sign ? 1.0 : -1.0, -s[0]}};
  }
  void bias(const Kinematics& k, double* out) const {
    const auto r = arm(k.at(a), p), s = arm(k.at(b), q);
    const double u = k.rate(a).omega * k.rate(a).omega, w = wrong == bias_part ? 0 : k.rate(b).omega * k.rate(b).omega;
    for (std::size_t i = 0; i < 2; ++i) out[i] = w * s[i] - u * r[i];
  }
};

struct Floor {  // a corner above the ground's x axis, with friction
  std::string name;
  BodyId a, b = kGround;
  ContactLaw law;
  Vector2d corner;
  bool wrong = false;

  double gap(const Kinematics& k) const { return k.at(a).x.y() + k.at(a).turn(corner).y(); }
  ContactRows rows(const Kinematics& k) const {
    const Vector2d r = k.at(a).turn(corner);
    return {{a, b, {0, 1, r.x()}, {}}, {a, b, {1, 0, -r.y()}, {}}};
  }
  ContactBias bias(const Kinematics& k) const {
    const Vector2d r = k.at(a).turn(corner);
    const double w = k.rate(a).omega;
    return {-w * w * r.y(), wrong ? 0 : -w * w * r.x()};
  }
};

Run run(const Scene& scene, const char* integrator) {
  const System system(scene);
  return simulate(*make_integrator(integrator, system), *make_solver("lemke"), {.step = 1e-4, .duration = 0.02});
}

/// The headline scene with its pins written from outside; the one of crank and rod with an error.
Scene with_pins(Pin::Wrong wrong) {
  Scene scene = slider_crank({.mu = 0.1, .e = 0.4});
  for (std::size_t i = 0; i < scene.joints.size(); ++i) {
    const Revolute pin = std::get<Revolute>(scene.joints[i]);
    scene.joints[i] = Pin{pin.name, pin.a, pin.b, pin.point_a, pin.point_b, i == 1 ? wrong : Pin::nothing};
  }
  return scene;
}

Scene dropped_box(bool outside, bool wrong = false) {
  Scene scene;
  scene.gravity = {0, -9.81};
  const BodyId box =
      scene.body({.name = "box", .mass = 1, .inertia = 0.02, .position = {0, 0.15}, .angle = 0.2, .velocity = {1, -1}});
  for (const double x : {-0.2, 0.2}) {
    const std::string name = x < 0 ? "left" : "right";
    const ContactLaw law{.mu = 0.3, .e = 0.5};
    if (outside)
      scene.contact(Floor{name, box, kGround, law, {x, -0.1}, wrong});
    else
      scene.contact(CornerWall{.name = name, .a = box, .point = {x, -0.1}, .law = law});
  }
  return scene;
}

std::string words_of(const Scene& scene) {
  try {
    check(scene);
  } catch (const SceneError& error) {
    return error.what();
  }
  return {};
}

bool says(const std::string& words, std::string_view part) { return words.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("pins written from outside move the slider-crank as the built-in ones do") {
  for (const char* integrator : {"moreau-jean", "adaptive", "event-driven"}) {
    CAPTURE(integrator);
    const Run ours = run(slider_crank({.mu = 0.1, .e = 0.4}), integrator),
              theirs = run(with_pins(Pin::nothing), integrator);
    CHECK(theirs.status == Status::solved);
    CHECK((ours.final.q - theirs.final.q).lpNorm<Eigen::Infinity>() < 1e-10);
  }
}

TEST_CASE("a floor written from outside, with friction and impacts, is a floor") {
  for (const char* integrator : {"moreau-jean", "stewart-trinkle", "adaptive", "event-driven"}) {
    CAPTURE(integrator);
    const Run ours = run(dropped_box(false), integrator), theirs = run(dropped_box(true), integrator);
    CHECK(ours.final.v.y() > -1);  // it did strike
    CHECK(theirs.status == Status::solved);
    CHECK((ours.final.q - theirs.final.q).lpNorm<Eigen::Infinity>() < 1e-10);
  }
}

TEST_CASE("a built-in element handed over as one from outside moves to the same bits, driven in time, too") {
  Scene scene = slider_crank({.mu = 0.1});
  scene.joint(Drive{"motor", Angle{kGround, 0}, {.offset = 0, .rate_of_change = 150, .amplitude = 0.1, .omega = 40}});
  const auto outside = [](Scene s) {
    for (Joint& j : s.joints) j = std::visit([](const auto& x) { return CustomJoint(x); }, j);
    for (Contact& c : s.contacts) c = std::visit([](const auto& x) { return CustomContact(x); }, c);
    return s;
  };
  for (const char* integrator : {"moreau-jean", "rattle", "generalized-alpha"}) {
    CAPTURE(integrator);
    const Run ours = run(scene, integrator), theirs = run(outside(scene), integrator);
    CHECK(ours.status == Status::solved);
    CHECK(ours.final.q == theirs.final.q);
    CHECK(ours.final.v == theirs.final.v);
  }
}

TEST_CASE("an error about wrong derivatives names element, row and both values") {
  CHECK(words_of(with_pins(Pin::nothing)).empty());
  CHECK(says(words_of(with_pins(Pin::sign)), "rows[1] by the y of body 1 is 1: differences of residual give -1"));
  CHECK(says(words_of(with_pins(Pin::lever)), "rows[0] by the angle of body 0"));
  CHECK(says(words_of(with_pins(Pin::bias_part)), "bias of rows[0]"));
  CHECK(says(words_of(with_pins(Pin::stranger)), "rows[1] acts on body 2: must act on the two bodies of its own"));
  CHECK(words_of(dropped_box(true)).empty());
  CHECK(says(words_of(dropped_box(true, true)), "contact \"left\": bias of rows.tangent is 0"));

  struct Late : Drive {  // ṡ of another function
    void rate(const Kinematics& /*k*/, double* wanted) const { wanted[0] = 3; }
  };
  Scene scene = slider_crank();
  scene.joint(Late{Drive{"motor", Angle{kGround, 0}, {.offset = 0, .rate_of_change = 5}}});
  CHECK(says(words_of(scene), "joint \"motor\": rate[0] is 3: differences of residual in time give 5"));
}

TEST_CASE("rows of all built-in joints and contacts are the derivatives they stand for") {
  int looked_at = 0;
  for (const auto& entry : scenes()) {
    const Scene scene = make_scene(entry.name);
    const System system(scene);
    Kinematics k;
    set_poses(system, 0.3, system.initial_state().q, k);
    k.pose.back() = {};
    for (const Joint& j : scene.joints) {
      INFO(entry.name, wrong_derivative(j, k));
      CHECK(wrong_derivative(j, k).empty());
      ++looked_at;
    }
    for (const Contact& c : scene.contacts) {
      INFO(entry.name, wrong_derivative(c, k));
      CHECK(wrong_derivative(c, k).empty());
      ++looked_at;
    }
  }
  CHECK(looked_at > 50);
}
