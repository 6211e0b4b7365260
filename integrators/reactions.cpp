#include <orthant/core/mechanics/dynamics/each_joint.h>
#include <orthant/integrators/reactions.h>

#include <algorithm>
#include <limits>
#include <type_traits>

namespace orthant {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// [m] from the centre of a body, in the world, to the joint's point on it.
template <class Joint> Vector2d arm(const Joint& j, const Kinematics& at, bool second) {
  if constexpr (requires { j.point_b; }) {
    const BodyId body = second ? j.b : j.a;
    return body < 0 ? Vector2d(0, 0) : at.at(body).turn(second ? j.point_b : j.point_a);
  } else {
    return {0, 0};
  }
}
template <class Joint> Vector3d arm(const Joint& j, const KinematicsOf<Spatial>& at, bool second) {
  if constexpr (requires { j.point_b; }) {
    const BodyId body = second ? j.b : j.a;
    return body < 0 ? Vector3d(0, 0, 0) : at.at(body).turn(second ? j.point_b : j.point_a);
  } else {
    return {0, 0, 0};
  }
}

void add(const RowOf<Planar>::Entries& j, double force, const Vector2d& r, const Kinematics& /*at*/, BodyId /*body*/,
         ReactionOf<Planar>& sum) {
  sum.force[0] += force * j[0], sum.force[1] += force * j[1];
  sum.moment[0] += force * (j[2] - (r.x() * j[1] - r.y() * j[0]));
}
void add(const RowOf<Spatial>::Entries& j, double force, const Vector3d& r, const KinematicsOf<Spatial>& at,
         BodyId body, ReactionOf<Spatial>& sum) {
  const Vector3d F = force * Vector3d(j[0], j[1], j[2]);
  const Vector3d M = spatial::product(at.at(body).axes, force * Vector3d(j[3], j[4], j[5])) - r.cross(F);
  for (int k = 0; k < 3; ++k)
    sum.force[static_cast<std::size_t>(k)] += F[k], sum.moment[static_cast<std::size_t>(k)] += M[k];
}

double tangent_part_of(double impulse, std::size_t /*k*/) { return impulse; }
double tangent_part_of(const Tangents& impulse, std::size_t k) { return tangent_part(impulse, k); }

void middle(const State& one, const State& other, Eigen::VectorXd& q, std::type_identity<Planar>) {
  q = (one.q + other.q) / 2;
}
void middle(const State& one, const State& other, Eigen::VectorXd& q, std::type_identity<Spatial>) {
  const Eigen::VectorXd half = between<Spatial>(one.q, other.q) / 2;
  move<Spatial>(one.q, half, q);
}

}  // namespace

template <class Space> ReactionsOf<Space>::ReactionsOf(const SystemOf<Space>& system)
    : system_(system),
      terms_(system),
      basic_(system),
      none_(Eigen::VectorXd::Zero(system.joint_rows())),
      x_(system.dof()),
      lambda_(system.joint_rows()),
      all_(system.scene().joints.size()) {}

template <class Space>
const std::vector<ReactionOf<Space>>& ReactionsOf<Space>::next(const RunSampleOf<Space>& moment) {
  std::fill(all_.begin(), all_.end(), ReactionOf<Space>{});
  const double h = last_.q.size() == 0 ? 0 : moment.state.t - last_.t;
  if (h > 0 && system_.joint_rows() > 0) gather(moment, h);
  last_ = moment.state;
  return all_;
}

template <class Space> void ReactionsOf<Space>::gather(const RunSampleOf<Space>& moment, double h) {
  const State& x = moment.state;
  const double t = last_.t + h / 2;
  middle(last_, x, q_, std::type_identity<Space>{});
  v_ = (last_.v + x.v) / 2;
  set_poses(system_, t, q_, terms_.at);
  set_twists(system_, v_, terms_.at);
  evaluate_joints(system_, terms_);
  evaluate_forces(system_, t, v_, terms_);
  add_gyroscopic(system_, v_, terms_.f);
  missing_ = h * terms_.f - system_.mass().cwiseProduct(x.v - last_.v);
  terms_.pairs.assign(moment.pairs.begin(), moment.pairs.end());
  for (std::size_t c = 0; c < moment.impulses.size(); ++c) {
    const auto& push = moment.impulses[c];
    if (push.normal == 0 && push.tangent == decltype(push.tangent){}) continue;
    terms_.closed.clear();
    add_closed(system_, static_cast<int>(c), terms_);
    const auto& rows = terms_.closed.back().rows;
    apply_transposed(rows.normal, push.normal, missing_.data());
    for (std::size_t k = 0; k < Space::kTranslations - 1; ++k)
      apply_transposed(row_of_tangent(rows, k), tangent_part_of(push.tangent, k), missing_.data());
  }
  for (std::size_t i = 0; i < moment.frictions.size(); ++i)
    apply_transposed(system_.scene().frictions[i].of.row(terms_.at), moment.frictions[i], missing_.data());
  if (!basic_.factorize(system_, terms_)) {
    for (ReactionOf<Space>& one : all_) one.force.fill(kUnknown), one.moment.fill(kUnknown);
    return;
  }
  basic_.solve(missing_.data(), none_.data(), x_.data(), lambda_.data());
  auto reaction = all_.begin();
  each_joint(system_, [&](const auto& j, int first) {
    const auto [one, other] = bodies_of(j);  // a row may have them the other way round
    const bool second = other >= 0;
    const BodyId body = second ? other : one;
    for (int r = first; r < first + rows_of_joint(j); ++r) {
      const RowOf<Space>& row = terms_.G[static_cast<std::size_t>(r)];
      const double force = (second ? lambda_[r] : -lambda_[r]) / h;
      add(row.b == body ? row.jb : row.ja, force, arm(j, terms_.at, second), terms_.at, body, *reaction);
    }
    ++reaction;
  });
}

template class ReactionsOf<Planar>;
template class ReactionsOf<Spatial>;

}  // namespace orthant
