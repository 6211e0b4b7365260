// Semismooth Newton on the Fischer-Burmeister function, globalized by a line search, on distributed rows.
#include <orthant/solvers/active_set/fischer_burmeister.h>
#include <orthant/solvers/distributed/distributed_newton.h>

#include <algorithm>
#include <cmath>

namespace orthant::distributed {
namespace {

constexpr double kStepRtol = 1e-6;        // of a Newton step
constexpr double kNearEnd = 1e-3;         // of ‖b‖: merits from which on the active rows are solved for
constexpr std::size_t kSearchMemory = 5;  // of the line search
constexpr int kHalvingWithin = 40;        // iterations in which ‖Φ‖ should halve

}  // namespace

double DistributedNewton::dot(const Vector& x, const Vector& y) const {
  double sum = 0;
  for (Index i = 0; i < problem_.rows(); ++i) sum += x[i] * y[i];
  return sum_of_all(problem_.comm(), sum);
}

double DistributedNewton::merit(Vector& z) {
  const Index m = problem_.rows();
  problem_.residual(z, w_);
  for (Vector* each : {&phi_, &da_, &db_}) each->resize(m);
  for (Index i = 0; i < m; ++i) {
    const detail::Slope s =
        detail::complementarity_row(problem_.scale()[i], z[i], w_[i], problem_.lo()[i], problem_.hi()[i]);
    phi_[i] = s.value, da_[i] = -s.da, db_[i] = -s.db;
  }
  return 0.5 * dot(phi_, phi_);
}

/// V d = −Φ, for −V, whose rows have the signs of A. False: not solved, or no descent; gradient_ = VᵀΦ in any case.
bool DistributedNewton::direction() {
  const MPI_Comm comm = problem_.comm();
  const Index m = problem_.rows();
  if (v_ == nullptr) require(MatDuplicate(problem_.matrix(), MAT_DO_NOT_COPY_VALUES, v_.out()));
  direction_.resize(m), gradient_.resize(m);
  const OwnedVec da = view(comm, da_, m), db = view(comm, db_, m), phi = view(comm, phi_, m);
  const OwnedVec d = view(comm, direction_, m), g = view(comm, gradient_, m);
  require(MatCopy(problem_.matrix(), v_, SAME_NONZERO_PATTERN));
  require(MatDiagonalScale(v_, db, nullptr));
  require(MatDiagonalSet(v_, da, ADD_VALUES));
  require(MatMultTranspose(v_, phi, g));
  gradient_ = -gradient_;
  direction_.setZero();
  krylov_of_v_.load(v_);
  if (!krylov_of_v_.solve(phi, d, kStepRtol)) return false;
  return dot(direction_, gradient_) < -1e-12 * std::sqrt(dot(direction_, direction_) * dot(gradient_, gradient_));
}

/// The step along −VᵀΦ that is best for the linearized Φ.
void DistributedNewton::descend() {
  const Index m = problem_.rows();
  direction_ = -gradient_;
  product_.resize(m);
  const OwnedVec d = view(problem_.comm(), direction_, m), product = view(problem_.comm(), product_, m);
  require(MatMult(v_, d, product));
  const double curvature = dot(product_, product_), slope = dot(gradient_, gradient_);
  if (curvature > 0) direction_ *= slope / curvature;
}

/// Shortens the step until the merit falls below the limit; z_ ← its end.
bool DistributedNewton::search(double limit, double& now, double& length) {
  const Index m = problem_.rows();
  const double slope = dot(direction_, gradient_);
  trial_.resize(m + problem_.halo());
  for (length = 1; length > 1e-6; length /= 2) {
    for (Index i = 0; i < m; ++i) trial_[i] = z_[i] + length * direction_[i];
    const double value = merit(trial_);
    if (!(value <= limit + 1e-4 * length * slope && value < 1e300)) continue;
    z_.swap(trial_);
    now = value;
    return true;
  }
  return false;
}

/// The sides that (z, w) shows, solved for; taken when the judge does or the merit falls. w_ must be that of z_.
bool DistributedNewton::polish(double& now, NewtonSolution& s) {
  const Index m = problem_.rows();
  block_.z = z_, block_.w = w_;
  block_.choose();
  if (!block_.step(kStepRtol)) return false;
  if (accepted(block_.z, s)) return true;
  trial_ = block_.z;
  for (Index i = 0; i < m; ++i) trial_[i] = std::clamp(trial_[i], problem_.lo()[i], problem_.hi()[i]);
  const double value = merit(trial_);
  if (value < now) {
    z_.swap(trial_);
    now = value;
  } else {
    merit(z_);
  }
  return false;
}

Claim DistributedNewton::semismooth(NewtonSolution& s) {
  const MPI_Comm comm = problem_.comm();
  const Index m = problem_.rows();
  z_ = block_.z;
  for (Index i = 0; i < m; ++i) z_[i] = std::clamp(z_[i], problem_.lo()[i], problem_.hi()[i]);
  double own = 0;
  for (Index i = 0; i < m; ++i) own = std::max(own, std::abs(problem_.b()[i]));
  const double size = largest_of_all(comm, own);
  double now = merit(z_), best = kInf;
  std::vector<double> recent(1, now);
  int creeping = 0;
  for (const int begun = s.iterations; s.iterations - begun < options_.max_iterations;) {
    if (accepted(z_, s)) return Claim::candidate;
    if (!(now < 1e300)) return Claim::stalled;
    creeping = now < 0.25 * best ? 0 : creeping + 1;
    best = creeping == 0 ? now : best;
    if (creeping > kHalvingWithin) return Claim::stalled;
    if (std::sqrt(now) <= kNearEnd * size && polish(now, s)) return Claim::candidate;
    ++s.iterations;
    const double limit = *std::max_element(recent.begin(), recent.end());
    double length = 0;
    bool newton = direction(), moved = newton && search(limit, now, length);
    if (!newton) s.reason = krylov_of_v_.why();
    if (stop()) return interrupted();
    if (!moved) {
      newton = false;
      descend();
      moved = search(limit, now, length);
    }
    log(s.iterations, std::sqrt(now), moved ? length : 0, newton ? "newton" : moved ? "gradient" : "no descent");
    if (!moved) {
      merit(z_);
      polish(now, s);
      return has_answer(best_.status) ? Claim::candidate : Claim::stalled;
    }
    if (recent.size() >= kSearchMemory) recent.erase(recent.begin());
    recent.push_back(now);
  }
  return Claim::iteration_limit;
}

}  // namespace orthant::distributed
