#include <orthant/solvers/proof/cone_proof.h>

#include <orthant/solvers/proof/farkas.h>

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>

namespace orthant {
namespace {

constexpr Index kMostCarriers = 400;  // rows with a u: a step takes 20 ms
constexpr double kFaster = 8;         // θ from one centre to the next
constexpr double kLastTheta = 1e12;   // then t is known to 1e-9
constexpr double kCentred = 0.1;      // Newton decrement, squared, of a centre
constexpr int kMostSteps = 50;        // to one centre
constexpr double kClear = 1e-9;       // t that rounding leaves positive
constexpr double kNear = 1e-6;        // |t| that may be meant to be 0

/// det of a second-order cone's vector, without cancellation; of one row its entry.
double determinant(const Eigen::Ref<const Eigen::VectorXd>& c) {
  if (c.size() == 1) return c[0];
  const double length = c.tail(c.size() - 1).norm();
  return (c[0] - length) * (c[0] + length);
}

}  // namespace

bool ConeProof::load(const Lcp& problem) {
  if (!form_.load(problem) || form_.norm_q == 0) return false;
  carriers_.clear(), sign_.clear();
  bool any = false;
  for (int k = 0; k < form_.blocks(); ++k) {
    const cones::Block& b = form_.block(k);
    const bool below = b.lo != -kInf, above = b.hi != kInf;
    if ((below && above && b.lo != b.hi) || (b.parts > 0 && (above || b.lo != 0))) return false;
    if (below && above) continue;
    carriers_.push_back(b.start), sign_.push_back(below ? 1 : above ? -1 : 0);
    any = any || below || above;
  }
  const auto m = static_cast<Index>(carriers_.size());
  if (!any || m > kMostCarriers) return false;
  G_ = Eigen::MatrixXd::Zero(form_.size(), m);
  for (Index i = 0; i < m; ++i) form_.A.for_each_in_row(carriers_[at(i)], [&](Index j, double a) { G_(j, i) = a; });
  set_cones();
  return start();
}

/// C, E and e.
void ConeProof::set_cones() {
  const auto m = static_cast<Index>(carriers_.size());
  Index more = 0, rows = 1, equations = 1;  // v of blocks with several frictions; rows of C, of E
  for (int k = 0; k < form_.blocks(); ++k) {
    const cones::Block& b = form_.block(k);
    const bool free = b.lo == -kInf && b.hi == kInf, fixed = b.lo == b.hi;
    if (b.parts > 1) more += b.parts;
    equations += free;
    rows += free || fixed ? 0 : 1 + b.rows + (b.parts > 1 ? b.parts : 0);
  }
  const Index t = m + more;
  C_ = Eigen::MatrixXd::Zero(rows, t + 1), E_ = Eigen::MatrixXd::Zero(equations, t + 1);
  e_ = Eigen::VectorXd::Zero(equations), e_[0] = 1;
  cones_.clear();
  Index row = 0, equation = 1, v = m, carrier = 0;
  const auto cone = [&](Index count) { cones_.push_back({row, count}), row += count; };
  C_.row(rows - 1).head(m).setZero();
  for (Index i = 0; i < m; ++i) C_(rows - 1, i) = -form_.q[carriers_[at(i)]] / form_.norm_q;
  C_(rows - 1, t) = -1;
  for (int k = 0; k < form_.blocks(); ++k) {
    const cones::Block& b = form_.block(k);
    if (b.lo == b.hi) {
      C_.row(rows - 1).head(m) -= b.lo / form_.norm_q * G_.row(b.start);
      continue;
    }
    const double sign = sign_[at(carrier)];
    if (sign == 0) {
      E_.row(equation++).head(m) = G_.row(b.start), ++carrier;
      continue;
    }
    const double bound = sign > 0 ? b.lo : b.hi;
    if (bound != 0) C_.row(rows - 1).head(m) -= bound / form_.norm_q * G_.row(b.start);
    E_(0, carrier) = sign;
    C_(row, carrier++) = sign, cone(1);  // u
    C_.row(row).head(m) = -sign * G_.row(b.start), C_(row, t) = -1;
    const auto parts = form_.all().parts(b);
    const Index head = row;
    if (parts.size() > 1) cone(1);  // −g_n − t − Σ v_j
    for (const cones::Part& part : parts) {
      Index first = row + 1;
      if (parts.size() > 1) C_(head, v) = -1, C_(row, v++) = 1;  // v_j ≥ μ_j ‖g_T‖
      for (int r = 0; r < part.rows; ++r) C_.row(first++).head(m) = part.mu * G_.row(b.start + part.place + r);
      cone(1 + part.rows);
    }
    if (parts.empty()) cone(1);
  }
  cone(1);
}

bool ConeProof::interior(const Eigen::VectorXd& c) const {
  return std::all_of(cones_.begin(), cones_.end(),
                     [&](const Cone& k) { return c[k.first] > 0 && determinant(c.segment(k.first, k.rows)) > 0; });
}

double ConeProof::barrier(const Eigen::VectorXd& c) const {
  double sum = 0;
  for (const Cone& k : cones_) sum -= std::log(determinant(c.segment(k.first, k.rows)));
  return sum;
}

/// u all alike, v and −t large enough.
bool ConeProof::start() {
  const auto m = static_cast<Index>(carriers_.size());
  const Index t = C_.cols() - 1;
  y_ = Eigen::VectorXd::Zero(t + 1);
  double count = 0;
  for (const double sign : sign_) count += std::abs(sign);
  for (Index i = 0; i < m; ++i) y_[i] = sign_[at(i)] / count;
  Eigen::VectorXd c = C_ * y_;
  for (Index j = m; j < t; ++j)
    for (const Cone& k : cones_)
      if (k.rows > 1 && C_(k.first, j) == 1) y_[j] = 1 + c.segment(k.first + 1, k.rows - 1).norm();
  c = C_ * y_;
  double lack = 0;
  for (const Cone& k : cones_)
    if (C_(k.first, t) != 0) lack = std::max(lack, c.segment(k.first + 1, k.rows - 1).norm() - c[k.first]);
  y_[t] = -1 - 2 * lack;
  return y_.allFinite() && interior(C_ * y_);
}

/// A damped step towards the centre of θ. False: no number, or no room to move.
bool ConeProof::newton_step(double theta, double& decrement) {
  const Index N = C_.cols(), equations = E_.rows();
  const Eigen::VectorXd c = C_ * y_;
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(N);
  gradient[N - 1] = -theta;
  Eigen::MatrixXd scaled = C_;  // rows L C with LᵀL the cone's Hessian
  for (const Cone& k : cones_) {
    const double det = determinant(c.segment(k.first, k.rows));
    auto rows = scaled.middleRows(k.first, k.rows);
    if (k.rows == 1) {
      gradient -= rows.transpose() / det;
      rows /= det;
      continue;
    }
    // −log det: gradient −2 J c / det, Hessian 4 J c cᵀ J / det² − 2 J / det, J = diag(1, −1, …).
    Eigen::VectorXd Jc = c.segment(k.first, k.rows);
    Jc.tail(k.rows - 1) *= -1;
    gradient -= 2 / det * (rows.transpose() * Jc);
    Eigen::MatrixXd hessian = 4 / (det * det) * Jc * Jc.transpose();
    hessian.diagonal().array() += 2 / det;
    hessian(0, 0) -= 4 / det;
    const Eigen::LLT<Eigen::MatrixXd> root(hessian);
    if (root.info() != Eigen::Success) return false;
    rows = (root.matrixU() * rows).eval();
  }
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(N + equations, N + equations);
  system.topLeftCorner(N, N).selfadjointView<Eigen::Lower>().rankUpdate(scaled.transpose());
  system.topLeftCorner(N, N).triangularView<Eigen::StrictlyUpper>() = system.topLeftCorner(N, N).transpose();
  // In units of H's diagonal; −1e-13 on the equations, which may depend on each other.
  const Eigen::VectorXd unit = system.topLeftCorner(N, N).diagonal().cwiseSqrt().cwiseMax(1e-150).cwiseInverse();
  system.topLeftCorner(N, N) = (unit.asDiagonal() * system.topLeftCorner(N, N) * unit.asDiagonal()).eval();
  Eigen::MatrixXd equal = E_ * unit.asDiagonal();
  Eigen::VectorXd miss = e_ - E_ * y_;
  for (Index i = 0; i < equations; ++i)
    if (const double size = equal.row(i).norm(); size > 0) equal.row(i) /= size, miss[i] /= size;
  system.bottomLeftCorner(equations, N) = equal, system.topRightCorner(N, equations) = equal.transpose();
  system.bottomRightCorner(equations, equations).diagonal().setConstant(-1e-13);
  Eigen::VectorXd right(N + equations);
  right << -unit.cwiseProduct(gradient), miss;
  const Eigen::VectorXd solution = system.partialPivLu().solve(right);
  const Eigen::VectorXd step = unit.cwiseProduct(solution.head(N));
  if (!step.allFinite()) return false;
  decrement = (scaled * step).squaredNorm();
  const Eigen::VectorXd dc = C_ * step;
  double alpha = 1 / (1 + std::max(0.0, std::sqrt(decrement) - 0.3));  // long steps are tried first
  for (double longer = 1; longer > alpha; longer /= 2)
    if (interior(c + longer / 0.9 * dc) &&
        barrier(c + longer * dc) - theta * longer * step[N - 1] <= barrier(c) + 1e-12 * std::abs(barrier(c))) {
      alpha = longer;
      break;
    }
  while (alpha > 1e-12 && !interior(c + alpha * dc)) alpha /= 2;
  if (alpha <= 1e-12) return false;
  y_ += alpha * step;
  return true;
}

/// u without entries below that share of its largest.
bool ConeProof::try_proof(const Lcp& problem, double share, const std::function<bool(const Vector&)>& proves) {
  scaled_ = Eigen::VectorXd::Zero(form_.size());
  double most = 0;
  for (std::size_t i = 0; i < carriers_.size(); ++i) most = std::max(most, std::abs(y_[static_cast<Index>(i)]));
  for (std::size_t i = 0; i < carriers_.size(); ++i)
    if (const double u = y_[static_cast<Index>(i)]; std::abs(u) > share * most) scaled_[carriers_[i]] = u;
  form_.from_scaled(scaled_, u_);
  tidy_certificate(problem, u_);
  if (!u_.allFinite()) return false;
  if (proves(u_)) return true;
  return in_whole_numbers(u_) && proves(u_);
}

ConeProof::End ConeProof::search(const Lcp& problem, const Budget& budget,
                                 const std::function<bool(const Vector&)>& proves) {
  if (!load(problem)) return End::open;
  double degree = 0;
  for (const Cone& k : cones_) degree += k.rows > 1 ? 2 : 1;
  const double& t = y_[y_.size() - 1];
  bool moves = true;
  double tried = kClear;
  for (double theta = degree / std::max(1.0, -t); moves && theta <= kLastTheta; theta *= kFaster) {
    double decrement = kInf;
    for (int step = 0; step < kMostSteps && decrement > kCentred && moves; ++step) {
      if (budget.exhausted()) return End::open;
      moves = newton_step(theta, decrement);
    }
    const double off = (e_ - E_ * y_).lpNorm<Eigen::Infinity>();
    if (off > 1e-9) continue;
    if (t > tried) {
      if (try_proof(problem, 1e-14, proves)) return End::proved;
      tried = 10 * t;
    }
    if (decrement <= kCentred && t + 2 * degree / theta < -kClear) return End::none;
  }
  for (const double share : {1e-5, 1e-3})
    if (t > -kNear && !budget.exhausted() && try_proof(problem, share, proves)) return End::proved;
  return End::open;
}

}  // namespace orthant
