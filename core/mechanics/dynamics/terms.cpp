#include <orthant/core/mechanics/dynamics/each_joint.h>
#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/core/support/simd2.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace orthant {

template <class Space> TermsOf<Space>::TermsOf(const SystemOf<Space>& system) {
  const auto bodies = static_cast<std::size_t>(system.bodies());
  at.pose.resize(bodies + 1);
  at.twist.resize(bodies + 1);
  f.setZero(system.dof());
  unit = system.length_unit();
  springs.resize(system.scene().springs.size());
  G.resize(static_cast<std::size_t>(system.joint_rows()));
  phi.setZero(system.joint_rows());
  joint_rate.setZero(system.joint_rows());
  joint_bias.setZero(system.joint_rows());
  const auto contacts = static_cast<std::size_t>(system.contacts());
  pairs.resize(contacts - system.scene().contacts.size());
  gap.setConstant(system.contacts(), 0.0);
  closed.reserve(contacts);
  contact_bias.reserve(contacts);
}

void set_poses(const System& system, double t, const Eigen::VectorXd& q, Kinematics& at) {
  constexpr double kCell = 0x1p-5;  // [rad] the series' next terms are below 1e-19 in half of it
  constexpr double kGrid = 0x1p48;  // [rad] beyond, all doubles are on the grid, and the last overflow in units of it
  const auto bodies = static_cast<std::size_t>(system.bodies());
  at.pose.resize(bodies + 1), at.node.resize(bodies);
  for (std::size_t i = 0; i < bodies; ++i) {
    const double* qi = q.data() + kBlock * i;
    Kinematics::Node& node = at.node[i];
    if (!(std::abs(qi[2] - node.theta) < kCell / 2)) {
      node.theta = std::abs(qi[2]) < kGrid ? std::round(qi[2] / kCell) * kCell : qi[2];
      node.c = std::cos(node.theta), node.s = std::sin(node.theta);
    }
    const double turn = qi[2] - node.theta, square = turn * turn;
    const Simd2 series =
        Simd2(1, 0.5) -
        square * (Simd2(1.0 / 6, 1.0 / 24) - square * (Simd2(1.0 / 120, 1.0 / 720) - square * Simd2(1.0 / 5040, 0)));
    const Simd2 sine_less = Simd2(turn, square) * series;  // the sine, 1 − cosine
    const Simd2 there(node.c, node.s), across(node.s, -node.c);
    const Simd2 rotated = there - (there * Simd2(sine_less[1]) + across * Simd2(sine_less[0]));
    at.pose[i] = {{qi[0], qi[1]}, qi[2], rotated[0], rotated[1]};
  }
  at.t = t;
}

void set_poses(const SystemOf<Spatial>& system, double t, const Eigen::VectorXd& q, KinematicsOf<Spatial>& at) {
  const auto bodies = static_cast<std::size_t>(system.bodies());
  at.pose.resize(bodies + 1);
  for (std::size_t i = 0; i < bodies; ++i) {
    const auto body = static_cast<Eigen::Index>(i);
    spatial::Pose& pose = at.pose[i];
    pose.x = place_of<Spatial>(q, body);
    pose.axes = quaternions::matrix_of(quaternion(q, body));
    const spatial::Body& known = system.scene().bodies[i];
    if (known.principal)
      pose.R = pose.axes;
    else
      pose.R = pose.axes * known.to_axes;
  }
  at.t = t;
}

template <class Space>
void set_twists(const SystemOf<Space>& system, const Eigen::VectorXd& v, KinematicsOf<Space>& at) {
  const auto bodies = static_cast<std::size_t>(system.bodies());
  at.twist.resize(bodies + 1);
  for (std::size_t i = 0; i < bodies; ++i) at.twist[i] = twist_of(v, static_cast<BodyId>(i), at);
}

template <class Space>
void evaluate_forces(const SystemOf<Space>& system, double t, const Eigen::VectorXd& v, TermsOf<Space>& terms) {
  const auto& scene = system.scene();
  terms.f = system.weight();
  for (const auto& load : scene.loads) load.add(terms.at, t, terms.f.data());
  for (std::size_t i = 0; i < scene.springs.size(); ++i) {
    terms.springs[i] = std::visit([&](const auto& s) { return s.evaluate(terms.at, v.data()); }, scene.springs[i]);
    apply_transposed(terms.springs[i].row, -terms.springs[i].tension, terms.f.data());
  }
}

