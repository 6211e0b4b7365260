#include <orthant/integrators/derivatives/projection_linearization.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace orthant {

namespace {

constexpr Eigen::Index kDenseJoints = 48;

using MapX = Eigen::Map<Eigen::VectorXd>;
using ConstMapX = Eigen::Map<const Eigen::VectorXd>;

double relative(const Eigen::VectorXd& left, const Eigen::VectorXd& x) {
  return left.size() > 0 ? left.lpNorm<Eigen::Infinity>() / (1 + x.lpNorm<Eigen::Infinity>()) : 0;
}

}  // namespace

ProjectionLinearization::ProjectionLinearization(const System& system)
    : system_(system),
      before_(system),
      after_(system),
      basic_(system),
      slopes_(static_cast<std::size_t>(system.joint_rows())),
      none_(Eigen::VectorXd::Zero(system.dof())),
      unused_(system.dof()),
      unused_joints_(system.joint_rows()) {
  for (auto* x : {&lambda_, &nu_, &off_, &x_, &left_}) x->setZero(system.joint_rows());
}

void ProjectionLinearization::rates(const std::vector<Row>& rows, const double* x, double* to) const {
  for (std::size_t i = 0; i < rows.size(); ++i) to[i] = apply(rows[i], x);
}

void ProjectionLinearization::impulses(const std::vector<Row>& rows, const double* lambda, double* to) const {
  for (std::size_t i = 0; i < rows.size(); ++i) apply_transposed(rows[i], lambda[i], to);
}

double ProjectionLinearization::set_up(double t, const Eigen::VectorXd& q_before, const Eigen::VectorXd& v_before,
                                       const State& after) {
  const Eigen::Index joints = system_.joint_rows();
  after_v_ = after.v, moved_ = after.q - q_before, turned_ = after.v - v_before;
  if (joints == 0) return std::max(relative(moved_, after.q), relative(turned_, after.v));
  set_poses(system_, t, q_before, before_.at);
  evaluate_joint_rows(system_, before_);
  set_poses(system_, t, after.q, after_.at);
  evaluate_joint_rows(system_, after_);
  dense_ = joints <= kDenseJoints;
  fill_rows();
  if (dense_) {
    form();
    dense_ = factorize();
  }
  if (!dense_ && !basic_.factorize(system_, before_)) throw std::runtime_error("derivatives of a step: not finite");
  pushed_.resize(system_.dof(), 2), pushed_ << moved_, turned_;
  off_block_.setZero(joints, 2), lambda_block_.resize(joints, 2);
  apply(rates_, pushed_.data(), off_block_.data(), 2);
  correct(off_block_.data(), lambda_block_.data(), 2);
  lambda_ = lambda_block_.col(0), nu_ = lambda_block_.col(1);
  apply(pushes_, lambda_block_.data(), pushed_.data(), 2);
  const double missed = std::max(relative(pushed_.col(0), after.q), relative(pushed_.col(1), after.v));

  q_push_slopes_.clear(), v_push_slopes_.clear(), rate_slopes_.clear();
  const auto& scene = system_.scene();
  for (std::size_t j = 0; j < scene.joints.size(); ++j)
    slopes_of(scene.joints[j], before_.at, slopes_.data() + system_.first_row(j));
  const double* const inverse_mass = system_.inverse_mass().data();
  for (Eigen::Index i = 0; i < joints; ++i)
    for (const Slope& slope : slopes_[static_cast<std::size_t>(i)]) {
      const double by = slope.value * inverse_mass[slope.of];
      q_push_slopes_.push_back({slope.of, slope.by, lambda_[i] * by});
      v_push_slopes_.push_back({slope.of, slope.by, nu_[i] * by});
    }
  for (std::size_t j = 0; j < scene.joints.size(); ++j)
    slopes_of(scene.joints[j], after_.at, slopes_.data() + system_.first_row(j));
  for (Eigen::Index i = 0; i < joints; ++i)
    for (const Slope& slope : slopes_[static_cast<std::size_t>(i)])
      rate_slopes_.push_back({i, slope.by, slope.value * after.v[slope.of]});
  return missed;
}

// rates_ and pushes_, whose places stay the same.
void ProjectionLinearization::fill_rows() {
  if (rates_.empty())
    for (Eigen::Index i = 0; i < system_.joint_rows(); ++i) {
      each_entry(after_.G[static_cast<std::size_t>(i)], [&](Eigen::Index place, double /*j*/) {
        rates_.push_back({i, place, 0});
      });
      each_entry(before_.G[static_cast<std::size_t>(i)], [&](Eigen::Index place, double /*j*/) {
        pushes_.push_back({place, i, 0});
      });
    }
  Slope* rate = rates_.data();
  for (const Row& row : after_.G) each_entry(row, [&](Eigen::Index /*place*/, double j) { (rate++)->value = j; });
  Slope* push = pushes_.data();
  const double* const inverse_mass = system_.inverse_mass().data();
  for (const Row& row : before_.G)
    each_entry(row, [&](Eigen::Index place, double j) { (push++)->value = -j * inverse_mass[place]; });
}

