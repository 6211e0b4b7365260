#include <orthant/integrators/between_events/lasting_rows.h>
#include <orthant/integrators/between_events/spatial_motion.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace orthant {
namespace {

constexpr double kTurnBeside = 1e-3;  // [rad] of differences: errors of 1e-13 from either side
constexpr double kWayBeside = 1e3;  // [m] likewise: bodies that fall hardly turn, and would be moved beyond all doubles
constexpr double kSharpest = 1e-3;  // of a rim's tilt and of an ellipsoid's axes

/// Rows of an ellipsoid or a rim turn that much faster than their body.
double sharpness(const spatial::EllipsoidPlane& c, const KinematicsOf<Spatial>& /*k*/) {
  return 1 / std::max(kSharpest, c.semi_axes.minCoeff() / c.semi_axes.maxCoeff());
}
double sharpness(const spatial::RimPlane& c, const KinematicsOf<Spatial>& k) {
  return 1 / std::max(kSharpest, k.at(c.a).turn(c.axis).cross(k.at(c.b).turn(c.normal)).norm());
}
template <class Contact> double sharpness(const Contact& /*c*/, const KinematicsOf<Spatial>& /*k*/) { return 1; }

Vector3d velocity_of(const Eigen::VectorXd& v, BodyId body) {
  return body < 0 ? Vector3d(0, 0, 0) : Vector3d(translation<Spatial>(v, body));
}

}  // namespace

SpatialWatched::SpatialWatched(Index n)
    : gap(n),
      gap_rate(n),
      gap_scale(n),
      rate_scale(n),
      normal(n),
      tangent(n),
      slip(n),
      slip_change(n),
      along(static_cast<std::size_t>(n)) {}

SpatialMotion::SpatialMotion(const System& system)
    : modes(system.scene().contacts.size()),
      system_(system),
      terms_(system),
      basic_(system),
      projection_(system),
      equations_(system, 3 * modes.size()),
      beside_(terms_.at),
      rest_(Eigen::VectorXd::Zero(static_cast<Index>(modes.size()))),
      free_(system.dof()),
      rate_(system.joint_rows()),
      lambda_(system.joint_rows()),
      zero_(Eigen::VectorXd::Zero(system.dof())),
      step_(system.dof()) {
  beside_.pose.resize(static_cast<std::size_t>(system.bodies()) + 1);
}

void SpatialMotion::modes_changed() {
  lasting_.clear();
  for (std::size_t i = 0; i < modes.size(); ++i)
    if (modes[i].lasting) lasting_.push_back(static_cast<int>(i));
  normal_.assign(lasting_.size(), 0), tangent_.assign(lasting_.size(), {}), slip_direction_.assign(lasting_.size(), {});
}

void SpatialMotion::open_all() {
  std::fill(modes.begin(), modes.end(), SpatialMode{});
  modes_changed();
}

void SpatialMotion::remember(CheckpointData& memory) {
  memory(modes, rest_);
  if (memory.reading()) modes_changed();
  basic_.forget(), projection_.forget();
}

bool SpatialMotion::accelerations(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v, Eigen::VectorXd& a) {
  set_poses(system_, t, q, terms_.at);
  set_twists(system_, v, terms_.at);
  evaluate_forces(system_, t, v, terms_);
  add_gyroscopic(system_, v, terms_.f);
  evaluate_joint_rows(system_, terms_);
  evaluate_closed(system_, lasting_, terms_);
  evaluate_biases(system_, terms_);
  if (!basic_.factorize(system_, terms_)) return false;
  rate_ = -terms_.joint_bias;
  basic_.solve(terms_.f.data(), rate_.data(), free_.data(), lambda_.data());
  a = free_;
  if (!lasting_.empty() && !impose(q, v, a)) return false;
  return a.allFinite();
}

/// Unit, along the two tangents of lasting contact i.
Tangents SpatialMotion::direction(std::size_t i, const Eigen::VectorXd& v) const {
  const Rows& rows = terms_.closed[i].rows;
  const SpatialMode& mode = modes[static_cast<std::size_t>(lasting_[i])];
  Tangents slip = slip_of(rows, v);
  if (mode.departs || size_of(slip) <= slip_rounding(v)) slip = along_tangents(rows, mode.departure);
  const double size = size_of(slip);
  return size > 0 ? 1 / size * slip : Tangents{};
}