template <class Space> void evaluate_joint_residual(const SystemOf<Space>& system, TermsOf<Space>& terms) {
  each_joint(system, [&](const auto& joint, int row) { joint.residual(terms.at, terms.phi.data() + row); });
}

template <class Space> void evaluate_joint_rows(const SystemOf<Space>& system, TermsOf<Space>& terms) {
  each_joint(system, [&](const auto& joint, int row) {
    joint.rows(terms.at, terms.G.data() + row);
    if constexpr (requires(double* rate) { joint.rate(terms.at, rate); })
      joint.rate(terms.at, terms.joint_rate.data() + row);
  });
}

template <class Space> void evaluate_joints(const SystemOf<Space>& system, TermsOf<Space>& terms) {
  each_joint(system, [&](const auto& joint, int row) {
    joint.residual(terms.at, terms.phi.data() + row);
    joint.rows(terms.at, terms.G.data() + row);
    if constexpr (requires(double* rate) { joint.rate(terms.at, rate); })
      joint.rate(terms.at, terms.joint_rate.data() + row);
  });
}

namespace {

/// Calls what(contact) with the listed one, or with what the pair is at the moment.
template <class Space, class What>
decltype(auto) with_contact(const SystemOf<Space>& system, const std::vector<Pair>& pairs,
                            const KinematicsOf<Space>& at, int contact, What&& what) {
  if (contact < system.listed()) return std::visit(what, system.scene().contacts[static_cast<std::size_t>(contact)]);
  const Pair& pair = pairs[static_cast<std::size_t>(contact - system.listed())];
  return as_contact(system.scene().collisions[static_cast<std::size_t>(pair.collision)], pair, at, what);
}
template <class Space, class What>
decltype(auto) with_contact(const SystemOf<Space>& system, const TermsOf<Space>& terms, int contact, What&& what) {
  return with_contact(system, terms.pairs, terms.at, contact, what);
}

void pair_gaps(const System& system, Terms& terms, Index i) {
  for (const Pair& pair : terms.pairs) {
    terms.gap[i] = pair.none() ? std::numeric_limits<double>::infinity()
                               : gap_of(system, terms.pairs, static_cast<int>(i), terms.at);
    ++i;
  }
}

/// The points of a pair stand one behind the other: its touch is found once.
void pair_gaps(const SystemOf<Spatial>& system, TermsOf<Spatial>& terms, Index i) {
  const auto& collisions = system.scene().collisions;
  spatial::TouchPoints points;
  for (const Pair& pair : terms.pairs) {
    terms.gap[i] = std::numeric_limits<double>::infinity();
    if (!pair.none()) {
      if (pair.point == 0) points = touch(collisions[static_cast<std::size_t>(pair.collision)], pair, terms.at);
      terms.gap[i] = points.at(pair.point).gap;
    }
    ++i;
  }
}

}  // namespace

template <class Space> void evaluate_gaps(const SystemOf<Space>& system, TermsOf<Space>& terms) {
  Index i = 0;
  for (const auto& contact : system.scene().contacts)
    terms.gap[i++] = std::visit([&](const auto& c) { return c.gap(terms.at); }, contact);
  pair_gaps(system, terms, i);
}

template <class Space> double gap_of(const SystemOf<Space>& system, const std::vector<Pair>& pairs, int contact,
                                     const KinematicsOf<Space>& at) {
  return with_contact(system, pairs, at, contact, [&](const auto& c) { return c.gap(at); });
}

template <class Space>
std::pair<BodyId, BodyId> bodies_of(const SystemOf<Space>& system, const std::vector<Pair>& pairs, int contact) {
  const auto i = static_cast<std::size_t>(contact);
  const auto& listed = system.scene().contacts;
  if (i < listed.size()) return std::visit([](const auto& c) { return bodies_of(c); }, listed[i]);
  const Pair& pair = pairs[i - listed.size()];
  if (pair.none()) return {kGround, kGround};
  const auto& shapes = system.scene().collisions[static_cast<std::size_t>(pair.collision)].shapes;
  return {shapes[static_cast<std::size_t>(pair.a)].body, shapes[static_cast<std::size_t>(pair.b)].body};
}