void ProjectionLinearization::form() {
  const Eigen::Index joints = system_.joint_rows();
  if (coupled_.empty()) {  // bodies and places stay the same
    S_.resize(joints, joints);
    for (Eigen::Index i = 0; i < joints; ++i)
      for (Eigen::Index j = 0; j < joints; ++j) {
        const Row &rate = after_.G[static_cast<std::size_t>(i)], &push = before_.G[static_cast<std::size_t>(j)];
        const auto couple = [&](BodyId body, const Row::Entries& of_rate, BodyId other, const Row::Entries& of_push) {
          if (body >= 0 && body == other)
            coupled_.push_back(
                {of_rate.data(), of_push.data(), system_.inverse_mass().data() + kBlock * body, &S_(i, j)});
        };
        couple(rate.a, rate.ja, push.a, push.ja), couple(rate.a, rate.ja, push.b, push.jb);
        couple(rate.b, rate.jb, push.a, push.ja), couple(rate.b, rate.jb, push.b, push.jb);
      }
  }
  S_.setZero();
  for (const Coupled& c : coupled_)
    *c.S += c.rate[0] * c.inverse_mass[0] * c.push[0] + c.rate[1] * c.inverse_mass[1] * c.push[1] +
            c.rate[2] * c.inverse_mass[2] * c.push[2];
}

// L U with partial pivoting.
bool ProjectionLinearization::factorize() {
  const Eigen::Index n = S_.rows();
  row_.resize(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) row_[static_cast<std::size_t>(i)] = i;
  const double smallest = 1e-11 * S_.cwiseAbs().maxCoeff();  // redundant joints leave rounding
  for (Eigen::Index k = 0; k < n; ++k) {
    Eigen::Index p = k;
    for (Eigen::Index i = k + 1; i < n; ++i)
      if (std::abs(S_(i, k)) > std::abs(S_(p, k))) p = i;
    if (!(std::abs(S_(p, k)) > smallest)) return false;
    if (p != k)
      S_.row(p).swap(S_.row(k)), std::swap(row_[static_cast<std::size_t>(p)], row_[static_cast<std::size_t>(k)]);
    double* const __restrict pivot = S_.data() + n * k;
    pivot[k] = 1 / pivot[k];
    for (Eigen::Index i = k + 1; i < n; ++i) {
      double* const __restrict row = S_.data() + n * i;
      if (row[k] == 0) continue;
      const double factor = row[k] *= pivot[k];
      for (Eigen::Index j = k + 1; j < n; ++j) row[j] -= factor * pivot[j];
    }
  }
  return true;
}

void ProjectionLinearization::correct(const double* off, double* lambda, Eigen::Index count) {
  const Eigen::Index n = system_.joint_rows();
  if (dense_) return solve_block(S_.data(), row_.data(), n, off, lambda, count);
  for (Eigen::Index j = 0; j < count; ++j) {
    for (Eigen::Index i = 0; i < n; ++i) off_[i] = off[i * count + j];
    iterate(before_, after_, off_.data(), unused_joints_.data());
    for (Eigen::Index i = 0; i < n; ++i) lambda[i * count + j] = unused_joints_[i];
  }
}

void ProjectionLinearization::correct_transposed(const double* off, double* lambda) {
  const Eigen::Index n = system_.joint_rows();
  if (!dense_) return iterate(after_, before_, off, lambda);
  x_ = ConstMapX(off, n);
  for (Eigen::Index j = 0; j < n; ++j) {
    x_[j] *= S_(j, j);
    for (Eigen::Index i = j + 1; i < n; ++i) x_[i] -= S_(j, i) * x_[j];
  }
  for (Eigen::Index j = n - 1; j >= 0; --j)
    for (Eigen::Index i = 0; i < j; ++i) x_[i] -= S_(j, i) * x_[j];
  for (Eigen::Index i = 0; i < n; ++i) lambda[row_[static_cast<std::size_t>(i)]] = x_[i];
}

void ProjectionLinearization::iterate(const Terms& push, const Terms& rate, const double* off, double* lambda) {
  constexpr int kPasses = 30;
  const Eigen::Index joints = system_.joint_rows();
  MapX to(lambda, joints);
  left_ = ConstMapX(off, joints), to.setZero();
  double before = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass < kPasses; ++pass) {
    const double now = left_.lpNorm<Eigen::Infinity>();
    if (!(now < 0.5 * before)) break;
    before = now;
    basic_.solve(none_.data(), left_.data(), unused_.data(), x_.data());
    to += x_;
    unused_.setZero();
    impulses(push.G, lambda, unused_.data());
    unused_ = unused_.cwiseProduct(system_.inverse_mass()).eval();
    rates(rate.G, unused_.data(), left_.data());
    left_ = ConstMapX(off, joints) - left_;
  }
}