double SpatialMotion::grip(std::size_t i) const {
  const auto& tangents = terms_.closed[i].rows.tangents;
  const auto inverse = [&](const RowOf<Spatial>& row) { return coupling(row, row, system_.inverse_mass()); };
  return system_.law(lasting_[i]).mu * std::abs(normal_[i]) * std::max(inverse(tangents[0]), inverse(tangents[1]));
}

/// False: the directions of contacts that depart are not found.
bool SpatialMotion::impose(const Eigen::VectorXd& q, const Eigen::VectorXd& v, Eigen::VectorXd& a) {
  constexpr int kIterations = 500;
  constexpr double kFound = 1e-14, kNearly = 1e-9;  // [rad]
  bias_.clear();
  bool departs = false;
  for (std::size_t i = 0; i < lasting_.size(); ++i) {
    const SpatialMode& mode = modes[static_cast<std::size_t>(lasting_[i])];
    bias_.push_back(bias(lasting_[i], q, v));
    if (mode.slides) slip_direction_[i] = direction(i, v);
    departs = departs || mode.departs;
  }
  solve_contacts(a);
  double turned = departs ? kInf : 0;
  for (int i = 0; i < kIterations && turned > kFound; ++i) {
    const double before = turned;
    turned = turn_departures(a);
    if (turned <= kNearly && !(turned < before)) break;  // rounding
    a = free_;
    solve_contacts(a);
  }
  return turned <= kNearly;
}

/// Forces of the lasting contacts, and their part of the accelerations.
void SpatialMotion::solve_contacts(Eigen::VectorXd& a) {
  equations_.clear();
  share_.resize(static_cast<Index>(3 * lasting_.size()));
  for (std::size_t i = 0; i < lasting_.size(); ++i) {
    const SpatialMode& mode = modes[static_cast<std::size_t>(lasting_[i])];
    const Rows& rows = terms_.closed[i].rows;
    share_[equations_.size()] = mode.share_normal;
    RowOf<Spatial> force = rows.normal;
    if (mode.slides) {
      const double mu = system_.law(lasting_[i]).mu;
      force = combined(force, -mu * slip_direction_[i].first, rows.tangents[0]);
      force = combined(force, -mu * slip_direction_[i].second, rows.tangents[1]);
    }
    equations_.add(rows.normal, force, bias_[i].normal);
    for (std::size_t k = 0; mode.sticks && k < 2; ++k) {
      share_[equations_.size()] = mode.share_tangent;
      equations_.add(rows.tangents[k], rows.tangents[k], tangent_part(bias_[i].tangent, k));
    }
  }
  share_.resize(equations_.size());
  equations_.assemble(basic_, a);
  equations_.solve(share_);
  equations_.act(equations_.z, a);
  Index k = 0;
  for (std::size_t i = 0; i < lasting_.size(); ++i) {
    const SpatialMode& mode = modes[static_cast<std::size_t>(lasting_[i])];
    normal_[i] = equations_.z[k++];
    tangent_[i] = {};
    if (mode.slides) tangent_[i] = -system_.law(lasting_[i]).mu * normal_[i] * slip_direction_[i];
    if (mode.sticks) tangent_[i] = {equations_.z[k], equations_.z[k + 1]}, k += 2;
  }
}

/// One fixed-point iteration: d → (r d + γ̇_T) / |…|, r the sum of all grips. By how much they turn.
double SpatialMotion::turn_departures(const Eigen::VectorXd& a) {
  double r = 0, turned = 0;
  const auto departs = [&](std::size_t i) { return modes[static_cast<std::size_t>(lasting_[i])].departs; };
  for (std::size_t i = 0; i < lasting_.size(); ++i)
    if (departs(i)) r += grip(i);
  for (std::size_t i = 0; i < lasting_.size(); ++i) {
    if (!departs(i)) continue;
    const Tangents change = slip_rate(terms_.closed[i].rows, a.data()) + bias_[i].tangent;
    Tangents to = r * slip_direction_[i] + change;
    const double size = size_of(to);
    if (!(size > 0)) return kInf;
    to = 1 / size * to;
    turned = std::max(turned, size_of(to - slip_direction_[i]));
    slip_direction_[i] = to;
  }
  return turned;
}

