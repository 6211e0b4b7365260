#include <orthant/solvers/lemke.h>

#include <orthant/solvers/enumerate.h>
#include <orthant/solvers/farkas.h>
#include <orthant/solvers/refined_basis.h>
#include <orthant/solvers/scaling.h>
#include <orthant/solvers/tableau.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace orthant {

namespace {

using detail::Quad;
using detail::RefinedBasis;
using detail::Scaling;
using detail::Tableau;

constexpr int kRestarts = 12;      // with other covering vectors
constexpr Index kEnumerable = 12;  // rows of the pure form: 4096 bases, some milliseconds

std::size_t at(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

struct Lemke::Work {
  explicit Work(Lemke& owner) : lemke(owner) {}
  Lemke& lemke;
  Pyramid pyramid;
  Lcp dense;  // a pure problem whose matrix is stored otherwise
  const Lcp* pure = nullptr;
  bool reduced = false;  // pure is pyramid's
  Scaling scaling;
  std::vector<char> free;
  Vector y, direction, cover;
  Tableau<double> tableau;
  Tableau<long double> long_tableau;
  Tableau<Quad> quad_tableau;
  Farkas farkas;
  Enumerate enumerate;
  Solution enumerated;
  int stage = 0;  // of the rescue
  bool proof_sought = false;

  RefinedBasis basis;

  void form(const Lcp& problem, Pyramid::Form form) {
    reduced = Pyramid::needed(problem);
    if (reduced) {
      pure = &pyramid.pure(problem, form);
    } else if (std::holds_alternative<DenseMatrix>(problem.A)) {
      pure = &problem;
    } else {
      if (!std::holds_alternative<DenseMatrix>(dense.A)) dense.A = DenseMatrix();
      to_dense(problem.A, std::get<DenseMatrix>(dense.A));
      dense.b = problem.b;
      dense.lo = problem.lo;
      dense.hi = problem.hi;
      pure = &dense;
    }
    const Index n = pure->size();
    free.resize(at(n));
    for (Index i = 0; i < n; ++i) free[at(i)] = pure->lo[i] == -kInf;
    scaling.fit(std::get<DenseMatrix>(pure->A));
  }

  template <class T> Status attempt(Tableau<T>& t, int max_pivots, const Lcp& problem, Solution& s) {
    const auto& M = std::get<DenseMatrix>(pure->A);
    const Index n = pure->size();
    t.load(M, pure->b, free, scaling.row, scaling.col);
    const auto end = t.run(max_pivots > 0 ? max_pivots : 20000 + 100 * static_cast<int>(n), [&](const T& z0) {
      lemke.log(t.iterations(), static_cast<double>(z0));
      return lemke.budget().exhausted();
    });
    s.iterations = t.iterations();
    y.resize(n);
    y.setZero();
    if (end == Tableau<T>::End::ray) {
      direction.resize(n);
      direction.setZero();
      t.ray(direction);
      direction.array() *= scaling.col.array();
      tidy_certificate(*pure, direction);
      if (reduced)
        pyramid.restore_certificate(problem, direction, s.certificate);
      else
        s.certificate = direction;
    } else if (end == Tableau<T>::End::solved) {
      refine(t, M);
    }
    if (reduced)
      pyramid.restore(problem, y, s.z);
    else
      s.z = y;
    return end == Tableau<T>::End::solved    ? Status::solved
           : end == Tableau<T>::End::ray     ? Status::ray
           : end == Tableau<T>::End::stopped ? Status::time_limit
                                             : Status::iteration_limit;
  }

  // Another covering vector, another path: from the same numbers on every machine and in every run.
  Status restart(int attempt_number, int max_pivots, const Lcp& problem, Solution& s) {
    cover.resize(pure->size());
    std::minstd_rand random(static_cast<unsigned>(attempt_number));
    for (double& d : cover) d = static_cast<double>(1 + random() % 1024) / 64;
    long_tableau.cover(cover);
    const Status claim = attempt(long_tableau, max_pivots, problem, s);
    cover.resize(0);
    long_tableau.cover(cover);
    return claim;
  }

  // z_B to full precision, from the basis inverse that the final tableau holds.
  template <class T> void refine(const Tableau<T>& t, const DenseMatrix& M) {
    basis.unknown.clear();
    basis.equation.clear();
    t.for_each_basic_z([&](Index i, int sign, const T& value, int) {
      basis.unknown.push_back(i);
      y[i] = sign * static_cast<double>(value) * scaling.col[i];
    });
    t.for_each_nonbasic_w([&](Index i, int, int) { basis.equation.push_back(i); });
    double* column = basis.room();
    t.for_each_nonbasic_w([&](Index j, int sign_w, int c) {
      t.for_each_basic_z([&](Index i, int sign_z, const T&, int r) {
        *column++ = static_cast<double>(t.entry(r, c)) * (sign_w * sign_z) * scaling.col[i] * scaling.row[j];
      });
    });
    basis.refine(M, pure->b, scaling.col, y);
    for (const Index i : basis.unknown)
      if (y[i] < 0 && !free[at(i)]) y[i] = 0;
  }
};

Lemke::Lemke(const Options& options) : options_(options), work_(std::make_unique<Work>(*this)) {}
Lemke::~Lemke() = default;

std::string Lemke::why_not(const Lcp& problem) const {
  const Index n = problem.size() + static_cast<Index>(problem.friction.size());
  if (n <= 10000) return {};
  return "n = " + std::to_string(n) + ": the dense tableau takes at most 10000 rows";
}

Status Lemke::run(const Lcp& problem, Solution& s, Start) {
  if (problem.size() == 0) return Status::solved;
  work_->stage = 0;
  work_->proof_sought = false;
  work_->form(problem, Pyramid::Form::shifted);
  return work_->attempt(work_->tableau, options_.max_pivots, problem, s);
}

bool Lemke::run_again(const Lcp& problem, Solution& s, int, Status& claim) {
  if (!options_.rescue || problem.size() == 0) return false;
  Work& work = *work_;
  if (!work.proof_sought && (s.status == Status::ray || s.status == Status::numerical_error)) {
    work.proof_sought = true;  // |z| beyond all bounds is a ray too, seen through rounding
    if (work.farkas.propose(problem, s.certificate)) {
      claim = Status::ray;
      return true;
    }
  }
  const bool slow = claim == Status::iteration_limit;  // quadruple precision would be slower still
  const bool small = problem.size() <= 100;
  while (++work.stage <= 5 + kRestarts) {
    // A residual that would do: more digits may find the right basis, but other forms and paths are not called for.
    if (work.stage > 2 && s.residual <= options_.tolerance * problem.b.lpNorm<Eigen::Infinity>()) return false;
    switch (work.stage) {
      case 1:
      case 4:
        claim = work.attempt(work.long_tableau, options_.max_pivots, problem, s);
        return true;
      case 2:
      case 5:
        if (slow || !small) break;
        claim = work.attempt(work.quad_tableau, options_.max_pivots, problem, s);
        return true;
      case 3:
        if (slow || !small) return false;
        if (problem.friction.empty()) {
          work.stage = 5;
          break;
        }
        work.form(problem, Pyramid::Form::stewart_trinkle);
        claim = work.attempt(work.tableau, options_.max_pivots, problem, s);
        return true;
      default:
        if (claim != Status::ray && claim != Status::solved) return false;
        if (work.pure->size() <= kEnumerable) {
          work.stage = 5 + kRestarts;
          if (work.enumerate.solve(problem, work.enumerated).status != Status::solved) return false;
          s.z = work.enumerated.z;
          claim = Status::solved;
          return true;
        }
        claim = work.restart(work.stage, options_.max_pivots, problem, s);
        return true;
    }
  }
  return false;
}

}  // namespace orthant
