#include <orthant/solvers/pgs.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

/// The rows of each storage: w_i at the newest z, and what a change of z_i moves besides.
struct DenseRows {
  const DenseMatrix& A;
  double product(Index i, const Vector& z) const {
    double sum = 0;
    for (Index j = 0; j < z.size(); ++j) sum += A(i, j) * z[j];
    return sum;
  }
  void change(Index, double) const {}
};

double dot(const RowSparse& A, Index i, const Vector& x) {
  double sum = 0;
  for (auto k = static_cast<std::size_t>(A.start[static_cast<std::size_t>(i)]);
       k < static_cast<std::size_t>(A.start[static_cast<std::size_t>(i) + 1]); ++k)
    sum += A.value[k] * x[A.column[k]];
  return sum;
}

struct SparseRows {
  const RowSparse& A;
  double product(Index i, const Vector& z) const { return dot(A, i, z); }
  void change(Index, double) const {}
};

struct DelassusRows {
  const Delassus& A;
  Vector& u;  // M⁻¹ Wᵀ z
  DelassusRows(const Delassus& operator_, Vector& storage, const Vector& z) : A(operator_), u(storage) {
    u.resize(A.W.cols);
    u.setZero();
    for (Index i = 0; i < z.size(); ++i) change(i, z[i]);
  }
  double product(Index i, const Vector& z) const {
    return dot(A.W, i, u) + (A.regularization.size() > 0 ? A.regularization[i] * z[i] : 0.0);
  }
  void change(Index i, double delta) {
    for (auto k = static_cast<std::size_t>(A.W.start[static_cast<std::size_t>(i)]);
         k < static_cast<std::size_t>(A.W.start[static_cast<std::size_t>(i) + 1]); ++k)
      u[A.W.column[k]] += A.inverse_mass[A.W.column[k]] * A.W.value[k] * delta;
  }
};

}  // namespace

std::string Pgs::why_not(const Lcp& problem) const {
  diagonal(problem.A, diag_);
  for (Index i = 0; i < diag_.size(); ++i)
    if (!(diag_[i] > 0)) {
      const std::string index = std::to_string(i);
      return "A(" + index + ", " + index + ") = " + std::to_string(diag_[i]) + ": must be > 0";
    }
  return {};
}

Status Pgs::run(const Lcp& problem, Solution& s, Start) {  // why_not() has filled diag_
  friction_of_.assign(static_cast<std::size_t>(problem.size()), -1);
  for (std::size_t k = 0; k < problem.friction.size(); ++k)
    friction_of_[static_cast<std::size_t>(problem.friction[k].row)] = static_cast<Index>(k);
  target_ = options_.tolerance * (problem.size() > 0 ? problem.b.lpNorm<Eigen::Infinity>() : 0.0);
  return sweep(problem, s);
}

bool Pgs::run_again(const Lcp& problem, Solution& s, int, Status& claim) {
  // Slow convergence: a small change is not yet a small residual. Ask for smaller ones until they are rounding.
  if (claim != Status::solved || s.status != Status::stalled) return false;
  target_ *= 0.1;
  claim = sweep(problem, s);
  return true;
}

Status Pgs::sweep(const Lcp& problem, Solution& s) {
  const auto run = [&](auto&& rows) {
    const Index n = problem.size();
    Vector& z = s.z;
    while (s.iterations < options_.max_sweeps) {
      ++s.iterations;
      double largest = 0;
      bool moved = false;
      for (Index i = 0; i < n; ++i) {
        const double w = rows.product(i, z) + problem.b[i];
        double lo = problem.lo[i], hi = problem.hi[i];
        if (const Index k = friction_of_[static_cast<std::size_t>(i)]; k >= 0) {
          const Friction& f = problem.friction[static_cast<std::size_t>(k)];
          hi = f.mu * std::max(z[f.normal], 0.0), lo = -hi;  // a start value may have z_n < 0
        }
        const double next = std::clamp(z[i] - options_.omega * w / diag_[i], lo, hi), delta = next - z[i];
        if (delta == 0) continue;
        z[i] = next;
        rows.change(i, delta);
        moved = moved || std::abs(delta) > 4 * std::numeric_limits<double>::epsilon() * std::abs(next);
        largest = std::max(largest, std::abs(delta) * diag_[i]);
      }
      log(s.iterations, largest);
      if (largest <= target_) return Status::solved;  // to be judged
      if (!std::isfinite(largest)) return Status::numerical_error;
      if (!moved) return Status::stalled;
      if (budget().exhausted()) return Status::time_limit;
    }
    return Status::iteration_limit;
  };
  if (const auto* dense = std::get_if<DenseMatrix>(&problem.A)) return run(DenseRows{*dense});
  if (const auto* sparse = std::get_if<RowSparse>(&problem.A)) return run(SparseRows{*sparse});
  return run(DelassusRows(std::get<Delassus>(problem.A), u_, s.z));
}

}  // namespace orthant