template <class Space> void evaluate_closed(const SystemOf<Space>& system, double threshold, TermsOf<Space>& terms) {
  terms.closed.clear();
  for (int i = 0; i < system.contacts(); ++i)
    if (terms.gap[i] <= threshold && terms.gap[i] < std::numeric_limits<double>::infinity())
      add_closed(system, i, terms);
}

template <class Space>
void evaluate_closed(const SystemOf<Space>& system, std::span<const int> contacts, TermsOf<Space>& terms) {
  terms.closed.clear();
  for (const int i : contacts) add_closed(system, i, terms);
}

template <class Space> void add_closed(const SystemOf<Space>& system, int contact, TermsOf<Space>& terms) {
  terms.closed.push_back(
      {contact, with_contact(system, terms, contact, [&](const auto& c) { return c.rows(terms.at); })});
  if constexpr (!kPlanar<Space>) spatial::adapt_to_surface(system.law(contact), terms.at, terms.closed.back().rows);
}

void add_closed_as(const SystemOf<Planar>& system, int contact, const TermsOf<Planar>& /*there*/,
                   TermsOf<Planar>& terms) {
  add_closed(system, contact, terms);
}

namespace {

Vector3d in_frame(const spatial::Pose& pose, const Vector3d& p) { return pose.turn_back(p - pose.x); }

/// A corner of `one` on a face of the other: where both are in other poses. From the other to `one`; else nothing.
std::optional<spatial::TouchPoint> corner_moved(const spatial::Shape& one, const spatial::TouchPoint& p,
                                                const spatial::Pose& one_before, const spatial::Pose& one_now,
                                                const spatial::Pose& other_before, const spatial::Pose& other_now) {
  constexpr double kAlike = 1e-9;  // of the size
  if (!one.polytope()) return {};
  const Vector3d place = in_frame(one_before, p.on_a);
  const auto same = [&](const Vector3d& corner) { return (corner - place).norm() <= kAlike * one.hull->size; };
  if (std::none_of(one.hull->corners.begin(), one.hull->corners.end(), same)) return {};
  const Vector3d n = other_now.turn(other_before.turn_back(p.n)), on_one = one_now.x + one_now.turn(place);
  const double gap = n.dot(on_one - other_now.x - other_now.turn(in_frame(other_before, p.on_b)));
  return spatial::TouchPoint{n, on_one, on_one - gap * n, gap};
}

/// The point, of shapes in the poses `there`, in the poses `here`: a corner stays on its face.
std::optional<spatial::TouchPoint> point_moved(const spatial::Collision& collision, const Pair& pair,
                                               const spatial::TouchPoint& p, const KinematicsOf<Spatial>& there,
                                               const KinematicsOf<Spatial>& here) {
  const auto& a = collision.shapes[static_cast<std::size_t>(pair.a)];
  const auto& b = collision.shapes[static_cast<std::size_t>(pair.b)];
  if (const auto moved = corner_moved(a, p, there.at(a.body), here.at(a.body), there.at(b.body), here.at(b.body)))
    return moved;
  const auto moved = corner_moved(b, {-p.n, p.on_b, p.on_a, p.gap}, there.at(b.body), here.at(b.body), there.at(a.body),
                                  here.at(a.body));
  if (!moved) return {};
  return spatial::TouchPoint{-moved->n, moved->on_b, moved->on_a, moved->gap};
}

}  // namespace

