// Continuous collision detection: no contact is overlooked, whatever its kind, the motion and the output step.
#include <orthant/core/support/random.h>
#include "tests/support/runs.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <functional>

using namespace orthant;

namespace {

constexpr double kHalfTurn = 3.141592653589793;

/// A motion whose exact course is known: flies and turns, turns about a pin fixed in the ground, or swings on a spring.
struct Course {
  enum Kind { flies, pinned, swings, rests } kind = flies;
  Vector2d x{0, 0}, v{0, 0};  // at t = 0; x of `pinned`: the pin, of `swings`: the middle
  double angle = 0, omega = 0;
  Vector2d arm{0, 0};     // [m] of `pinned`: from the pin to the centre, in the body's frame
  Vector2d weight{0, 0};  // [m/s²] of `flies`
  double rate = 0;        // [rad/s] of `swings`

  Pose at(double t) const {
    Pose p;
    p.theta = angle + omega * t, p.c = std::cos(p.theta), p.s = std::sin(p.theta);
    if (kind == flies) p.x = x + t * v + t * t / 2 * weight;
    if (kind == pinned) p.x = x + p.turn(arm);
    if (kind == swings) p.x = x + std::sin(rate * t) / rate * v;
    if (kind == rests) p.theta = 0, p.c = 1, p.s = 0;
    return p;
  }
};

struct Encounter {
  Scene scene;
  Course a, b;                                            // of body 0 and the ground or body 1
  std::function<double(const Pose&, const Pose&)> depth;  // [m] > 0: they overlap by so much
  double size = 1;                                        // [m]
  std::string kind;
};

double distance_to_side(const Vector2d& p, const Vector2d& from, const Vector2d& to) {
  const Vector2d along = to - from;
  const double x = std::clamp((p - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (p - from - x * along).norm();
}
std::vector<Vector2d> placed(const Polygon& corners, const Pose& pose) {
  std::vector<Vector2d> at;
  for (const Vector2d& corner : corners) at.push_back(pose.x + pose.turn(corner));
  return at;
}
/// How deep p is inside; < 0: outside, by its distance.
double depth_in(const std::vector<Vector2d>& corners, const Vector2d& p) {
  double least = kInf, inside = kInf;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector2d &from = corners[i], &to = corners[(i + 1) % corners.size()];
    inside = std::min(inside, cross((to - from).normalized(), p - from));
    least = std::min(least, distance_to_side(p, from, to));
  }
  return inside >= 0 ? inside : -least;
}
/// The shortest way out of each other of two convex polygons, along a face's normal; < 0: they are apart.
double depth_of(const std::vector<Vector2d>& x, const std::vector<Vector2d>& y) {
  double least = kInf;
  for (const auto& [one, other] : {std::pair{&x, &y}, std::pair{&y, &x}})
    for (std::size_t i = 0; i < one->size(); ++i) {
      const Vector2d along = ((*one)[(i + 1) % one->size()] - (*one)[i]).normalized();
      double deepest = -kInf;
      for (const Vector2d& corner : *other) deepest = std::max(deepest, cross(along, corner - (*one)[i]));
      least = std::min(least, deepest);
    }
  return least;
}

class Dice {
 public:
  explicit Dice(unsigned seed) : random_(seed) {}
  double in(double low, double high) { return random_.uniform(low, high); }
  double log(double low, double high) { return std::exp(in(std::log(low), std::log(high))); }
  int below(int n) { return random_.integer(0, n - 1); }
  double sign() { return below(2) ? 1 : -1; }
  Vector2d within(double radius) { return radius * std::sqrt(in(0, 1)) * towards(in(-kHalfTurn, kHalfTurn)); }
  static Vector2d towards(double angle) { return {std::cos(angle), std::sin(angle)}; }
  /// Its corners lie on an ellipse.
  Polygon polygon(double size) {
    const int n = 3 + below(4);
    const double flat = log(0.2, 1), from = in(-kHalfTurn, kHalfTurn);
    Polygon corners;
    for (int i = 0; i < n; ++i) {
      const Vector2d p = towards(from + 2 * kHalfTurn * (i + in(-0.3, 0.3)) / n);
      corners.push_back(size * Vector2d(p.x(), flat * p.y()));
    }
    return corners;
  }

 private:
  Random random_;
};

/// Custom contact: two discs, whose distance is all that is known of them.
struct Pegs {
  DiscDisc discs;
  std::string name = "pegs";
  BodyId a = discs.a, b = discs.b;
  ContactLaw law = discs.law;
  double gap(const Kinematics& k) const { return discs.gap(k); }
  ContactRows rows(const Kinematics& k) const { return discs.rows(k); }
  ContactBias bias(const Kinematics& k) const { return discs.bias(k); }
  double length() const { return discs.radius_a + discs.radius_b; }
};

constexpr std::array kKinds = {"corner-wall",     "disc-wall",    "disc-disc", "disc-polygon",
                               "polygon-polygon", "polygon-wall", "journal",   "angle",
                               "slide",           "shortest",     "longest",   "custom"};

Course random_course(Dice& r, bool weight) {
  Course c;
  constexpr std::array kCourses = {Course::flies, Course::flies, Course::pinned, Course::swings};
  c.kind = kCourses[static_cast<std::size_t>(r.below(4))];
  if (weight && c.kind != Course::flies) c.kind = Course::flies;
  if (weight) c.weight = {0, -9.81};
  c.v = r.log(0.05, 50) * Dice::towards(r.in(-kHalfTurn, kHalfTurn));
  c.angle = r.in(-kHalfTurn, kHalfTurn), c.omega = r.sign() * r.log(0.1, 1000);
  if (c.kind == Course::pinned) c.arm = r.within(0.5);
  if (c.kind == Course::swings) c.rate = r.log(1, 30);
  return c;
}

BodyId add_body(Scene& s, const Course& c) {
  const Pose start = c.at(0);
  Body body{.mass = 1, .inertia = 0.2, .position = start.x, .angle = c.angle, .velocity = c.v, .omega = c.omega};
  if (c.kind == Course::pinned) body.velocity = c.omega * perp(start.turn(c.arm));
  const BodyId id = s.body(body);
  if (c.kind == Course::pinned) s.joint(Revolute{{}, kGround, id, c.x, -c.arm});
  if (c.kind == Course::swings) s.spring(PointSpring{{}, id, kGround, {0, 0}, c.x, c.rate * c.rate, 0, 0});
  return id;
}

/// The places and sizes that both shapes of a case have in common.
struct Meeting {
  BodyId a, b;
  Vector2d off_a, off_b;  // [m] centre or point of the shape on its body
  double size, other;     // [m] of a's shape and of b's
  double meet;            // [s] when they come near each other
};

double between_centres(const Meeting& of, const Pose& p, const Pose& q) {
  return (p.x + p.turn(of.off_a) - q.x - q.turn(of.off_b)).norm();
}

Polygon moved_by(Polygon polygon, const Vector2d& by) {
  for (Vector2d& corner : polygon) corner += by;
  return polygon;
}

/// Discs, corners, polygons and journals: the contact, and its depth by formulas that share nothing with it.
void add_shapes(Encounter& k, const Meeting& of, const Vector2d& normal, const Polygon& one, const Polygon& two) {
  const auto& [a, b, off_a, off_b, size, other, meet] = of;
  const double both = size + other;
  const ContactLaw law{.e = 0.5};
  const auto wall = [of, normal](const Vector2d& point, double radius) {
    return [=](const Pose& p, const Pose& q) {
      return radius - q.turn(normal).dot(p.x + p.turn(point) - q.x - q.turn(of.off_b));
    };
  };
  Scene& s = k.scene;
  if (k.kind == "corner-wall") {
    s.contact(CornerWall{{}, a, off_a, b, off_b, normal, law}), k.depth = wall(off_a, 0);
  } else if (k.kind == "disc-wall") {
    s.contact(DiscWall{{}, a, off_a, size, b, off_b, normal, law}), k.depth = wall(off_a, size);
  } else if (k.kind == "disc-disc" || k.kind == "custom") {
    const DiscDisc discs{"pegs", a, off_a, size, b, off_b, other, law};
    if (k.kind == "custom")
      s.contact(Pegs{discs});
    else
      s.contact(discs);
    k.depth = [=](const Pose& p, const Pose& q) { return both - between_centres(of, p, q); };
  } else if (k.kind == "disc-polygon") {
    s.contact(DiscPolygon{{}, a, off_a, size, b, two, law});
    k.depth = [=](const Pose& p, const Pose& q) { return of.size + depth_in(placed(two, q), p.x + p.turn(of.off_a)); };
  } else if (k.kind == "polygon-polygon") {
    for (const int point : {0, 1}) s.contact(PolygonPolygon{{}, a, one, b, two, point, law});
    k.depth = [=](const Pose& p, const Pose& q) { return depth_of(placed(one, p), placed(two, q)); };
  } else if (k.kind == "polygon-wall") {
    for (const Vector2d& corner : one) s.contact(CornerWall{{}, a, corner, b, off_b, normal, law});
    k.depth = [=](const Pose& p, const Pose& q) {
      double most = -kInf;
      for (const Vector2d& corner : one) most = std::max(most, wall(corner, 0)(p, q));
      return most;
    };
  } else {
    s.contact(Journal{{}, a, off_a, other, b, off_b, both, law});
    k.depth = [=](const Pose& p, const Pose& q) { return between_centres(of, p, q) - of.size; };
  }
}

/// A bound of an angle, a slide or a distance, near its value when the bodies meet.
void add_limit(Encounter& k, const Meeting& of, const Vector2d& normal, Dice& r) {
  const auto& [a, b, off_a, off_b, size, other, meet] = of;
  Coordinate coordinate;
  std::function<double(const Pose&, const Pose&)> value;
  if (k.kind == "angle") {
    coordinate = Angle{a, b}, value = [](const Pose& p, const Pose& q) { return q.theta - p.theta; };
  } else if (k.kind == "slide") {
    coordinate = Slide{a, b, off_a, off_b, normal};
    value = [=](const Pose& p, const Pose& q) {
      return p.turn(normal).dot(q.x + q.turn(of.off_b) - p.x - p.turn(of.off_a));
    };
  } else {
    coordinate = Span{a, b, off_a, off_b};
    value = [of](const Pose& p, const Pose& q) { return between_centres(of, p, q); };
  }
  const bool lower = k.kind == "shortest" || (k.kind != "longest" && r.below(2));
  double bound = value(k.a.at(meet), k.b.at(meet)) + r.in(-1, 1) * size;
  if (k.kind == "shortest") bound = size + other;
  k.scene.contact(Limit{{}, coordinate, lower ? Limit::Side::lower : Limit::Side::upper, bound, {.e = 0.5}});
  k.depth = [=](const Pose& p, const Pose& q) { return (lower ? 1 : -1) * (bound - value(p, q)); };
}

/// Two shapes that come near each other some time; they are apart at the start.
Encounter random_case(unsigned seed) {
  Dice r(seed);
  for (;;) {
    Encounter k;
    k.kind = kKinds[static_cast<std::size_t>(r.below(kKinds.size()))];
    const bool weight = r.below(4) == 0, ground = r.below(3) == 0 && k.kind != "angle";
    k.a = random_course(r, weight), k.b = random_course(r, weight);
    if (ground) k.b = {.kind = Course::rests};
    if (weight) k.scene.gravity = {0, -9.81};
    k.scene.duration = std::min(2.0, 200 / std::max(std::abs(k.a.omega), std::abs(k.b.omega)));
    Meeting of{};
    of.size = k.size = r.log(0.005, 0.3), of.other = of.size * r.log(0.2, 5);
    of.meet = k.kind == "journal" ? 0 : r.in(0.05, 1) * k.scene.duration;
    of.off_a = r.below(3) ? r.within(0.5) : Vector2d(0, 0);
    of.off_b = r.below(3) ? r.within(0.5) : Vector2d(0, 0);
    // b is moved to where a passes.
    Vector2d aside = r.within(1.1 * (of.size + of.other));
    if (k.kind == "journal") aside = r.within(0.9 * of.size);
    const auto place = [&](const Course& c, const Vector2d& off) -> Vector2d {
      return c.at(of.meet).x + c.at(of.meet).turn(off);
    };
    (ground ? of.off_b : k.b.x) += place(k.a, of.off_a) + aside - place(k.b, of.off_b);
    of.a = add_body(k.scene, k.a), of.b = ground ? kGround : add_body(k.scene, k.b);
    const Vector2d normal = Dice::towards(r.in(-kHalfTurn, kHalfTurn));
    const Polygon one = moved_by(r.polygon(of.size), of.off_a), two = moved_by(r.polygon(of.other), of.off_b);
    if (k.kind == "angle" || k.kind == "slide" || k.kind == "shortest" || k.kind == "longest")
      add_limit(k, of, normal, r);
    else
      add_shapes(k, of, normal, one, two);
    if (k.depth(k.a.at(0), k.b.at(0)) < -0.01 * k.size) return k;
  }
}

/// When the depth is first more than `deep`, by small steps: as long as a bound of the speeds allows while the shapes
/// are apart, and 1/500 of what the bound says of the size. Infinite: never.
double first_overlap(const Encounter& k, double deep) {
  const auto speed = [&](const Course& c) {
    return c.v.norm() + 9.81 * k.scene.duration + std::abs(c.omega) * (c.arm.norm() + 1.5);
  };
  double far = 0;  // from a body's centre, of a wall or axis in the other
  for (int i = 0; i <= 20; ++i) {
    const double t = k.scene.duration * i / 20;
    far = std::max(far, (k.a.at(t).x - k.b.at(t).x).norm());
  }
  const bool plane = k.kind == "corner-wall" || k.kind == "disc-wall" || k.kind == "polygon-wall" || k.kind == "slide";
  double fast = speed(k.a) + speed(k.b) + std::abs(k.a.omega) + std::abs(k.b.omega);
  if (plane) fast += 2 * (std::abs(k.a.omega) + std::abs(k.b.omega)) * (far + 1);
  for (double t = 0; t < k.scene.duration;) {
    const double depth = k.depth(k.a.at(t), k.b.at(t));
    if (depth > deep) return t;
    t += std::max(-0.9 * depth, k.size / 500) / fast;
  }
  return kInf;
}

/// The time of the first event, or infinity; `status` of the last step.
double first_event(const Encounter& k, const std::string& scheme, double h, Status& status) {
  const System system(k.scene);
  const auto integrator = make_integrator(scheme, system);
  const auto solver = make_solver("lemke");
  State x = system.initial_state();
  status = Status::solved;
  while (x.t < k.scene.duration * (1 - 1e-9)) {
    status = integrator->step(std::min(h, k.scene.duration - x.t), *solver, x).status;
    if (!integrator->events().empty()) return integrator->events().front().t;
    if (status != Status::solved) break;
  }
  return kInf;
}

int number_of_cases(int usual) {
  const char* wanted = std::getenv("ORTHANT_COLLISION_CASES");  // more of them, by hand
  return wanted ? std::atoi(wanted) : usual;
}

void look_at(const std::string& scheme, double deep, double late) {
  const int cases = number_of_cases(3000);
  int missed = 0, met = 0, early = 0, failed = 0;
  for (int i = 0; i < cases; ++i) {
    const auto seed = static_cast<unsigned>(i);
    const Encounter k = random_case(seed);
    const double h = k.scene.duration / std::array{1.0, 3.3, 20.0, 300.0}[static_cast<std::size_t>(i % 4)];
    const double overlap = first_overlap(k, deep * k.size);
    Status status = Status::solved;
    const double event = first_event(k, scheme, h, status);
    met += overlap < kInf;
    const bool is_missed = event > overlap + late * k.scene.duration && status == Status::solved;
    const bool is_early = event < kInf && k.depth(k.a.at(event), k.b.at(event)) < -1e-2 * k.size;
    failed += status != Status::solved && event == kInf;
    missed += is_missed, early += is_early;
    if (is_missed || is_early || (status != Status::solved && event == kInf))
      MESSAGE("case " << seed << ", " << k.kind << ": overlap at " << overlap << ", event at " << event << ", step "
                      << h << ", status " << static_cast<int>(status));
  }
  MESSAGE(scheme << ": " << cases << " cases, " << met << " with a contact, missed " << missed << ", early " << early
                 << ", failed " << failed);
  CHECK(met > cases / 5);
  CHECK(missed == 0);
  CHECK(early == 0);
  CHECK(failed == 0);
}

}  // namespace

TEST_CASE("event-driven overlooks no contact: random shapes that turn fast, against dense sampling") {
  look_at("event-driven", 1e-5, 0);
}

TEST_CASE("adaptive overlooks no contact: random shapes that turn fast, against dense sampling") {
  look_at("adaptive:rtol=1e-6", 1e-3, 1e-3);
}

TEST_CASE("a disc far out on a fast arm meets a ball at the same time, whatever the output step") {
  Scene s{.duration = 2};
  const BodyId arm = s.body({.inertia = 0.0833333, .omega = 100});
  s.joint(Revolute{{}, kGround, arm, {0, 0}, {0, 0}});
  const BodyId ball = s.body({.mass = 0.01, .inertia = 1e-6, .position = {0.3, -2}, .velocity = {0, 1}});
  for (const double at : {0.45, -0.45, 0.25, -0.25})
    s.contact(DiscDisc{{}, ball, {0, 0}, 0.01, arm, {at, 0}, 0.01, {.e = 0.5}});
  for (const double step : {2.0, 0.5, 0.1, 1e-2, 1e-3}) {
    CAPTURE(step);
    for (const std::string scheme : {"event-driven", "adaptive:rtol=1e-9,atol=1e-12"}) {
      CAPTURE(scheme);
      std::vector<Event> events;
      const auto note = [&](const RunSample& m) { events.insert(events.end(), m.events.begin(), m.events.end()); };
      const Run r = run(s, scheme, step, note);
      CHECK(r.status == Status::solved);
      REQUIRE(events.size() == 1);
      CHECK(std::abs(events[0].t - 1.656090884185062) < (scheme == "event-driven" ? 1e-12 : 1e-8));
    }
  }
}

TEST_CASE("a heavy disc drives a light one against a wall: floor(pi sqrt(M / m)) impacts, never through it") {
  for (const double ratio : {1e4, 1e6, 1e8, 1e10}) {
    Scene s{.duration = 60};
    const BodyId small = s.body({.position = {1, 0}}),
                 big = s.body({.mass = ratio, .inertia = ratio, .position = {2, 0}, .velocity = {-1, 0}});
    s.contact(DiscWall{"wall", small, {0, 0}, 0.1, kGround, {0, 0}, {1, 0}, {.e = 1}});
    s.contact(DiscDisc{"pair", small, {0, 0}, 0.1, big, {0, 0}, 0.15, {.e = 1}});
    for (const std::string scheme : {"event-driven", "adaptive"}) {
      CAPTURE(scheme);
      CAPTURE(ratio);
      const bool exact = scheme == "event-driven";
      if (exact && ratio > 1e8) continue;  // 314159 impacts
      double least = kInf;
      const Run r = run(s, scheme, 1, [&](const RunSample& m) { least = std::min(least, m.gaps.minCoeff()); });
      CHECK(least > -1e-6);
      CHECK(r.passages == 0);
      if (exact) CHECK(r.status == Status::solved);
      if (exact) CHECK(r.events == static_cast<long>(std::floor(kHalfTurn * std::sqrt(ratio))));
      if (r.status == Status::solved) CHECK(std::abs(r.final.v[3] - 1) < (exact ? 1e-9 : 1e-2) + 4 / std::sqrt(ratio));
    }
  }
}
