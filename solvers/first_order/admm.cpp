#include <orthant/solvers/first_order/admm.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace orthant {
namespace {

/// A + diag(s), every diagonal entry stored.
void shift(const RowSparse& A, const Vector& s, RowSparse& sum) {
  sum.rows = sum.cols = A.rows;
  sum.start.assign(1, 0), sum.column.clear(), sum.value.clear();
  const auto add = [&sum](int j, double value) { sum.column.push_back(j), sum.value.push_back(value); };
  for (int i = 0; i < static_cast<int>(A.rows); ++i) {
    auto k = static_cast<std::size_t>(A.start[static_cast<std::size_t>(i)]);
    const auto end = static_cast<std::size_t>(A.start[static_cast<std::size_t>(i) + 1]);
    for (; k < end && A.column[k] < i; ++k) add(A.column[k], A.value[k]);
    add(i, s[i]);
    if (k < end && A.column[k] == i) sum.value.back() += A.value[k++];
    for (; k < end; ++k) add(A.column[k], A.value[k]);
    sum.start.push_back(static_cast<int>(sum.value.size()));
  }
}

RowSparse inner(const Delassus& A, const Vector& s) {
  using Sparse = Eigen::SparseMatrix<double, Eigen::RowMajor>;
  Sparse K(A.W.cols, A.W.cols);
  K.setIdentity();
  const Sparse B = A.W.view() * A.inverse_mass.cwiseSqrt().asDiagonal();
  const Sparse scaled = s.cwiseSqrt().cwiseInverse().asDiagonal() * B;
  K += Sparse(Sparse(scaled.transpose()) * scaled);
  return RowSparse::from(K);
}

}  // namespace

void Admm::factorize(const Lcp& problem) {
  s_ = rho_ * bounds_.d;
  for (Index i = 0; i < s_.size(); ++i) {
    if (bounds_.lo[i] == -kInf && bounds_.hi[i] == kInf) s_[i] *= 1e-3;
    if (bounds_.lo[i] == bounds_.hi[i] && problem.lo[i] == problem.hi[i]) s_[i] *= 1e3;
  }
  if (const auto* delassus = std::get_if<Delassus>(&problem.A)) {
    if (delassus->regularization.size() > 0) s_ += delassus->regularization;
    shifted_ = inner(*delassus, s_);
    if (delassus->regularization.size() > 0) s_ -= delassus->regularization;
  } else if (const auto* sparse = std::get_if<RowSparse>(&problem.A)) {
    shift(*sparse, s_, as<RowSparse>(shifted_));
  } else {
    shifted_ = problem.A;
    std::get<DenseMatrix>(shifted_).diagonal() += s_;
  }
  all_.resize(static_cast<std::size_t>(order(shifted_)));
  std::iota(all_.begin(), all_.end(), Index(0));
  factors_.load(shifted_, &budget());
  regular_ = factors_.factorize(all_);
}

void Admm::solve(const Lcp& problem) {
  const auto* delassus = std::get_if<Delassus>(&problem.A);
  if (delassus == nullptr) {
    r_ = x_;
    factors_.solve(r_, x_, false);
    return;
  }
  const auto& [W, inverse_mass, regularization] = *delassus;
  r_ = s_;
  if (regularization.size() > 0) r_ += regularization;
  x_.array() /= r_.array();
  t_.resize(W.cols);
  t_.noalias() = W.view().transpose() * x_;
  t_.array() *= inverse_mass.array().sqrt();
  factors_.solve(t_, scratch_, false);
  scratch_.array() *= inverse_mass.array().sqrt();
  t_.resize(W.rows);
  t_.noalias() = W.view() * scratch_;
  x_.array() -= t_.array() / r_.array();
}

void Admm::load(const Lcp& problem, Vector& z) {
  bounds_.load(problem, z);
  rho_ = options_.rho;
  iteration_ = 0, next_look_ = 10;
  multiply(problem.A, z, w_, scratch_);
  w_ += problem.b;
  y_.resize(z.size());
  for (Index i = 0; i < z.size(); ++i)
    y_[i] = (z[i] == bounds_.lo[i] && w_[i] > 0) || (z[i] == bounds_.hi[i] && w_[i] < 0) ? -w_[i] : 0;
}

bool Admm::adapt(const Lcp& problem, const Vector& z) {  // r_: the dual residual
  next_look_ += next_look_ / 2;
  const auto d = bounds_.d.array();
  const double primal = (d * (x_ - z).array().square()).sum(),
               primal_size = std::max((d * x_.array().square()).sum(), (d * z.array().square()).sum());
  const double dual = (r_.array().square() / d).sum();
  const double dual_size = std::max({((w_ - problem.b).array().square() / d).sum(), (y_.array().square() / d).sum(),
                                     (problem.b.array().square() / d).sum()});
  const double factor = std::pow((primal / primal_size) / (dual / dual_size), 0.25);
  if (!(factor > 5 || factor < 0.2) || !(factor > 0 && factor < kInf)) return false;
  rho_ = std::clamp(rho_ * factor, 1e-6, 1e6);
  factorize(problem);
  return true;
}

Admm::Step Admm::advance(const Lcp& problem, Vector& z) {
  if (iteration_++ == 0) factorize(problem);
  if (!regular_) return {.violation = kInf, .end = Claim::stalled};
  before_ = z;
  x_ = s_.cwiseProduct(z) - y_ - problem.b;
  solve(problem);
  const double a = options_.alpha;
  w_ = a * x_ + (1 - a) * z;  // relaxed x
  z = (w_ + y_.cwiseQuotient(s_)).cwiseMax(bounds_.lo).cwiseMin(bounds_.hi);
  y_ += s_.cwiseProduct(w_ - z);
  r_ = s_.cwiseProduct((2 - a) * before_ - (1 - a) * x_ - z);  // A x + b + y
  multiply(problem.A, z, w_, scratch_);
  w_ += problem.b;
  Step step{.violation = bounds_.violation(problem, z, w_), .length = rho_};
  if (options_.adapt && iteration_ >= next_look_ && adapt(problem, z)) step.event = "penalty";
  if (bounds_.outdated()) {
    bounds_.hold(problem, z);
    step.event = "friction bounds";
  }
  return step;
}

}  // namespace orthant