double SpatialMotion::power(double t, const Eigen::VectorXd& v, const Eigen::VectorXd& a) {
  double sum = 0;
  if (system_.driven()) sum = v.dot(system_.mass().cwiseProduct(a) - terms_.f);
  const bool found = for_each_lasting<Spatial>(terms_.closed, lasting_, [&](std::size_t i, const Rows& rows) {
    if (system_.driven())
      sum -= normal_[i] * apply(rows.normal, v.data()) + inner(tangent_[i], slip_rate(rows, v.data()));
    sum += inner(tangent_[i], rows.belt);
  });
  if (!found) return std::numeric_limits<double>::quiet_NaN();
  step_.setZero();
  for (const spatial::Load& load : system_.scene().loads) load.add(terms_.at, t, step_.data());
  return sum + step_.dot(v);
}

double SpatialMotion::pace(int contact, const Eigen::VectorXd& v) const {
  const auto [a, b] = bodies_of(system_, terms_.pairs, contact);
  const auto of = [&](BodyId body) { return body < 0 ? Vector3d(0, 0, 0) : Vector3d(rotation<Spatial>(v, body)); };
  const double turning = std::max({of(a).norm(), of(b).norm(), system_.law(contact).surface.omega.norm()});
  const auto moving = [&, a = a, b = b](const Vector3d& point_a, const Vector3d& point_b, double length) {
    const auto velocity = [&](BodyId body, const Vector3d& point) -> Vector3d {
      return twist_of(v, body, terms_.at).at(terms_.at.at(body).turn(point));
    };
    return std::max(turning, (velocity(a, point_a) - velocity(b, point_b)).norm() / length);
  };
  return std::visit(
      [&, a = a, b = b](const auto& c) {
        using Kind = std::decay_t<decltype(c)>;
        if constexpr (std::is_same_v<Kind, spatial::SphereSphere>) {
          return moving(c.centre_a, c.centre_b, c.radius_a + c.radius_b);
        } else if constexpr (std::is_same_v<Kind, spatial::Socket>) {
          return moving(c.centre_a, c.centre_b, c.radius_b - c.radius_a);
        } else if constexpr (std::is_same_v<Kind, spatial::PinBush>) {  // the rim's centre goes round the other axis
          const spatial::Pose &pin = terms_.at.at(a), &bush = terms_.at.at(b);
          const Vector3d rim = c.rim_of_pin ? Vector3d(pin.x + pin.turn(c.centre_a + c.along * c.axis_a))
                                            : Vector3d(bush.x + bush.turn(c.centre_b + c.along * c.axis_b));
          const Vector3d axis = c.rim_of_pin ? bush.turn(c.axis_b) : pin.turn(c.axis_a);
          const Vector3d way = twist_of(v, a, terms_.at).at(rim - pin.x) - twist_of(v, b, terms_.at).at(rim - bush.x);
          return std::max(turning, axis.cross(way).norm() / (c.radius_b - c.radius_a));
        } else if constexpr (std::is_same_v<Kind, spatial::SphereBush>) {  // past the bush, square to its axis
          const Vector3d u = terms_.at.at(c.b).turn(c.axis_b), arm = terms_.at.at(c.a).turn(c.centre_a);
          const Vector3d past = twist_of(v, c.a, terms_.at).at(arm) -
                                twist_of(v, c.b, terms_.at).at(terms_.at.at(c.a).x + arm - terms_.at.at(c.b).x);
          return std::max(turning, (past - u.dot(past) * u).norm() / (c.radius_b - c.radius_a));
        } else {
          return sharpness(c, terms_.at) * turning;
        }
      },
      system_.scene().contacts[static_cast<std::size_t>(contact)]);
}