void add_closed_as(const SystemOf<Spatial>& system, int contact, const TermsOf<Spatial>& there,
                   TermsOf<Spatial>& terms) {
  if (contact < system.listed()) return add_closed(system, contact, terms);
  const Pair& pair = terms.pairs[static_cast<std::size_t>(contact - system.listed())];
  const auto& collision = system.scene().collisions[static_cast<std::size_t>(pair.collision)];
  const auto [a, b] = bodies_of(system, terms.pairs, contact);
  const spatial::TouchPoint now = touch(collision, pair, there.at).at(pair.point);
  const spatial::TouchPoints before = touch(collision, pair, terms.at);
  // In the frame of each body: how far the point is from this one, and how far this one's place moves in the world.
  double nearest = std::numeric_limits<double>::infinity();
  int same = -1;
  const auto moved = [&](BodyId body, const Vector3d& p) {
    return (terms.at.at(body).x + terms.at.at(body).turn(in_frame(there.at.at(body), p)) - p).norm();
  };
  for (int i = 0; i < before.count; ++i) {
    const spatial::TouchPoint& p = before.points[static_cast<std::size_t>(i)];
    const double off = std::min((in_frame(terms.at.at(a), p.on_a) - in_frame(there.at.at(a), now.on_a)).norm(),
                                (in_frame(terms.at.at(b), p.on_b) - in_frame(there.at.at(b), now.on_b)).norm());
    if (off < nearest) nearest = off, same = i;
  }
  const bool known = same >= 0 && nearest <= 2 * (moved(a, now.on_a) + moved(b, now.on_b)) + 1e-9 * before.open;
  const auto back = known ? std::nullopt : point_moved(collision, pair, now, there.at, terms.at);
  const spatial::TouchContact one{a, b, known ? before.points[static_cast<std::size_t>(same)] : back.value_or(now)};
  const KinematicsOf<Spatial>& at = known || back ? terms.at : there.at;
  terms.closed.push_back({contact, one.rows(at)});
  spatial::adapt_to_surface(system.law(contact), at, terms.closed.back().rows);
}

template <class Space> void evaluate_biases(const SystemOf<Space>& system, TermsOf<Space>& terms) {
  each_joint(system, [&](const auto& joint, int row) { joint.bias(terms.at, terms.joint_bias.data() + row); });
  terms.contact_bias.clear();
  if constexpr (kPlanar<Space>)
    for (const ClosedContact& closed : terms.closed)
      terms.contact_bias.push_back(
          with_contact(system, terms, closed.contact, [&](const auto& c) { return c.bias(terms.at); }));
}

void add_gyroscopic(const SystemOf<Spatial>& system, const Eigen::VectorXd& v, Eigen::VectorXd& f) {
  for (Eigen::Index i = 0; i < system.bodies(); ++i) {
    const Vector3d omega = rotation<Spatial>(v, i), J = rotation<Spatial>(system.mass(), i);
    rotation<Spatial>(f, i) -= omega.cross(J.cwiseProduct(omega));
  }
}

#define ORTHANT_TERMS(Space)                                                                                 \
  template struct TermsOf<Space>;                                                                            \
  template void set_twists(const SystemOf<Space>&, const Eigen::VectorXd&, KinematicsOf<Space>&);            \
  template void evaluate_forces(const SystemOf<Space>&, double, const Eigen::VectorXd&, TermsOf<Space>&);    \
  template void evaluate_joint_residual(const SystemOf<Space>&, TermsOf<Space>&);                            \
  template void evaluate_joint_rows(const SystemOf<Space>&, TermsOf<Space>&);                                \
  template void evaluate_joints(const SystemOf<Space>&, TermsOf<Space>&);                                    \
  template void evaluate_gaps(const SystemOf<Space>&, TermsOf<Space>&);                                      \
  template double gap_of(const SystemOf<Space>&, const std::vector<Pair>&, int, const KinematicsOf<Space>&); \
  template std::pair<BodyId, BodyId> bodies_of(const SystemOf<Space>&, const std::vector<Pair>&, int);       \
  template void evaluate_closed(const SystemOf<Space>&, double, TermsOf<Space>&);                            \
  template void add_closed(const SystemOf<Space>&, int, TermsOf<Space>&);                                    \
  template void evaluate_closed(const SystemOf<Space>&, std::span<const int>, TermsOf<Space>&);              \
  template void evaluate_biases(const SystemOf<Space>&, TermsOf<Space>&);
ORTHANT_TERMS(Planar)
ORTHANT_TERMS(Spatial)
#undef ORTHANT_TERMS

}  // namespace orthant
