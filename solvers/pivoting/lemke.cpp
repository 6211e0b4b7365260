#include <orthant/solvers/pivoting/lemke.h>

#include <orthant/solvers/linear_algebra/refined_basis.h>
#include <orthant/solvers/linear_algebra/scalars.h>
#include <orthant/solvers/linear_algebra/scaling.h>
#include <orthant/solvers/pivoting/enumerate.h>
#include <orthant/solvers/pivoting/lemke_tableau.h>
#include <orthant/solvers/pivoting/normal_path.h>
#include <orthant/solvers/pivoting/revised_lemke.h>
#include <orthant/solvers/proof/farkas.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <random>
#include <type_traits>
#include <vector>

namespace orthant {

namespace {

using detail::Float256;
using detail::Rational;
using detail::RefinedBasis;
using detail::RevisedLemke;
using detail::Scaling;
using detail::Tableau;

constexpr int kRestarts = 12;      // with other covering vectors
constexpr int kCovers = 4;         // the same of the plain method, where its path goes round in a circle
constexpr Index kEnumerable = 12;  // rows of the pure form: 4096 bases, some milliseconds
constexpr Index kExtended = 100;   // rows beyond which refinement comes sooner to the same
constexpr Index kRational = 24;    // rows up to which rationals stay short
constexpr Index kTableau = 10000;
constexpr Index kRevisedOnly = 2000;  // rows beyond which no tableau is tried after the revised form
constexpr Index kWide = 600;          // rows up to which 256 bits take seconds

// The attempts of the rescue, in turn. After the last: every basis, or other covering vectors.
enum class Arithmetic { plain, refined, extended, wide, exact };
struct Attempt {
  Arithmetic arithmetic;
  bool nearby;      // on a matrix within rounding of the given one (Nearby)
  bool other_form;  // Stewart and Trinkle's, where there is friction
};
constexpr Attempt kAttempts[] = {
    {Arithmetic::extended, false, false}, {Arithmetic::exact, false, false}, {Arithmetic::refined, false, false},
    {Arithmetic::wide, true, false},      {Arithmetic::wide, false, false},  {Arithmetic::plain, false, true},
    {Arithmetic::extended, false, true},  {Arithmetic::wide, true, true},    {Arithmetic::wide, false, true},
};
constexpr int kFirstAttempts = 5;  // the rest take the other form
constexpr int kLastAttempt = static_cast<int>(std::size(kAttempts));

// M with a few roundings of its row added to each positive diagonal entry. A Delassus matrix of redundant contacts is
// positive semidefinite up to the rounding of its entries, which can leave it without a solution; this neighbour has
// one, and as its entries differ by less than 4 ε max_j |M_ij|, its solution has a residual below 4 ρ in M.
struct Nearby {
  const DenseMatrix& M;
  const Vector& shift;
  double operator()(Index i, Index j) const { return i == j ? M(i, i) + shift[i] : M(i, j); }
};

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
  Vector y, direction, cover, shift;
  Tableau<double> tableau;
  Tableau<long double> long_tableau;
  Tableau<Float256> wide_tableau;
  Tableau<Rational> exact_tableau;
  Enumerate enumerate;
  Solution enumerated;
  RevisedLemke revised;
  Pyramid copositive;
  Columns columns;
  NormalPath<double> normal_path;
  bool was_revised = false;  // the tableau has not been tried
  int stage = 0;             // of the rescue
  int pivots = 0;            // of all attempts
  bool circle = false;       // the last path came back to a basis

  RefinedBasis basis;

  void form(const Lcp& problem, Pyramid::Form form) {
    reduced = Pyramid::needed(problem);
    if (reduced) {
      pure = &pyramid.pure(problem, form);
    } else {
      pure = &with_dense_matrix(problem, dense);
    }
    const Index n = pure->size();
    free.resize(at(n));
    for (Index i = 0; i < n; ++i) free[at(i)] = pure->lo[i] == -kInf;
    scaling.fit(std::get<DenseMatrix>(pure->A));
    cover_tableau();
  }

