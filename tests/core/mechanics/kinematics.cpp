// Joints and contacts: rows and biases against finite differences of what they are derivatives of.
#include <doctest/doctest.h>

#include "tests/support/mechanics.h"

namespace orthant {
namespace {

using testing::central_difference;
using testing::dense;
using testing::Draws;
using testing::mismatch;
using testing::VectorXd;

constexpr double kCentral = 1e-7;  // of a central difference at h = 1e-5, with room
constexpr int kSeeds = 20;

template <class Element> struct Kind {
  std::string name;
  Element (*make)(BodyId a, BodyId b, Draws& random);
};

const Kind<Joint> kJoints[] = {
    {"revolute",
     [](BodyId a, BodyId b, Draws& r) -> Joint {
       return Revolute{"", a, b, r.point(), r.point()};
     }},
    {"prismatic",
     [](BodyId a, BodyId b, Draws& r) -> Joint {
       return Prismatic{"", a, b, r.point(), r.point(), r.direction(), r(-1, 1)};
     }},
    {"fixed", [](BodyId a, BodyId b, Draws& r) -> Joint { return Fixed{"", a, b, r.point(), r.point(), r(-1, 1)}; }},
    {"distance",
     [](BodyId a, BodyId b, Draws& r) -> Joint { return Distance{"", a, b, r.point(), r.point(), r(0.1, 2)}; }},
    {"driven angle",
     [](BodyId a, BodyId b, Draws& r) -> Joint {
       return Drive{"", Angle{a, b}, {.offset = r(-1, 1)}};
     }},
    {"driven slide",
     [](BodyId a, BodyId b, Draws& r) -> Joint {
       return Drive{"", Slide{a, b, r.point(), r.point(), r.direction()}, {.offset = r(-1, 1)}};
     }},
    {"driven distance",
     [](BodyId a, BodyId b, Draws& r) -> Joint {
       return Drive{"", Span{a, b, r.point(), r.point()}, {.offset = r(0.1, 2)}};
     }},
};

/// Between fixed points of both bodies.
const Kind<Contact> kPointContacts[] = {
    {"corner-wall",
     [](BodyId a, BodyId b, Draws& r) -> Contact {
       return CornerWall{"", a, r.point(), b, r.point(), r.direction(), {}};
     }},
    {"disc-wall",
     [](BodyId a, BodyId b, Draws& r) -> Contact {
       return DiscWall{"", a, r.point(), r(0.1, 1), b, r.point(), r.direction(), {}};
     }},
    {"disc-disc",
     [](BodyId a, BodyId b, Draws& r) -> Contact {
       return DiscDisc{"", a, r.point(), r(0.1, 1), b, r.point(), r(0.1, 1), {}};
     }},
    {"journal",
     [](BodyId a, BodyId b, Draws& r) -> Contact {
       return Journal{"", a, r.point(), r(0.1, 1), b, r.point(), r(2, 9), {}};
     }},
};

Polygon random_polygon(Draws& random) {
  const auto n = static_cast<std::size_t>(random(3, 8));
  Polygon corners(n);
  const double radius = random(0.3, 1.5), first = random(0, 1);
  for (std::size_t i = 0; i < n; ++i) {  // on an ellipse, no corner sharper than the others allow
    const double angle =
        (static_cast<double>(i) + first + random(-0.2, 0.2)) * 6.283185307179586 / static_cast<double>(n);
    corners[i] = {radius * std::cos(angle), 0.6 * radius * std::sin(angle)};
  }
  return corners;
}

/// Whose point of contact, or meaning, changes with the pose.
const Kind<Contact> kOtherContacts[] = {
    {"disc-polygon",
     [](BodyId a, BodyId b, Draws& r) -> Contact {
       return DiscPolygon{"", a, r.point(), r(0.1, 1), b, random_polygon(r), {}};
     }},
    {"polygon-polygon, point 0",
     [](BodyId a, BodyId b, Draws& r) -> Contact {
       return PolygonPolygon{"", a, random_polygon(r), b, random_polygon(r), 0, {}};
     }},
    {"polygon-polygon, point 1",
     [](BodyId a, BodyId b, Draws& r) -> Contact {
       return PolygonPolygon{"", a, random_polygon(r), b, random_polygon(r), 1, {}};
     }},
    {"lower limit of an angle",
     [](BodyId a, BodyId b, Draws& r) -> Contact {
       return Limit{"", Angle{a, b}, Limit::Side::lower, r(-1, 1), {}};
     }},
    {"upper limit of a slide",
     [](BodyId a, BodyId b, Draws& r) -> Contact {
       return Limit{"", Slide{a, b, r.point(), r.point(), r.direction()}, Limit::Side::upper, r(-1, 1), {}};
     }},
    {"rope",
     [](BodyId a, BodyId b, Draws& r) -> Contact {
       return Limit{"", Span{a, b, r.point(), r.point()}, Limit::Side::upper, r(0.1, 3), {}};
     }},
};

constexpr std::pair<BodyId, BodyId> kBodyPairs[] = {{0, 1}, {1, 0}, {kGround, 1}, {0, kGround}};

/// Three bodies; the last has no part in anything.
Scene three_bodies() {
  Scene s;
  for (int i = 0; i < 3; ++i) s.body({});
  return s;
}

struct Moving {
  VectorXd q, v, a;
  VectorXd q_at(double t) const { return q + t * v + t * t / 2 * a; }
  VectorXd v_at(double t) const { return v + t * a; }
};

/// Bodies 0 and 1 are well apart, and from the ground's origin: links and discs have a direction.
Moving random_motion(Draws& random) {
  Moving m{random.vector(9), random.vector(9, 3), random.vector(9, 3)};
  m.q[0] += 5, m.q[1] += 4, m.q[3] -= 5, m.q[4] += 3;
  return m;
}

/// The whole plane turns by `angle` about the origin and moves by `shift`.
VectorXd moved(const VectorXd& q, double angle, const Vector2d& shift) {
  VectorXd result = q;
  for (Index i = 0; i < q.size(); i += 3) {
    result.segment<2>(i) = Eigen::Rotation2Dd(angle) * Vector2d(q.segment<2>(i)) + shift;
    result[i + 2] += angle;
  }
  return result;
}

/// Velocity, by finite differences, of the point of body `id` that is at `where` at t = 0.
Vector2d material_velocity(const Moving& m, BodyId id, const Vector2d& where) {
  if (id == kGround) return {0, 0};
  const auto pose = [&](double t) { return Eigen::Vector3d(m.q_at(t).segment<3>(3 * id)); };
  const Vector2d local = Eigen::Rotation2Dd(-pose(0)[2]) * (where - pose(0).head<2>());
  return central_difference(
      [&](double t) -> Vector2d { return pose(t).head<2>() + Eigen::Rotation2Dd(pose(t)[2]) * local; });
}

/// Where a closed contact touches, and its normal from b to a, from the drawing.
struct Meeting {
  BodyId a, b;
  Vector2d point, normal;
};
Vector2d to_world(const VectorXd& q, BodyId id, const Vector2d& p) {
  return id == kGround ? p : Vector2d(q.segment<2>(3 * id) + Eigen::Rotation2Dd(q[3 * id + 2]) * p);
}
Vector2d turned(const VectorXd& q, BodyId id, const Vector2d& p) {
  return id == kGround ? p : Vector2d(Eigen::Rotation2Dd(q[3 * id + 2]) * p);
}
Meeting meeting(const CornerWall& c, const VectorXd& q) {
  return {c.a, c.b, to_world(q, c.a, c.point), turned(q, c.b, c.normal)};
}
Meeting meeting(const DiscWall& c, const VectorXd& q) {
  const Vector2d n = turned(q, c.b, c.normal);
  return {c.a, c.b, to_world(q, c.a, c.centre) - c.radius * n, n};
}
Meeting meeting(const Journal& c, const VectorXd& q) {
  const Vector2d from = to_world(q, c.b, c.centre_b), to = to_world(q, c.a, c.centre_a);
  const Vector2d n = (to - from) / (to - from).norm();
  return {c.a, c.b, from + c.radius_b * n, -n};
}
template <class Other> Meeting meeting(const Other&, const VectorXd&) { return {}; }
Meeting meeting(const DiscDisc& c, const VectorXd& q) {
  const Vector2d from = to_world(q, c.b, c.centre_b), to = to_world(q, c.a, c.centre_a);
  const Vector2d n = (to - from) / (to - from).norm();
  return {c.a, c.b, from + c.radius_b * n, n};
}

/// Sets the joint's constants so that it holds at q.
double angle_of(const VectorXd& q, BodyId id) { return id == kGround ? 0 : q[3 * id + 2]; }
Vector2d to_body(const VectorXd& q, BodyId id, const Vector2d& p) {
  if (id == kGround) return p;
  return Eigen::Rotation2Dd(-q[3 * id + 2]) * Vector2d(p - q.segment<2>(3 * id));
}
void assemble(Revolute& j, const VectorXd& q) { j.point_b = to_body(q, j.b, to_world(q, j.a, j.point_a)); }
void assemble(Fixed& j, const VectorXd& q) {
  j.point_b = to_body(q, j.b, to_world(q, j.a, j.point_a));
  j.angle = angle_of(q, j.a) - angle_of(q, j.b);
}
void assemble(Prismatic& j, const VectorXd& q) {
  j.point_b = to_body(q, j.b, to_world(q, j.a, j.point_a + 0.7 * j.axis));
  j.angle = angle_of(q, j.b) - angle_of(q, j.a);
}
void assemble(CustomJoint& /*j*/, const VectorXd& /*q*/) {}
void assemble(Drive& j, const VectorXd& q) {
  Kinematics at;
  at.pose.resize(4);
  for (std::size_t i = 0; i < 3; ++i) {
    const auto x = q.segment<3>(3 * static_cast<Index>(i));
    at.pose[i] = {x.head<2>(), x[2], std::cos(x[2]), std::sin(x[2])};
  }
  j.law.offset = j.of.value(at);
}
void assemble(Distance& j, const VectorXd& q) {
  j.length = (to_world(q, j.a, j.point_a) - to_world(q, j.b, j.point_b)).norm();
}

/// Each kind between two bodies either way round and with the ground, at random states.
template <class Element, std::size_t N, class Claim> void for_all(const Kind<Element> (&kinds)[N], const Claim& claim) {
  for (const auto& kind : kinds)
    for (const auto& pair : kBodyPairs) {
      const BodyId a = pair.first, b = pair.second;  // names that a lambda may capture
      for (int seed = 0; seed < kSeeds; ++seed) {
        CAPTURE(kind.name);
        CAPTURE(a);
        CAPTURE(b);
        CAPTURE(seed);
        Draws random(static_cast<std::uint64_t>(seed));
        claim(kind.make(a, b, random), random);
      }
    }
}

template <class Claim> void for_all_contacts(Claim&& claim) {
  for_all(kPointContacts, claim), for_all(kOtherContacts, claim);
}

VectorXd residual(const System& system, const VectorXd& q) {
  return testing::all_terms(system, q, VectorXd::Zero(q.size())).phi;
}
bool G_touches_ground(const std::vector<Row>& G) { return G[0].a == kGround || G[0].b == kGround; }
double gap(const System& system, const VectorXd& q) {
  return testing::all_terms(system, q, VectorXd::Zero(q.size())).gap[0];
}

}  // namespace

TEST_CASE("joint rows are the derivatives of the joint's residual") {
  for_all(kJoints, [](const Joint& joint, Draws& random) {
    Scene scene = three_bodies();
    scene.joint(joint);
    const System system(scene);
    const Moving m = random_motion(random);
    const auto G = dense(testing::all_terms(system, m.q, m.v).G, system.dof());
    REQUIRE(G.rows() == system.joint_rows());
    for (int k = 0; k < system.dof(); ++k) {
      const VectorXd e = VectorXd::Unit(system.dof(), k);
      const VectorXd slope = central_difference([&](double s) { return residual(system, m.q + s * e); });
      CHECK(mismatch(VectorXd(G.col(k)), slope) < kCentral);
    }
    CHECK(G.rightCols(3).isZero(0));  // the body without a part in it
  });
}

TEST_CASE("joint biases are the rate of G v at zero acceleration") {
  for_all(kJoints, [](const Joint& joint, Draws& random) {
    Scene scene = three_bodies();
    scene.joint(joint);
    const System system(scene);
    const Moving m = random_motion(random);
    const auto rate = [&](double t) -> VectorXd {
      return dense(testing::all_terms(system, m.q_at(t), m.v_at(t)).G, system.dof()) * m.v_at(t);
    };
    const Terms now = testing::all_terms(system, m.q, m.v);
    const VectorXd expected = central_difference(rate) - dense(now.G, system.dof()) * m.a;
    CHECK(mismatch(now.joint_bias, expected) < kCentral);
  });
}

TEST_CASE("an assembled joint neither sees nor resists a motion of the whole plane") {
  for_all(kJoints, [](Joint joint, Draws& random) {
    const Moving m = random_motion(random);
    std::visit([&](auto& j) { assemble(j, m.q); }, joint);
    Scene scene = three_bodies();
    scene.joint(joint);
    const System system(scene);
    CHECK(residual(system, m.q).lpNorm<Eigen::Infinity>() < 1e-14);
    if (G_touches_ground(testing::all_terms(system, m.q, m.v).G)) return;
    const double angle = random(-3, 3);
    const Vector2d shift = random.point();
    CHECK(residual(system, moved(m.q, angle, shift)).lpNorm<Eigen::Infinity>() < 1e-14);
    const VectorXd rigid = central_difference([&](double s) { return moved(m.q, s * angle, s * shift); });
    const VectorXd rates = dense(testing::all_terms(system, m.q, m.v).G, system.dof()) * rigid;
    CHECK(rates.lpNorm<Eigen::Infinity>() < 1e-8);
  });
}

TEST_CASE("a contact's normal row is the derivative of its gap") {
  for_all_contacts([](const Contact& contact, Draws& random) {
    Scene scene = three_bodies();
    scene.contact(contact);
    const System system(scene);
    const Moving m = random_motion(random);
    const VectorXd row = dense(testing::all_terms(system, m.q, m.v).closed[0].rows.normal, system.dof());
    VectorXd slope(system.dof());
    for (int k = 0; k < system.dof(); ++k)
      slope[k] = central_difference([&](double s) { return gap(system, m.q + s * VectorXd::Unit(system.dof(), k)); });
    CHECK(mismatch(row, slope) < kCentral);
  });
}

TEST_CASE("contact biases are the rates of W v at zero acceleration, normal and tangential, open or closed") {
  for_all_contacts([](const Contact& contact, Draws& random) {
    Scene scene = three_bodies();
    scene.contact(contact);
    const System system(scene);
    const Moving m = random_motion(random);
    const auto rates = [&](double t) -> VectorXd {
      const ContactRows rows = testing::all_terms(system, m.q_at(t), m.v_at(t)).closed[0].rows;
      const VectorXd v = m.v_at(t);
      return Vector2d(apply(rows.normal, v.data()), apply(rows.tangent, v.data()));
    };
    const Terms now = testing::all_terms(system, m.q, m.v);
    const ContactRows rows = now.closed[0].rows;
    const VectorXd measured = central_difference(rates);
    CHECK(mismatch(now.contact_bias[0].normal, measured[0] - apply(rows.normal, m.a.data())) < kCentral);
    CHECK(mismatch(now.contact_bias[0].tangent, measured[1] - apply(rows.tangent, m.a.data())) < kCentral);
  });
}

TEST_CASE("a closed contact's rows are the relative velocity of the two bodies' points that touch") {
  for_all(kPointContacts, [](const Contact& contact, Draws& random) {
    Scene scene = three_bodies();
    scene.contact(contact);
    const System system(scene);
    Moving m = random_motion(random);
    // Close it: move a body along the normal by the gap.
    const Meeting open = std::visit([&](const auto& c) { return meeting(c, m.q); }, contact);
    const double distance = gap(system, m.q);
    if (open.a != kGround)
      m.q.segment<2>(3 * open.a) -= distance * open.normal;
    else
      m.q.segment<2>(3 * open.b) += distance * open.normal;
    REQUIRE(std::abs(gap(system, m.q)) < 1e-14);

    const Meeting at = std::visit([&](const auto& c) { return meeting(c, m.q); }, contact);
    const Vector2d slip = material_velocity(m, at.a, at.point) - material_velocity(m, at.b, at.point);
    const Vector2d tangent(at.normal.y(), -at.normal.x());  // to the right, seen along the normal from b to a
    const ContactRows rows = testing::all_terms(system, m.q, m.v).closed[0].rows;
    CHECK(mismatch(apply(rows.normal, m.v.data()), at.normal.dot(slip)) < kCentral);
    CHECK(mismatch(apply(rows.tangent, m.v.data()), tangent.dot(slip)) < kCentral);

    // Forces of a contact inside the scene have no resultant and no moment: the rows ignore a motion of the plane.
    if (at.a == kGround || at.b == kGround) return;
    const double angle = random(-3, 3);
    const Vector2d shift = random.point();
    CHECK(std::abs(gap(system, moved(m.q, angle, shift))) < 1e-13);
    const VectorXd rigid = central_difference([&](double s) { return moved(m.q, s * angle, s * shift); });
    CHECK(std::abs(apply(rows.normal, rigid.data())) < 1e-8);
    CHECK(std::abs(apply(rows.tangent, rigid.data())) < 1e-8);
  });
}

TEST_CASE("gaps of drawings with known distances") {
  const auto gap_of = [](const Contact& contact, const VectorXd& q) {
    Scene scene;
    scene.body({}), scene.body({});
    scene.contact(contact);
    return gap(System(scene), q);
  };
  const double quarter = std::acos(-1.0) / 2;
  VectorXd q(6);
  q << 3, 4, quarter, 0, 1, 0;
  // The point (1, 0) of body 0 is at (3, 5); the ground's wall is y = 2, body 1's the line y = 1 + 0.5.
  CHECK(gap_of(CornerWall{"", 0, {1, 0}, kGround, {7, 2}, {0, 1}, {}}, q) == doctest::Approx(3));
  CHECK(gap_of(CornerWall{"", 0, {1, 0}, 1, {7, 0.5}, {0, 1}, {}}, q) == doctest::Approx(3.5));
  CHECK(gap_of(DiscWall{"", 0, {1, 0}, 0.25, kGround, {7, 2}, {0, 1}, {}}, q) == doctest::Approx(2.75));
  CHECK(gap_of(DiscDisc{"", 0, {1, 0}, 0.25, 1, {0, 0}, 1.5, {}}, q) == doctest::Approx(3.25));  // 5 − 1.75
  // From below the wall: the normal points into the free side.
  CHECK(gap_of(CornerWall{"", 0, {1, 0}, kGround, {7, 2}, {0, -1}, {}}, q) == doctest::Approx(-3));
}

TEST_CASE("two discs do not know which of them is the first") {
  Draws random(7);
  for (int i = 0; i < kSeeds; ++i) {
    const DiscDisc one{"", 0, random.point(), random(0.1, 1), 1, random.point(), random(0.1, 1), {}};
    const DiscDisc other{"", one.b, one.centre_b, one.radius_b, one.a, one.centre_a, one.radius_a, {}};
    const Moving m = random_motion(random);
    Scene scene = three_bodies();
    scene.contact(one), scene.contact(other);
    const Terms terms = testing::all_terms(System(scene), m.q, m.v);
    CHECK(terms.gap[0] == doctest::Approx(terms.gap[1]).epsilon(1e-14));
    CHECK(mismatch(dense(terms.closed[0].rows.normal, 9), dense(terms.closed[1].rows.normal, 9)) < 1e-14);
    CHECK(mismatch(dense(terms.closed[0].rows.tangent, 9), dense(terms.closed[1].rows.tangent, 9)) < 1e-14);
    CHECK(mismatch(terms.contact_bias[0].normal, terms.contact_bias[1].normal) < 1e-13);
    CHECK(mismatch(terms.contact_bias[0].tangent, terms.contact_bias[1].tangent) < 1e-13);
  }
}

}  // namespace orthant