void ProjectionLinearization::part_of(const ParameterChange& parameter, SparsePart& part) {
  part.clear();
  const Eigen::Index dof = system_.dof(), joints = system_.joint_rows();
  if (joints == 0) return;
  if (parameter.mass.size() > 0)
    for (Eigen::Index i = 0; i < dof; ++i)
      if (const double by = parameter.mass[i] * system_.inverse_mass()[i]; by != 0) {
        part.emplace_back(i, -by * moved_[i]);
        part.emplace_back(dof + i, -by * turned_[i]);
      }
  const auto add = [&](Eigen::Index place, double value) {
    if (value != 0) part.emplace_back(place, value);
  };
  for (const int joint : parameter.joints) {
    const auto j = static_cast<std::size_t>(joint);
    const int first = system_.first_row(j), count = row_count(system_.scene().joints[j]);
    std::vector<Row> rows(static_cast<std::size_t>(count));
    std::vector<double> phi(rows.size()), rate(rows.size());
    for (int i = 0; i < count; ++i) {
      const auto row = static_cast<std::size_t>(i);
      const Row& here = before_.G[static_cast<std::size_t>(first) + row];
      const auto d = parameter.derivative<8>([&](const System& s, std::array<double, 8>& x) {
        std::visit(
            [&](const auto& other) {
              other.rows(before_.at, rows.data());
              const auto entries = entries_of(rows[row]);
              std::copy(entries.begin(), entries.end(), x.begin());
              other.residual(after_.at, phi.data());
              other.rows(after_.at, rows.data());
              if constexpr (requires(double* r) { other.rate(after_.at, r); }) other.rate(after_.at, rate.data());
              x[6] = phi[row], x[7] = apply(rows[row], after_v_.data()) - rate[row];
            },
            s.scene().joints[j]);
      });
      for (int k = 0; k < 6; ++k) {
        const BodyId body = k < 3 ? here.a : here.b;
        if (body < 0) continue;
        const Eigen::Index place = kBlock * body + k % 3;
        const double by = d[static_cast<std::size_t>(k)] * system_.inverse_mass()[place];
        add(place, by * lambda_[first + i]), add(dof + place, by * nu_[first + i]);
      }
      add(2 * dof + first + i, d[6]), add(2 * dof + joints + first + i, d[7]);
    }
  }
}

void ProjectionLinearization::close(Eigen::Index count, double* off, double* x) {
  lambda_block_.resize(system_.joint_rows(), count);
  apply(rates_, x, off, count);
  correct(off, lambda_block_.data(), count);
  apply(pushes_, lambda_block_.data(), x, count);
}

void ProjectionLinearization::push(const PartsOf& parameters, DirectionBlock& q, DirectionBlock& v) {
  const Eigen::Index dof = system_.dof(), joints = system_.joint_rows(), count = q.cols();
  if (joints == 0) return;
  pushed_.setZero(dof, count), off_block_.setZero(2 * joints, count);  // Φ̇_p, then (G⁺ v⁺ − ṡ)˙
  apply(v_push_slopes_, q.data(), v.data(), count);
  apply(q_push_slopes_, q.data(), pushed_.data(), count);
  q += pushed_;
  for (Eigen::Index j = 0; j < count; ++j)
    for (const auto& [place, value] : (*parameters.first)[static_cast<std::size_t>(j)].*parameters.second)
      (place < dof ? q(place, j) : place < 2 * dof ? v(place - dof, j) : off_block_(place - 2 * dof, j)) += value;
  double* const of_rates = off_block_.data() + joints * count;
  close(count, off_block_.data(), q.data());
  apply(rate_slopes_, q.data(), of_rates, count);
  close(count, of_rates, v.data());
}

void ProjectionLinearization::pull(double* q, double* v, Eigen::VectorXd& by) {
  const Eigen::Index dof = system_.dof(), joints = system_.joint_rows();
  by.setZero(2 * dof + 2 * joints);
  if (joints == 0) return;
  MapX of_q(q, dof), of_v(v, dof);
  const auto open = [&](MapX& x, double* kappa) {  // x ← x − G⁺ᵀ κ
    force_ = x.cwiseProduct(system_.inverse_mass());
    rates(before_.G, force_.data(), off_.data());
    correct_transposed(off_.data(), kappa);
    for (Eigen::Index i = 0; i < joints; ++i) {
      apply_transposed(after_.G[static_cast<std::size_t>(i)], -kappa[i], x.data());
      kappa[i] = -kappa[i];  // the adjoint of the constraint
    }
  };
  double* const of_rate = by.data() + 2 * dof + joints;
  open(of_v, of_rate);
  apply_transposed(rate_slopes_, of_rate, q);
  open(of_q, by.data() + 2 * dof);
  by.head(dof) = of_q, by.segment(dof, dof) = of_v;
  apply_transposed(q_push_slopes_, by.data(), q);
  apply_transposed(v_push_slopes_, by.data() + dof, q);
}

}  // namespace orthant
