#include <orthant/integrators/derivatives/gyroscopic_slope.h>
#include <orthant/integrators/derivatives/spatial_projection_linearization.h>
#include <orthant/integrators/derivatives/spatial_row_slope.h>

#include <algorithm>

namespace orthant {

namespace {

double relative_to(const Eigen::VectorXd& left, const Eigen::VectorXd& x) {
  return left.size() > 0 ? left.lpNorm<Eigen::Infinity>() / (1 + x.lpNorm<Eigen::Infinity>()) : 0;
}

}  // namespace

SpatialProjectionLinearization::SpatialProjectionLinearization(const System& system)
    : system_(system),
      before_(system),
      after_(system),
      independent_(system),
      places_(system),
      rates_(system),
      slopes_(static_cast<std::size_t>(system.joint_rows())),
      none_(Eigen::VectorXd::Zero(system.dof())) {
  for (auto* x : {&lambda_, &nu_, &off_}) x->setZero(system.joint_rows());
  force_.setZero(system.dof());
}

double SpatialProjectionLinearization::set_up(double t, const Eigen::VectorXd& q_before,
                                              const Eigen::VectorXd& v_before, const State& after) {
  after_v_ = after.v, moved_ = between<Spatial>(q_before, after.q), turned_ = after.v - v_before;
  if (system_.joint_rows() == 0) return std::max(relative_to(moved_, after.q), relative_to(turned_, after.v));
  set_poses(system_, t, q_before, before_.at);
  evaluate_joint_rows(system_, before_);
  set_poses(system_, t, after.q, after_.at);
  evaluate_joint_rows(system_, after_);

  carry_.clear(), turn_.clear();
  held_ = after_.G;
  for (int body = 0; body < system_.bodies(); ++body) {
    const Eigen::Index first = Spatial::kVelocities * static_cast<Eigen::Index>(body);
    const Vector3d s = rotation<Spatial>(moved_, body);
    const Eigen::Matrix3d T = turn_of(-s), J = right_jacobian(s);
    for (Eigen::Index i = 0; i < 3; ++i) {
      carry_.push_back({first + i, first + i, 1}), turn_.push_back({first + i, first + i, 1});
      for (Eigen::Index j = 0; j < 3; ++j) {
        carry_.push_back({first + 3 + i, first + 3 + j, T(i, j)});
        turn_.push_back({first + 3 + i, first + 3 + j, J(i, j)});
      }
    }
    for (Row& row : held_) {
      const auto times = [&](Row::Entries& entries) {
        const Vector3d turned = J.transpose() * Vector3d(entries[3], entries[4], entries[5]);
        entries[3] = turned[0], entries[4] = turned[1], entries[5] = turned[2];
      };
      if (row.a == body) times(row.ja);
      if (row.b == body) times(row.jb);
    }
  }
  const std::vector<Eigen::Index>& rows = independent_.find(before_);
  places_.set_up({}, before_.G, held_, rows);
  rates_.set_up({}, before_.G, after_.G, rows);
  const auto missed = [&](const Eigen::VectorXd& step, Eigen::VectorXd& impulses) {
    for (Eigen::Index i = 0; i < off_.size(); ++i) off_[i] = apply(after_.G[static_cast<std::size_t>(i)], step.data());
    rates_.solve(none_.data(), off_.data(), force_.data(), impulses.data());
    force_ -= step;
    return force_.lpNorm<Eigen::Infinity>();
  };
  const double of_places = missed(moved_, lambda_) / (1 + after.q.lpNorm<Eigen::Infinity>());
  const double of_rates = missed(turned_, nu_) / (1 + after.v.lpNorm<Eigen::Infinity>());
  set_slopes(after);
  return std::max(of_places, of_rates);
}

void SpatialProjectionLinearization::set_slopes(const State& after) {
  const auto& joints = system_.scene().joints;
  const Eigen::Index dof = system_.dof();
  push_slopes_.clear(), rate_slopes_.clear();
  const auto evaluate = [&](Terms& terms) {
    for (std::size_t j = 0; j < joints.size(); ++j)
      slopes_of(joints[j], terms.at, slopes_.data() + system_.first_row(j));
  };
  evaluate(before_);
  for (Eigen::Index i = 0; i < lambda_.size(); ++i)
    for (const Slope& slope : slopes_[static_cast<std::size_t>(i)]) {
      push_slopes_.push_back({slope.of, slope.by, lambda_[i] * slope.value});
      push_slopes_.push_back({dof + slope.of, slope.by, nu_[i] * slope.value});
    }
  evaluate(after_);
  for (Eigen::Index i = 0; i < nu_.size(); ++i)
    for (const Slope& slope : slopes_[static_cast<std::size_t>(i)])
      rate_slopes_.push_back({i, slope.by, slope.value * after.v[slope.of]});
}

void SpatialProjectionLinearization::part_of(const ParameterChangeOf<Spatial>& parameter, SparsePart& part) {
  part.clear();
  const Eigen::Index dof = system_.dof(), joints = system_.joint_rows();
  if (joints == 0) return;
  // of M s = G*ᵀ λ at fixed λ: M δs = −δM s + δG*ᵀ λ
  const auto add = [&](Eigen::Index place, double value) {
    if (value != 0) part.emplace_back(place, value);
  };
  for (Eigen::Index i = 0; i < parameter.mass.size(); ++i)
    add(i, -parameter.mass[i] * moved_[i]), add(dof + i, -parameter.mass[i] * turned_[i]);
  for (const auto& [body, tensor] : parameter.inertia) {
    const Vector3d of_place = tensor * rotation<Spatial>(moved_, body);
    const Vector3d of_rate = tensor * rotation<Spatial>(turned_, body);
    for (Eigen::Index i = 0; i < 3; ++i) {
      const Eigen::Index place = Spatial::kVelocities * static_cast<Eigen::Index>(body) + 3 + i;
      add(place, -of_place[i]), add(dof + place, -of_rate[i]);
    }
  }
  std::vector<Row> rows;
  std::vector<double> phi, rate;
  for (const int joint : parameter.joints) {
    const auto j = static_cast<std::size_t>(joint);
    const int first = system_.first_row(j), count = row_count(system_.scene().joints[j]);
    rows.resize(static_cast<std::size_t>(count)), phi.resize(rows.size()), rate.assign(rows.size(), 0.0);
    for (int i = 0; i < count; ++i) {
      const auto row = static_cast<std::size_t>(i);
      const auto d = parameter.derivative<14>([&](const System& s, std::array<double, 14>& x) {
        std::visit(
            [&](const auto& other) {
              other.rows(before_.at, rows.data());
              const auto entries = entries_of(rows[row]);
              std::copy(entries.begin(), entries.end(), x.begin());
              other.residual(after_.at, phi.data());
              other.rows(after_.at, rows.data());
              if constexpr (requires(double* r) { other.rate(after_.at, r); }) other.rate(after_.at, rate.data());
              x[12] = phi[row], x[13] = apply(rows[row], after_v_.data()) - rate[row];
            },
            s.scene().joints[j]);
      });
      const Row& here = before_.G[static_cast<std::size_t>(first + i)];
      for (std::size_t k = 0; k < 12; ++k)
        if (const Eigen::Index place = place_of_entry(here, k); place >= 0)
          add(place, d[k] * lambda_[first + i]), add(dof + place, d[k] * nu_[first + i]);
      add(2 * dof + first + i, d[12]), add(2 * dof + joints + first + i, d[13]);
    }
  }
}

void SpatialProjectionLinearization::push(const PartsOf& parameters, DirectionBlock& q, DirectionBlock& v) {
  const Eigen::Index dof = system_.dof(), joints = system_.joint_rows(), count = q.cols();
  if (joints == 0) return;
  pushed_.setZero(2 * dof + 2 * joints, count);  // forces of both, then what Φ and the rates are to change by
  apply(push_slopes_, q.data(), pushed_.data(), count);
  for (Eigen::Index j = 0; j < count; ++j)
    for (const auto& [place, value] : (*parameters.first)[static_cast<std::size_t>(j)].*parameters.second)
      pushed_(place, j) += place < 2 * dof ? value : -value;

  there_.setZero(dof, count);
  apply(carry_, q.data(), there_.data(), count);
  double* const of_places = pushed_.data() + 2 * dof * count;
  double* const of_rates = of_places + joints * count;
  for (Eigen::Index i = 0; i < joints; ++i)
    add_rate(after_.G[static_cast<std::size_t>(i)], -1, there_.data(), count, of_places + i * count);
  moves_.resize(dof, count);
  const auto solve = [&](SpatialSaddle& saddle, Eigen::Index force, Eigen::Index rate) {
    for (Eigen::Index j = 0; j < count; ++j) {
      const Eigen::VectorXd f = pushed_.col(j).segment(force, dof), c = pushed_.col(j).segment(rate, joints);
      saddle.solve(f.data(), c.data(), force_.data());
      moves_.col(j) = force_;
    }
  };
  solve(places_, 0, 2 * dof);
  apply(turn_, moves_.data(), there_.data(), count);
  q = there_;

  for (Eigen::Index i = 0; i < joints; ++i)
    add_rate(after_.G[static_cast<std::size_t>(i)], -1, v.data(), count, of_rates + i * count);
  for (const Slope& slope : rate_slopes_)
    add_scaled(count, -slope.value, q.data() + slope.by * count, of_rates + slope.of * count);
  solve(rates_, dof, 2 * dof + joints);
  v += moves_;
}

void SpatialProjectionLinearization::pull(double* q, double* v, Eigen::VectorXd& by) {
  const Eigen::Index dof = system_.dof(), joints = system_.joint_rows();
  by.setZero(2 * dof + 2 * joints);
  if (joints == 0) return;
  Eigen::Map<Eigen::VectorXd> of_q(q, dof), of_v(v, dof);
  double *const of_places = by.data() + 2 * dof, *const of_rates = of_places + joints;
  rates_.solve_adjoint(v, by.data() + dof, of_rates);
  for (Eigen::Index i = 0; i < joints; ++i) {
    of_rates[i] = -of_rates[i];  // the adjoint of the constraint
    apply_transposed(after_.G[static_cast<std::size_t>(i)], of_rates[i], v);
  }
  apply_transposed(rate_slopes_, of_rates, q);
  force_.setZero();
  apply_transposed(turn_, q, force_.data());
  const Eigen::VectorXd of_moves = force_;
  places_.solve_adjoint(of_moves.data(), by.data(), of_places);
  for (Eigen::Index i = 0; i < joints; ++i) {
    of_places[i] = -of_places[i];
    apply_transposed(after_.G[static_cast<std::size_t>(i)], of_places[i], q);
  }
  force_.setZero();
  apply_transposed(carry_, q, force_.data());
  of_q = force_;
  apply_transposed(push_slopes_, by.data(), q);
}

}  // namespace orthant