/// The pose of a body at q exp(s v), in beside_.
void SpatialMotion::place(BodyId body, const Eigen::VectorXd& q, const Eigen::VectorXd& v, double s) {
  if (body < 0) return;
  spatial::Pose& pose = beside_.pose[static_cast<std::size_t>(body)];
  pose.x = place_of<Spatial>(q, body) + s * translation<Spatial>(v, body);
  pose.axes =
      quaternions::matrix_of(quaternions::turned(quaternion(q, body), Vector3d(s * rotation<Spatial>(v, body))));
  pose.R = pose.axes * system_.scene().bodies[static_cast<std::size_t>(body)].to_axes;
}

SpatialMotion::Bias SpatialMotion::bias(int contact, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  if (const auto* c = std::get_if<spatial::Limit>(&system_.scene().contacts[static_cast<std::size_t>(contact)]))
    return {(c->side == spatial::Limit::Side::lower ? 1 : -1) * c->of.bias(terms_.at)};
  if (const auto* c = std::get_if<spatial::Backlash>(&system_.scene().contacts[static_cast<std::size_t>(contact)]))
    return {c->bias(terms_.at)};
  const double turning = pace(contact, v);
  if (!(turning > 0)) return {};
  const auto [a, b] = bodies_of(system_, terms_.pairs, contact);
  const ContactLaw& law = system_.law(contact);
  const bool frictional = law.frictional(), orthotropic = law.surface.orthotropic();
  const double fastest = std::max(velocity_of(v, a).norm(), velocity_of(v, b).norm());
  const double s = std::min(kTurnBeside / turning, kWayBeside / std::max(fastest, 1e-300));
  double normal = 0;
  Vector3d slip(0, 0, 0);
  Tangents change{};
  Rows here;
  std::visit(
      [&, a = a, b = b](const auto& c) {
        if (frictional) here = c.rows(terms_.at);
        for (const auto& [at, weight] : {std::pair{-2.0, 1.0}, {-1.0, -8.0}, {1.0, 8.0}, {2.0, -1.0}}) {
          place(a, q, v, at * s), place(b, q, v, at * s);
          Rows rows = c.rows(beside_);
          const double rate = apply(rows.normal, v.data());
          normal += weight * rate;
          if (!frictional) continue;
          spatial::adapt_to_surface(law, beside_, rows);
          const Tangents along = slip_of(rows, v);
          change += weight * along;
          if (!orthotropic) slip += weight * (rate * direction_of(rows.normal) + in_world(rows, along));
        }
      },
      system_.scene().contacts[static_cast<std::size_t>(contact)]);
  Bias found{normal / (12 * s)};
  if (frictional) found.tangent = 1 / (12 * s) * (orthotropic ? change : along_tangents(here, slip));
  return found;
}

void SpatialMotion::watch(const Eigen::VectorXd& q, const Eigen::VectorXd& v, const Eigen::VectorXd& a,
                          SpatialWatched& w) {
  w.normal.setZero(), w.tangent.setZero(), w.slip_change.setZero();
  for (std::size_t i = 0; i < lasting_.size(); ++i) {
    const int c = lasting_[i];
    const Rows& rows = terms_.closed[i].rows;
    w.normal[c] = normal_[i], w.tangent[c] = size_of(tangent_[i]);
    if (!modes[static_cast<std::size_t>(c)].slides) continue;
    const Tangents change = slip_rate(rows, a.data()) + bias_[i].tangent;
    w.slip_change[c] = inner(slip_direction_[i], change);
    w.along[static_cast<std::size_t>(c)] = in_world(rows, slip_direction_[i]);
  }
  evaluate_gaps(system_, terms_);
  evaluate_closed(system_, kInf, terms_);
  w.gap = terms_.gap - rest_;
  for (Index i = 0; i < w.gap.size(); ++i) {
    const auto& [contact, rows] = terms_.closed[static_cast<std::size_t>(i)];
    w.gap_rate[i] = apply(rows.normal, v.data());
    w.slip[i] = system_.law(contact).frictional() ? size_of(slip_of(rows, v)) : 0;
    double far = std::abs(terms_.gap[i]), fast = 0;
    const auto add = [&](BodyId body, const RowOf<Spatial>::Entries& j) {
      for (std::size_t k = 3; k < 6; ++k) far += std::abs(j[k]);
      if (body < 0) return;
      far += place_of<Spatial>(q, body).norm();
      for (std::size_t k = 0; k < 6; ++k) fast += std::abs(j[k] * v[6 * body + static_cast<Index>(k)]);
    };
    add(rows.normal.a, rows.normal.ja), add(rows.normal.b, rows.normal.jb);
    w.gap_scale[i] = far, w.rate_scale[i] = fast;
  }
  evaluate_closed(system_, lasting_, terms_);
}

