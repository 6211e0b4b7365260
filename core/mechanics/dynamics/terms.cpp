#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/core/support/simd2.h>

#include <cmath>
#include <limits>

namespace orthant {

Terms::Terms(const System& system) {
  const auto bodies = static_cast<std::size_t>(system.bodies());
  at.pose.resize(bodies + 1);
  at.twist.resize(bodies + 1);
  f.setZero(system.dof());
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
    const Two series = Two(1, 0.5) - square * (Two(1.0 / 6, 1.0 / 24) -
                                               square * (Two(1.0 / 120, 1.0 / 720) - square * Two(1.0 / 5040, 0)));
    const Two sine_less = Two(turn, square) * series;  // the sine, 1 − cosine
    const Two there(node.c, node.s), across(node.s, -node.c);
    const Two rotated = there - (there * Two(sine_less[1]) + across * Two(sine_less[0]));
    at.pose[i] = {{qi[0], qi[1]}, qi[2], rotated[0], rotated[1]};
  }
  at.t = t;
}

void set_twists(const System& system, const Eigen::VectorXd& v, Kinematics& at) {
  const auto bodies = static_cast<std::size_t>(system.bodies());
  at.twist.resize(bodies + 1);
  for (std::size_t i = 0; i < bodies; ++i) at.twist[i] = twist_of(v, static_cast<BodyId>(i));
}

void evaluate_forces(const System& system, double t, const Eigen::VectorXd& v, Terms& terms) {
  const Scene& scene = system.scene();
  terms.f = system.weight();
  for (const Load& load : scene.loads) load.add(terms.at, t, terms.f.data());
  for (std::size_t i = 0; i < scene.springs.size(); ++i) {
    terms.springs[i] = std::visit([&](const auto& s) { return s.evaluate(terms.at, v.data()); }, scene.springs[i]);
    apply_transposed(terms.springs[i].row, -terms.springs[i].tension, terms.f.data());
  }
}

namespace {

/// Calls what(joint, first row) over all joints.
template <class What> void each_joint(const System& system, What&& what) {
  int row = 0;
  for (const Joint& joint : system.scene().joints)
    std::visit(
        [&](const auto& j) {
          what(j, row);
          if constexpr (requires { j.row_count(); })
            row += j.row_count();
          else
            row += j.kRows;
        },
        joint);
}

}  // namespace

void evaluate_joint_residual(const System& system, Terms& terms) {
  each_joint(system, [&](const auto& joint, int row) { joint.residual(terms.at, terms.phi.data() + row); });
}

void evaluate_joint_rows(const System& system, Terms& terms) {
  each_joint(system, [&](const auto& joint, int row) {
    joint.rows(terms.at, terms.G.data() + row);
    if constexpr (requires(double* rate) { joint.rate(terms.at, rate); })
      joint.rate(terms.at, terms.joint_rate.data() + row);
  });
}

void evaluate_joints(const System& system, Terms& terms) {
  each_joint(system, [&](const auto& joint, int row) {
    joint.residual(terms.at, terms.phi.data() + row);
    joint.rows(terms.at, terms.G.data() + row);
    if constexpr (requires(double* rate) { joint.rate(terms.at, rate); })
      joint.rate(terms.at, terms.joint_rate.data() + row);
  });
}

namespace {

/// Calls what(contact) with the listed one, or with what the pair is at the moment.
template <class What> decltype(auto) with_contact(const System& system, const std::vector<Pair>& pairs,
                                                  const Kinematics& at, int contact, What&& what) {
  if (contact < system.listed()) return std::visit(what, system.scene().contacts[static_cast<std::size_t>(contact)]);
  const Pair& pair = pairs[static_cast<std::size_t>(contact - system.listed())];
  return as_contact(system.scene().collisions[static_cast<std::size_t>(pair.collision)], pair, at, what);
}
template <class What> decltype(auto) with_contact(const System& system, const Terms& terms, int contact, What&& what) {
  return with_contact(system, terms.pairs, terms.at, contact, what);
}

}  // namespace

void evaluate_gaps(const System& system, Terms& terms) {
  Index i = 0;
  for (const Contact& contact : system.scene().contacts)
    terms.gap[i++] = std::visit([&](const auto& c) { return c.gap(terms.at); }, contact);
  for (const Pair& pair : terms.pairs) {
    terms.gap[i] = pair.none() ? std::numeric_limits<double>::infinity()
                               : gap_of(system, terms.pairs, static_cast<int>(i), terms.at);
    ++i;
  }
}

double gap_of(const System& system, const std::vector<Pair>& pairs, int contact, const Kinematics& at) {
  return with_contact(system, pairs, at, contact, [&](const auto& c) { return c.gap(at); });
}

std::pair<BodyId, BodyId> bodies_of(const System& system, const std::vector<Pair>& pairs, int contact) {
  const auto i = static_cast<std::size_t>(contact);
  const auto& listed = system.scene().contacts;
  if (i < listed.size()) return std::visit([](const auto& c) { return bodies_of(c); }, listed[i]);
  const Pair& pair = pairs[i - listed.size()];
  if (pair.none()) return {kGround, kGround};
  const auto& shapes = system.scene().collisions[static_cast<std::size_t>(pair.collision)].shapes;
  return {shapes[static_cast<std::size_t>(pair.a)].body, shapes[static_cast<std::size_t>(pair.b)].body};
}

void evaluate_closed(const System& system, double threshold, Terms& terms) {
  terms.closed.clear();
  for (int i = 0; i < system.contacts(); ++i)
    if (terms.gap[i] <= threshold && terms.gap[i] < std::numeric_limits<double>::infinity())
      add_closed(system, i, terms);
}

void evaluate_closed(const System& system, std::span<const int> contacts, Terms& terms) {
  terms.closed.clear();
  for (const int i : contacts) add_closed(system, i, terms);
}

void add_closed(const System& system, int contact, Terms& terms) {
  terms.closed.push_back(
      {contact, with_contact(system, terms, contact, [&](const auto& c) { return c.rows(terms.at); })});
}

void evaluate_biases(const System& system, Terms& terms) {
  each_joint(system, [&](const auto& joint, int row) { joint.bias(terms.at, terms.joint_bias.data() + row); });
  terms.contact_bias.clear();
  for (const ClosedContact& closed : terms.closed)
    terms.contact_bias.push_back(
        with_contact(system, terms, closed.contact, [&](const auto& c) { return c.bias(terms.at); }));
}

}  // namespace orthant
