#include <orthant/solvers/first_order/sweeps.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

double dot(const RowSparse& A, Index i, const Vector& x) {
  double sum = 0;
  for (std::size_t k = at(A.start[at(i)]); k < at(A.start[at(i) + 1]); ++k) sum += A.value[k] * x[A.column[k]];
  return sum;
}

/// The rows of each storage: w_i at the newest z, and what a change of z_i moves besides.
struct DenseRows {
  const DenseMatrix& A;
  Vector& state;
  double w(Index i, const Vector&) const { return state[i]; }
  void change(Index i, double delta) const { state += A.col(i) * delta; }
};

struct SparseRows {
  const RowSparse& A;
  const Vector& b;
  double w(Index i, const Vector& z) const { return dot(A, i, z) + b[i]; }
  void change(Index, double) const {}
};

struct DelassusRows {
  const Delassus& A;
  const Vector& b;
  Vector& state;
  double w(Index i, const Vector& z) const {
    return dot(A.W, i, state) + (A.regularization.size() > 0 ? A.regularization[i] * z[i] : 0.0) + b[i];
  }
  void change(Index i, double delta) const {
    for (std::size_t k = at(A.W.start[at(i)]); k < at(A.W.start[at(i) + 1]); ++k)
      state[A.W.column[k]] += A.inverse_mass[A.W.column[k]] * A.W.value[k] * delta;
  }
};

}  // namespace

void Sweeps::load(const Lcp& problem, const Vector& z) {
  problem_ = &problem;
  orthant::diagonal(problem.A, diagonal_);
  friction_of_.assign(at(problem.size()), -1);
  for (std::size_t k = 0; k < problem.friction.size(); ++k)
    friction_of_[at(problem.friction[k].first)] = static_cast<Index>(k);
  side_.assign(at(problem.size()), 0);
  refresh(z);
}

void Sweeps::refresh(const Vector& z) {
  since_refresh_ = 0;
  if (std::holds_alternative<DenseMatrix>(problem_->A)) {
    multiply(problem_->A, z, state_, scratch_);
    state_ += problem_->b;
  } else if (const auto* delassus = std::get_if<Delassus>(&problem_->A)) {
    state_.resize(delassus->W.cols);
    state_.setZero();
    for (Index i = 0; i < z.size(); ++i) DelassusRows{*delassus, problem_->b, state_}.change(i, z[i]);
  } else {
    state_.resize(0);
  }
}

template <class Rows> Sweeps::Change Sweeps::run(const Rows& rows, Vector& z, double omega, Order order) {
  Change result;
  const Index n = z.size();
  for (Index k = 0; k < n; ++k) {
    const Index i = order == Order::forward ? k : n - 1 - k;
    double lo = problem_->lo[i], hi = problem_->hi[i];
    if (const Index f = friction_of_[at(i)]; f >= 0) {
      const Friction& friction = problem_->friction[at(f)];
      hi = friction.mu * std::max(z[friction.normal], 0.0), lo = -hi;  // a start value may have z_n < 0
    }
    const double free = z[i] - omega * rows.w(i, z) / diagonal_[i], next = std::clamp(free, lo, hi),
                 delta = next - z[i];
    const auto side = static_cast<signed char>((free > hi) - (free < lo));
    result.switched += side != side_[at(i)];
    side_[at(i)] = side;
    if (delta == 0) continue;
    z[i] = next;
    rows.change(i, delta);
    result.moved = result.moved || std::abs(delta) > 4 * std::numeric_limits<double>::epsilon() * std::abs(next);
    detail::raise(result.largest, std::abs(delta) * diagonal_[i]);
  }
  return result;
}

Sweeps::Change Sweeps::sweep(Vector& z, double omega, Order order) {
  const auto once = [&] {
    const Matrix& A = problem_->A;
    if (const auto* dense = std::get_if<DenseMatrix>(&A)) return run(DenseRows{*dense, state_}, z, omega, order);
    if (const auto* sparse = std::get_if<RowSparse>(&A)) return run(SparseRows{*sparse, problem_->b}, z, omega, order);
    return run(DelassusRows{std::get<Delassus>(A), problem_->b, state_}, z, omega, order);
  };
  if (++since_refresh_ > 64) refresh(z);
  const Change change = once();
  if (change.moved || since_refresh_ == 1) return change;
  refresh(z);  // nothing moves any more: but is w what it is said to be? A start far from z leaves its rounding in it
  return once();
}

}  // namespace orthant