  template <class T>
  Claim attempt(Tableau<T>& t, int max_pivots, const Lcp& problem, Solution& s, bool nearby = false) {
    const auto& M = std::get<DenseMatrix>(pure->A);
    const Index n = pure->size();
    const auto late = [this] { return lemke.budget().exhausted(); };
    if (nearby)
      t.load(Nearby{M, shift_of(M)}, pure->b, free, scaling.row, scaling.col, late);
    else
      t.load(M, pure->b, free, scaling.row, scaling.col, late);
    const auto end = t.run(max_pivots > 0 ? max_pivots : 20000 + 100 * static_cast<int>(n), [&](const T& z0) {
      lemke.log(t.iterations(), static_cast<double>(z0));
      return late();
    });
    circle = end == Tableau<T>::End::circle;
    s.iterations = pivots += t.iterations();
    y.resize(n);
    y.setZero();
    if (end == Tableau<T>::End::ray) {
      direction.resize(n);
      direction.setZero();
      t.ray(direction);
      direction.array() *= scaling.col.array();
      tidy_certificate(*pure, direction);
      if (reduced)
        pyramid.restore_certificate(problem, direction, s.ray);
      else
        s.ray = direction;
    } else if (end == Tableau<T>::End::solved) {
      if constexpr (std::is_floating_point_v<T>)
        refine(t, M);
      else  // more digits than y holds
        t.for_each_basic_z([&](Index i, int sign, const T& value, int) {
          const double z = sign * static_cast<double>(value) * scaling.col[i];
          y[i] += free[at(i)] ? z : std::max(z, 0.0);
        });
    }
    if (reduced)
      pyramid.restore(problem, y, s.z);
    else
      s.z = y;
    return end == Tableau<T>::End::solved    ? Claim::candidate
           : end == Tableau<T>::End::ray     ? Claim::ray
           : circle                          ? Claim::stalled
           : end == Tableau<T>::End::stopped ? Claim::time_limit
                                             : Claim::iteration_limit;
  }

  void cover_tableau() {
    if (lemke.options_.cover == LemkeCover::ones)
      cover.resize(0);
    else
      cover_of(pure->A).array() *= scaling.row.array();
    using Double = std::numeric_limits<double>;
    cover = cover.cwiseMax(Double::min()).cwiseMin(Double::max());  // d > 0 and finite, whatever the units
    tableau.cover(cover);
  }

  // d by row of a pure problem; empty: e.
  Vector& cover_of(const Matrix& A) {
    cover.resize(order(A));
    cover.setOnes();
    if (lemke.options_.cover != LemkeCover::ones) detail::row_sizes(A, cover);
    return cover;
  }

  Claim attempt_revised(int max_pivots, const Lcp& problem, Solution& s) {
    if (!revised.load(problem, cover_of(problem.A), lemke.budget())) return Claim::numerical_error;
    const auto end = revised.run(max_pivots > 0 ? max_pivots : 20000 + 100 * static_cast<int>(problem.size()),
                                 [&](double z0) { lemke.log(revised.iterations(), z0); });
    s.iterations = pivots += revised.iterations();
    switch (end) {
      case RevisedLemke::End::solved:
        revised.point(s.z);
        return Claim::candidate;
      case RevisedLemke::End::ray:
        revised.ray(s.ray);
        tidy_certificate(problem, s.ray);
        return Claim::ray;
      case RevisedLemke::End::limit:
        return Claim::iteration_limit;
      case RevisedLemke::End::stopped:
        return Claim::time_limit;
      default:
        return Claim::numerical_error;
    }
  }

