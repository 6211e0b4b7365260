#include <orthant/solvers/active_set/newton_fb.h>

#include <orthant/solvers/active_set/fischer_burmeister.h>
#include <orthant/solvers/factorization_count.h>
#include <orthant/solvers/linear_algebra/sparse_budget.h>

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <Eigen/UmfPackSupport>

#include <algorithm>
#include <array>
#include <cmath>

namespace orthant {

using detail::complementarity_row;
using detail::Slope;

namespace {

constexpr std::array kWeights = {1.0, 1e-3, 1e-6, 1e-9};  // of d z relative to w
constexpr Index kDenseRows = 5000;                        // rows of a dense factorization, friction in its pure form
constexpr int kRefinements = 8;                           // of frozen friction, in one run
constexpr double kNear = 1e-3;                            // of b: merits that count as near the end
constexpr int kHalving = 40;                              // iterations in which ‖Φ‖ should halve

}  // namespace

std::string NewtonFb::why_not(const Lcp& problem) const {
  const Index n = problem.size() + 3 * static_cast<Index>(problem.friction.size());
  if (n <= kDenseRows || (std::holds_alternative<RowSparse>(problem.A) && problem.friction.empty())) return {};
  return "n = " + std::to_string(n) + ": dense problems take at most " + std::to_string(kDenseRows) + " rows";
}

Claim NewtonFb::run(const Lcp& problem, Solution& s, Start) {
  weight_of_z_ = kWeights[0];
  patient_ = false;
  start_ = s.z;
  return attempt(problem, s);
}

bool NewtonFb::run_again(const Lcp& problem, Solution& s, int attempt, Claim& claim) {
  if (problem.size() == 0) return false;
  const bool friction = !problem.friction.empty();
  if (!friction && --attempt == 0) {
    light_rows(problem, s);
    return true;
  }
  if (friction && (attempt -= 2) <= 0) {
    log(s.iterations, s.residual, 0, "bounds of friction frozen");
    s.z = start_;
    if (attempt == 0) s.z.setZero();
    refinements_ = kRefinements;
    claim = frozen_.iterate(problem, s.z, budget(), [this, &s](const Lcp& box, Vector& z) {
      y_ = z;
      const Claim round = in_good_units(box, s);
      z = y_.cwiseMax(box.lo).cwiseMin(box.hi);
      // Redundant contacts under large mass ratios: near the end the merit does not tell; elsewhere this would lead
      // nowhere.
      if (near_ && refinements_-- > 0 && !polish_.improve(box, z, budget())) proximal(box, s, z);
      return round;
    });
    return true;
  }
  const bool warm = !friction && (start_.array() != 0).any();  // what led nowhere is not started from again
  const auto index = static_cast<std::size_t>(warm ? attempt - 1 : attempt);
  if (index > kWeights.size()) return false;
  patient_ = index == kWeights.size();
  weight_of_z_ = patient_ ? kWeights[0] : kWeights[index];
  s.z = start_;
  if (warm) s.z.setZero();
  log(s.iterations, s.residual, 0, patient_ ? "patiently" : index == 0 ? "from zero" : "z weighs less");
  claim = this->attempt(problem, s);
  if (!friction) light_rows(problem, s);
  return true;
}

/// Without friction. The merit adds up rows: near the end a light one may not be right yet.
void NewtonFb::light_rows(const Lcp& problem, Solution& s) {
  if (near_) polish_.improve(problem, s.z, budget(), true);
}

Claim NewtonFb::attempt(const Lcp& problem, Solution& s) {
  if (problem.size() == 0) return Claim::candidate;
  const bool reduced = !problem.friction.empty();
  const Lcp& pure = reduced ? pyramid_.pure(problem) : problem;
  if (reduced)
    pyramid_.guess(problem, s.z, y_);
  else
    y_ = s.z;
  const Claim claim = in_good_units(pure, s);
  y_ = y_.cwiseMax(pure.lo).cwiseMin(pure.hi);  // a rounding outside is none of the answer's
  if (reduced)
    pyramid_.restore(problem, y_, s.z);
  else
    s.z = y_;
  return claim;
}

/// A + δ diag A, and b + δ z, is regular where A is singular, and its solutions lead to one of A's: redundant contacts
/// under large mass ratios, where the merit of A itself no longer tells good from bad. Rockafellar's proximal point.
void NewtonFb::proximal(const Lcp& box, Solution& s, Vector& z) {
  constexpr double kProximal = 1e-4;
  constexpr int kRounds = 12;
  proximal_ = box;
  auto& A = as<DenseMatrix>(proximal_.A);
  to_dense(box.A, A);
  shift_ = kProximal * A.diagonal();
  A.diagonal() += shift_;
  for (int round = 0; round < kRounds && !budget().exhausted(); ++round) {
    proximal_.b = box.b - shift_.cwiseProduct(z);
    y_ = z;
    in_good_units(proximal_, s);
    z = y_.cwiseMax(box.lo).cwiseMin(box.hi);
    if (polish_.improve(box, z, budget())) return;
  }
}

/// The merit adds up rows: where their units lie far apart, they are brought together first.
Claim NewtonFb::in_good_units(const Lcp& p, Solution& s) {
  scaling_.clear();
  std::visit(
      [this](const auto& A) {
        if constexpr (requires { scaling_.fit(A); }) scaling_.fit(A);  // not a Delassus operator
      },
      p.A);
  if (scaling_.trivial()) return iterate(p, s, y_);
  scaling_.apply(p, scaled_);
  y_.array() /= scaling_.col.array();
  const Claim claim = iterate(scaled_, s, y_);
  y_.array() *= scaling_.col.array();
  return claim;
}

double NewtonFb::merit(const Lcp& p, const Vector& z) {
  multiply(p.A, z, w_, scratch_);
  w_ += p.b;
  phi_.resize(z.size());
  for (Index i = 0; i < z.size(); ++i) phi_[i] = complementarity_row(scale_[i], z[i], w_[i], p.lo[i], p.hi[i]).value;
  return 0.5 * phi_.squaredNorm();
}

void NewtonFb::element(const Lcp& p, const Vector& z) {
  da_.resize(z.size()), db_.resize(z.size());
  for (Index i = 0; i < z.size(); ++i) {
    const Slope s = complementarity_row(scale_[i], z[i], w_[i], p.lo[i], p.hi[i]);
    da_[i] = s.da, db_[i] = s.db;
  }
}

bool NewtonFb::direction(const Lcp& p, double weight) {
  count_factorization(p.size());
  if (const auto* sparse = std::get_if<RowSparse>(&p.A)) {
    Eigen::SparseMatrix<double, Eigen::RowMajor> V = db_.asDiagonal() * sparse->view();
    Eigen::SparseMatrix<double, Eigen::RowMajor> diagonal_part(p.size(), p.size());
    diagonal_part.setIdentity();
    V += Eigen::SparseMatrix<double, Eigen::RowMajor>(da_.asDiagonal() * diagonal_part);
    gradient_ = V.transpose() * phi_;
    const auto affords = [this](const Eigen::SparseMatrix<double>& M, double orderings) {
      return affords_factorization(&budget(), static_cast<int>(M.rows()), M.outerIndexPtr(), M.innerIndexPtr(),
                                   orderings);
    };
    if (weight == 0) {
      const Eigen::SparseMatrix<double> columns = V;
      if (!affords(columns, kUmfpackOrderings)) return false;
      Eigen::UmfPackLU<Eigen::SparseMatrix<double>> lu(columns);
      if (lu.info() != Eigen::Success) return false;
      const Eigen::VectorXd rhs = -phi_;
      d_ = lu.solve(rhs);
    } else {
      Eigen::SparseMatrix<double> normal = V.transpose() * V, identity(p.size(), p.size());
      identity.setIdentity();
      normal += weight * normal.diagonal().maxCoeff() * identity;
      if (!affords(normal, 1)) return false;
      const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> cholesky(normal);
      if (cholesky.info() != Eigen::Success) return false;
      const Eigen::VectorXd rhs = -gradient_;
      d_ = cholesky.solve(rhs);
    }
    return d_.allFinite();
  }
  const DenseMatrix& A = dense_of(p.A, dense_);
  const Index n = p.size();
  DenseLu<double>::Dense V(lu_.reset(n), n, n);
  V = db_.asDiagonal() * A;
  V.diagonal() += da_;
  gradient_.resize(n);
  gradient_.noalias() = V.transpose() * phi_;
  if (weight == 0) {
    d_ = -phi_;
    if (lu_.factorize(0, &budget()) < n) return false;
    lu_.solve(d_.data());
  } else {
    normal_.A.resize(n, n);
    normal_.A.noalias() = V.transpose() * V;
    normal_.A.diagonal().array() += weight * normal_.A.diagonal().maxCoeff();
    if (!normal_.factorize(0)) return false;
    d_ = -gradient_;
    normal_.solve(d_);
  }
  return d_.allFinite();
}

/// The rows' sides as (z, w) shows them, solved for, or where they repeat each other the solution next to z; taken when
/// the merit falls.
bool NewtonFb::polish(const Lcp& p, Vector& z) {
  const double before = merit(p, z);
  rows_.z = z;
  rows_.w = w_;
  for (Index i = 0; i < p.size(); ++i) rows_.side[static_cast<std::size_t>(i)] = rows_.target(i);
  for (const bool near : {false, true}) {
    if (!(near ? rows_.solve_near(z) : rows_.solve())) continue;
    trial_ = rows_.z.cwiseMax(p.lo).cwiseMin(p.hi);
    if (merit(p, trial_) < before) {
      z = trial_;
      return true;
    }
  }
  return merit(p, z), false;
}

Claim NewtonFb::iterate(const Lcp& p, Solution& s, Vector& z) {
  rows_.load(p, z, budget());
  scale_.resize(p.size());
  for (Index i = 0; i < p.size(); ++i) scale_[i] = weight_of_z_ * rows_.scale(i);
  double now = merit(p, z);
  const double size = p.size() > 0 ? p.b.lpNorm<Eigen::Infinity>() : 0;
  recent_.assign(1, now);
  double best = kInf;
  int creeping = 0;
  for (int begun = s.iterations; s.iterations - begun < options_.max_iterations;) {
    creeping = now < 0.25 * best ? 0 : creeping + 1;
    best = creeping == 0 ? now : best;
    if (!patient_ && creeping > kHalving) return Claim::stalled;
    near_ = std::sqrt(now) <= kNear * size;
    if (std::sqrt(now) <= 1e-15 * size) return Claim::candidate;
    if (std::sqrt(now) <= 1e-4 * size && polish(p, z)) {
      const double polished = merit(p, z);
      log(s.iterations, std::sqrt(polished), 1, "active rows solved");
      if (std::sqrt(polished) <= 1e-12 * size) return Claim::candidate;
      now = polished;
    }
    ++s.iterations;
    element(p, z);
    const double limit = *std::max_element(recent_.begin(), recent_.end());
    bool moved = false;
    double length = 0;
    for (double weight = 0; !moved && weight < 1e3 && !budget().exhausted();
         weight = weight == 0 ? 1e-12 : weight * 1e3) {
      merit(p, z);  // w and Φ at z, which the line search has overwritten
      if (!direction(p, weight)) continue;
      const double slope = gradient_.dot(d_);
      if (!(slope < -1e-12 * d_.norm() * gradient_.norm())) continue;
      for (length = 1; length > 1e-6 && !moved; length /= 2) {
        trial_ = z + length * d_;
        const double value = merit(p, trial_);
        if (value <= limit + 1e-4 * length * slope && value < 1e300) {
          z = trial_, now = value, moved = true;
          break;
        }
      }
    }
    log(s.iterations, std::sqrt(now), moved ? length : 0, moved ? "" : "no descent");
    if (!moved) {
      polish(p, z);
      return Claim::candidate;  // nothing improves it: the judge says whether it is enough
    }
    if (recent_.size() >= static_cast<std::size_t>(options_.memory)) recent_.erase(recent_.begin());
    recent_.push_back(now);
    if (budget().exhausted()) return Claim::time_limit;
  }
  polish(p, z);
  return Claim::iteration_limit;
}

}  // namespace orthant