void SpatialMotion::watch_gaps(double t, const Eigen::VectorXd& q, const Eigen::VectorXd& v, Eigen::VectorXd& gap,
                               Eigen::VectorXd& rate) {
  set_poses(system_, t, q, terms_.at);
  evaluate_gaps(system_, terms_);
  evaluate_closed(system_, kInf, terms_);
  gap = terms_.gap - rest_;
  rate.resize(gap.size());
  for (Index i = 0; i < gap.size(); ++i)
    rate[i] = apply(terms_.closed[static_cast<std::size_t>(i)].rows.normal, v.data());
}

void SpatialMotion::rest(double t, const Eigen::VectorXd& q, double touching) {
  set_poses(system_, t, q, terms_.at);
  evaluate_gaps(system_, terms_);
  rest_ = (terms_.gap.array() < -touching).select(terms_.gap, 0.0);
}

void SpatialMotion::forget_overlaps(SpatialWatched& w) {
  for (Index i = 0; i < rest_.size(); ++i)
    if (rest_[i] != 0 && w.gap[i] + rest_[i] > 0) w.gap[i] += rest_[i], rest_[i] = 0;
}

SpatialMotion::Residual SpatialMotion::project(double t, Eigen::VectorXd& q, Eigen::VectorXd& v) {
  constexpr int kPasses = 10;
  Residual left;
  left.joint = projection_.position(t, terms_, q);
  if (!(left.joint < kInf)) return left;
  const auto correct = [&](bool position, Eigen::VectorXd& x) {
    equations_.clear();
    for (std::size_t i = 0; i < lasting_.size(); ++i) {
      const Rows& rows = terms_.closed[i].rows;
      const Index c = lasting_[i];
      equations_.add(rows.normal, rows.normal, position ? terms_.gap[c] - rest_[c] : apply(rows.normal, v.data()));
      if (position || !modes[static_cast<std::size_t>(c)].sticks) continue;
      const Tangents slip = slip_of(rows, v);
      for (std::size_t k = 0; k < 2; ++k) equations_.add(rows.tangents[k], rows.tangents[k], tangent_part(slip, k));
    }
    share_.resize(equations_.size());
    equations_.assemble(basic_, zero_);
    for (Index i = 0; i < share_.size(); ++i) share_[i] = equations_.A(i, i) > 0 ? 1 / equations_.A(i, i) : 1;
    equations_.solve(share_);
    equations_.act(equations_.z, x);
  };
  if (!lasting_.empty()) {
    evaluate_gaps(system_, terms_);
    double off = kInf;
    for (int pass = 0; pass < kPasses; ++pass) {
      double now = 0;
      for (const Index c : lasting_) now = std::max(now, std::abs(terms_.gap[c] - rest_[c]));
      evaluate_joint_rows(system_, terms_);
      evaluate_closed(system_, lasting_, terms_);
      if (!basic_.factorize(system_, terms_)) return {kInf, kInf};
      if (!(now < off) || now <= 1e-15 * (1 + q.lpNorm<Eigen::Infinity>())) break;
      off = now;
      step_.setZero();
      correct(true, step_);
      move<Spatial>(q, step_);
      left.joint = projection_.position(t, terms_, q);
      if (!(left.joint < kInf)) return left;
      evaluate_gaps(system_, terms_);
    }
  }
  left.off = projection_.off(terms_, q);
  left.rate = projection_.velocity(terms_, v);
  if (!lasting_.empty()) correct(false, v);
  return left;
}

}  // namespace orthant