  // On factors, refined at every pivot: M z + t q, t from 0 to 1, by normal_path.h, whose random perturbation covers.
  // It ends where Lemke's ray does not in some ill-conditioned problems. Bounds are native, friction is copositive.
  Claim attempt_refined(int max_pivots, const Lcp& problem, Solution& s) {
    const bool friction = !problem.friction.empty();
    const Lcp& p = friction ? copositive.pure(problem, Pyramid::Form::stewart_trinkle) : problem;
    columns.load(p.A);
    normal_path.load(columns, p.b, p.lo, p.hi, storage_of(p.A), lemke.budget());
    y.resize(p.size());
    for (Index i = 0; i < p.size(); ++i) y[i] = p.lo[i] != -kInf ? p.lo[i] : p.hi[i] != kInf ? p.hi[i] : 0;
    if (!normal_path.start(y)) return Claim::numerical_error;
    const auto end = normal_path.follow(max_pivots, [&](double t) {
      lemke.log(normal_path.pivots(), 1 - t, 0, "refined");
      return lemke.budget().exhausted();
    });
    s.iterations = pivots += normal_path.pivots();
    normal_path.point(y, direction);
    if (end == PathEnd::ray) {
      normal_path.direction(direction);
      tidy_certificate(p, direction);
    }
    if (friction) {
      copositive.restore(problem, y, s.z);
      if (end == PathEnd::ray) copositive.restore_certificate(problem, direction, s.ray);
    } else {
      s.z = y;
      if (end == PathEnd::ray) s.ray = direction;
    }
    switch (end) {
      case PathEnd::solved:
        return Claim::candidate;
      case PathEnd::ray:
        return Claim::ray;
      case PathEnd::limit:
        return Claim::iteration_limit;
      case PathEnd::stopped:
        return Claim::time_limit;
      default:
        return Claim::numerical_error;
    }
  }

  const Vector& shift_of(const DenseMatrix& M) {
    const Index n = M.rows();
    shift.resize(n);
    shift.setZero();
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n && M(j, j) > 0; ++i)
        if (M(i, i) > 0) shift[i] = std::max(shift[i], 0x1p-50 * std::abs(M(i, j)));
    return shift;
  }

  // Another covering vector, another path: from the same numbers on every machine and in every run.
  template <class T> Claim restart(Tableau<T>& t, int attempt_number, int max_pivots, const Lcp& problem, Solution& s) {
    cover.resize(pure->size());
    std::minstd_rand random(static_cast<unsigned>(attempt_number));
    for (double& d : cover) d = static_cast<double>(1 + random() % 1024) / 64;
    t.cover(cover);
    const Claim claim = attempt(t, max_pivots, problem, s);
    cover.resize(0);
    t.cover(cover);
    return claim;
  }

  // The plain method; where its path goes round in a circle, from other covering vectors.
  Claim plain(int max_pivots, const Lcp& problem, Solution& s) {
    Claim claim = attempt(tableau, max_pivots, problem, s);
    for (int k = 1; k <= kCovers && circle && (max_pivots == 0 || pivots < max_pivots); ++k)
      claim = restart(tableau, k, max_pivots > 0 ? max_pivots - pivots : 0, problem, s);
    cover_tableau();
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

bool Lemke::takes_revised(const Lcp& problem) const {
  if (options_.form == LemkeForm::tableau || !problem.friction.empty() || std::holds_alternative<Delassus>(problem.A))
    return false;
  if (options_.form == LemkeForm::automatic && (problem.size() < 200 || !std::holds_alternative<RowSparse>(problem.A)))
    return false;
  for (Index i = 0; i < problem.size(); ++i)
    if (problem.hi[i] != kInf || (problem.lo[i] != 0 && problem.lo[i] != -kInf)) return false;
  return true;
}

std::string Lemke::why_not(const Lcp& problem) const {
  const Index n = problem.size() + static_cast<Index>(problem.friction.size());
  if (n <= kTableau || takes_revised(problem)) return {};
  return "n = " + std::to_string(n) +
         ": the dense tableau takes at most 10000 rows, the revised form sparse problems " +
         "without friction rows, upper bounds and lower bounds other than 0";
}

Claim Lemke::run(const Lcp& problem, Solution& s, Start) {
  if (problem.size() == 0) return Claim::candidate;
  work_->stage = 0, work_->pivots = 0;
  work_->was_revised = takes_revised(problem);
  if (work_->was_revised) return work_->attempt_revised(options_.max_pivots, problem, s);
  work_->form(problem, Pyramid::Form::shifted);
  if (!finite(*work_->pure)) return Claim::numerical_error;  // overflow in shifting the bounds
  return work_->plain(options_.max_pivots, problem, s);
}

bool Lemke::run_again(const Lcp& problem, Solution& s, int, Claim& claim) {
  if (!options_.rescue || problem.size() == 0) return false;
  Work& work = *work_;
  if (!work.was_revised && !finite(*work.pure)) return false;
  if (work.was_revised) {
    work.was_revised = false;
    if (problem.size() > kRevisedOnly) return false;
    work.form(problem, Pyramid::Form::shifted);
    if (!finite(*work.pure)) return false;
    claim = work.plain(options_.max_pivots, problem, s);
    return true;
  }
  const bool slow = claim == Claim::iteration_limit;  // more digits take the same path, if more slowly
  const Index n = problem.size() + static_cast<Index>(problem.friction.size());
  while (work.stage < kLastAttempt + kRestarts) {
    const int stage = work.stage++;
    // A residual that would do: more digits may find the right basis, but other forms and paths are not called for. But
    // a shifted friction force has lost what is small relative to its bound.
    if (stage >= kFirstAttempts && problem.friction.empty() &&
        s.residual <= options_.tolerance * problem.b.lpNorm<Eigen::Infinity>())
      return false;
    if (stage >= kLastAttempt) {
      if (slow) return false;
      if (work.pure->size() <= kEnumerable) {
        work.stage = kLastAttempt + kRestarts;
        work.enumerate.set_time_limit(budget().remaining());
        work.enumerate.set_cancel(budget().cancel());
        work.enumerate.set_proof_search(false);
        work.enumerate.solve(problem, work.enumerated);
        if (work.enumerated.status == Status::infeasible || has_answer(work.enumerated.status)) {
          s.z = work.enumerated.z;
          claim = handed_on(work.enumerated, s);
          return true;
        }
        return false;
      }
      if (n > kWide) return false;
      claim = work.restart(work.long_tableau, stage, options_.max_pivots, problem, s);
      return true;
    }
    const auto [arithmetic, nearby, other_form] = kAttempts[stage];
    if (other_form && problem.friction.empty()) continue;
    if (other_form && stage == kFirstAttempts) work.form(problem, Pyramid::Form::stewart_trinkle);
    const Index rows = work.pure->size();
    const int few = 1000 + 20 * static_cast<int>(rows), limit = options_.max_pivots;
    switch (arithmetic) {
      case Arithmetic::plain:
        claim = work.plain(limit, problem, s);
        return true;
      case Arithmetic::refined:
        // Few rows have few bases: a longer path goes in circles.
        claim = work.attempt_refined(limit > 0          ? limit
                                     : rows > kRational ? 20000 + 100 * static_cast<int>(n)
                                                        : few,
                                     problem, s);
        return true;
      case Arithmetic::extended:
        if (rows > kExtended) break;
        claim = work.attempt(work.long_tableau, limit, problem, s);
        return true;
      case Arithmetic::wide:
        if (rows > kWide) break;
        claim = work.attempt(work.wide_tableau, limit > 0 ? std::min(limit, few) : few, problem, s, nearby);
        return true;
      case Arithmetic::exact:
        if (rows > kRational) break;
        claim = work.attempt(work.exact_tableau, limit > 0 ? std::min(limit, few) : few, problem, s);
        return true;
    }
  }
  return false;
}

}  // namespace orthant
