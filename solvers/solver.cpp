#include <orthant/core/lcp/judge/exact_proof.h>
#include <orthant/core/support/kept_memory.h>
#include <orthant/solvers/cones/facets.h>
#include <orthant/solvers/factorization_count.h>
#include <orthant/solvers/pivoting/enumerate.h>
#include <orthant/solvers/solver.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace orthant {

namespace {

// Times the limit of solved: from there on a z that is rounded only is worth the search for a proof that there is none.
constexpr double kFar = 100;
constexpr Index kMostWithRoom = 30;  // rows up to which other proofs are sought near one that rounding spoils
// Of the largest |b|: a residual below it may be that of rows with small terms only.
constexpr double kFine = 1e-10;

bool open(const Solution& s) { return !has_answer(s.status) && s.status != Status::infeasible; }

bool is_symmetric(const Matrix& A) {
  DenseMatrix dense;
  to_dense(A, dense);
  return dense == dense.transpose();
}

bool better(const Solution& a, const Solution& b) {
  return has_answer(a.status) == has_answer(b.status) ? a.residual < b.residual : has_answer(a.status);
}

}  // namespace

Claim handed_on(const Solution& inner, Solution& s) {
  s.ray = inner.ray, s.certificate = inner.certificate, s.cells = inner.cells;
  switch (inner.status) {
    case Status::solved:
    case Status::rounded:
      return Claim::candidate;
    case Status::infeasible:
      return inner.cells.empty() ? Claim::stalled : Claim::exhausted;
    case Status::ray:
      return Claim::ray;
    case Status::iteration_limit:
      return Claim::iteration_limit;
    case Status::numerical_error:
      return Claim::numerical_error;
    default:  // its share of the time, not the whole
      return Claim::stalled;
  }
}

bool Solver::unsettled(const Solution& s) { return open(s) || (s.status == Status::rounded && s.coarse); }

/// The judge's status, or the better one of z with its fine rows settled.
void Solver::judge(const Lcp& problem, double tolerance, Claim claim, Solution& s) {
  judge_at_bounds(problem, tolerance, claim, s);
  if (unsettled(s) && s.residual <= kFine * problem.b.lpNorm<Eigen::Infinity>()) judge_fine_rows(problem, tolerance, s);
}

/// The judge on z with the rows settled that violate by little beside the others' data.
void Solver::judge_fine_rows(const Lcp& problem, double tolerance, Solution& s) {
  if (!fine_rows_.settle(problem, s.z, put_.z)) return;
  judge_.certify(problem, tolerance, Claim::stalled, put_);
  if (!has_answer(put_.status) || (put_.coarse && has_answer(s.status))) return;
  take_put(s);
}

/// What was last judged in put_ into s; its status only where it is an answer.
void Solver::take_put(Solution& s) {
  accepted_ = judge_.accepted();
  if (has_answer(put_.status)) s.status = put_.status;
  s.z = put_.z, s.w = put_.w;
  s.residual = put_.residual, s.rounding = put_.rounding, s.miss = put_.miss, s.coarse = put_.coarse;
}

/// The judge on z; where z does not pass for solved, also on z put at its bounds, and the better of both is kept.
void Solver::judge_at_bounds(const Lcp& problem, double tolerance, Claim claim, Solution& s) {
  judge_.certify(problem, tolerance, claim, s);
  accepted_ = judge_.accepted();
  const double excess = judge_.excess();
  if (s.status == Status::solved || s.status == Status::infeasible || !s.z.allFinite() || !s.w.allFinite()) return;
  if (!at_bounds_.put(problem, s, put_.z)) return;
  judge_.certify(problem, tolerance, Claim::stalled, put_);
  const bool nearer = judge_.excess() < excess, answers = has_answer(put_.status) && !(s.coarse && put_.coarse);
  if (put_.status != Status::solved && (!unsettled(s) || !(nearer || answers))) return;
  take_put(s);
}

void Solver::seek_proof(const Lcp& problem, Solution& s) {
  // Cheap: then worth it after a run that was only too short.
  const bool cheap = problem.size() <= Farkas::kTableau;
  const bool contested = s.status == Status::rounded && s.miss.by > kFar * s.miss.allowed;
  if (s.status != Status::ray && s.status != Status::stalled && s.status != Status::numerical_error && !contested &&
      !(cheap && s.status == Status::iteration_limit))
    return;
  if (seeks_proof() || contested) proves_infeasible(problem, s);
}

bool Solver::proves_infeasible(const Lcp& problem, Solution& s) {
  if (!proof_search_ || proof_sought_ || budget_.exhausted()) return false;
  proof_sought_ = true;
  Budget share;  // a quarter of what is left
  share.start(budget_.remaining() / 4, budget_.cancel());
  if (problem.discs()) return proves_over_cones(problem, share, s);
  if (!farkas_.propose(problem, proof_, share)) return false;
  scratch_ = proof_;
  if (in_whole_numbers(scratch_) && takes_proof(problem, scratch_, s)) return true;
  if (takes_proof(problem, proof_, s)) return true;
  if (problem.size() <= kMostWithRoom && finds_room(problem, proof_, share))
    return takes_proof(problem, judge_.proof(), s);
  if (has_few_cells(problem)) search_cells(problem, s, share);
  return s.status == Status::infeasible;
}

/// By a barrier method, which takes the cones as they are; else, where it cannot tell, by pyramids that hold them.
bool Solver::proves_over_cones(const Lcp& problem, const Budget& share, Solution& s) {
  if (!cone_proof_) cone_proof_ = std::make_unique<ConeProof>();
  const auto end = cone_proof_->search(problem, share, [&](const Vector& u) { return takes_proof(problem, u, s); });
  if (end != ConeProof::End::open) return end == ConeProof::End::proved;
  FacetForm form;
  if (!farkas_.propose(form.linear(problem, 32, {}, true), scratch_, share)) return false;
  form.restore_certificate(problem, scratch_, proof_);
  scratch_ = proof_;
  return (in_whole_numbers(scratch_) && takes_proof(problem, scratch_, s)) || takes_proof(problem, proof_, s);
}

bool Solver::takes_proof(const Lcp& problem, const Vector& u, Solution& s) {
  const Status before = s.status;
  s.certificate = u;
  judge_.certify(problem, tolerance(), Claim::stalled, s);
  if (s.status != Status::infeasible) s.status = before;
  return s.status == Status::infeasible;
}

/// Where the last digits of a ray stand in the way of a proof.
void Solver::take_ray_in_whole_numbers(const Lcp& problem, Solution& s) {
  if (s.ray.size() != problem.size()) return;
  proof_ = s.ray;
  if (!in_whole_numbers(proof_)) return;
  s.certificate = proof_;
  judge_.certify(problem, tolerance(), Claim::ray, s);
}

/// A certificate that proves only by the exact vector next to it: another with room for rounding, if there is one.
void Solver::put_proof_in_doubles(const Lcp& problem, Solution& s) {
  if (s.certificate.size() != problem.size() || problem.discs() || problem.size() > kMostWithRoom) return;
  const bool last = judge_.proof().size() == problem.size() && judge_.proof() == s.certificate;
  if ((!last && !judge_.proves_infeasible(problem, s.certificate)) || judge_.proof_in_doubles()) return;
  Budget share;
  share.start(budget_.remaining() / 4, budget_.cancel());
  if (finds_room(problem, s.certificate, share)) s.certificate = judge_.proof();
}

/// judge_.proof() ← a proof in doubles near u, with room for rounding, or in small whole numbers. Of the same rows
/// first; then without room in columns that are 0; then with room only where rounding leaves a wrong sign. A
/// semidefinite A leaves none but by its own rounding: uᵀAu ≤ 0 makes Au = 0.
bool Solver::finds_room(const Lcp& problem, const Vector& u, const Budget& budget) {
  constexpr Index kMostSymmetric = 12;
  constexpr int kMostWhole = 16;       // the largest entry of a proof in whole numbers
  constexpr double kMargin = 0x1p-46;  // above the rounding of u, 2⁻⁵³, below that of data
  const bool contacts = std::holds_alternative<Delassus>(problem.A);
  if (problem.size() > kMostSymmetric && (contacts || is_symmetric(problem.A))) return false;
  const Vector sums = multiply_transposed(problem.A, u);
  Vector v;
  const auto proposes = [&](bool same_rows, const std::function<bool(Index)>& in_column) {
    return !budget.exhausted() && farkas_.propose(with_margin(problem, kMargin, u, same_rows, in_column), v, budget);
  };
  const auto proves = [&] {
    const auto holds = [&] { return judge_.proves_infeasible(problem, v) && judge_.proof_in_doubles(); };
    if (holds()) return true;
    const Vector proposed = v;
    const double size = proposed.cwiseAbs().maxCoeff();
    for (int k = 1; k <= kMostWhole; ++k) {  // sums of data that cancel need round numbers
      v = (proposed * (k / size)).array().round().matrix();
      if (holds()) return true;
    }
    v = proposed;
    return false;
  };
  const int ways = (u.array() != 0).all() ? 1 : 2;  // with the same rows; with all
  for (int way = 0; way < ways; ++way)
    for (const bool all : {true, false})
      if (proposes(way == 0, [&](Index j) { return all || sums[j] != 0; }) && proves()) return true;
  for (int way = 0; way < ways; ++way) {
    std::vector<char> wrong(at(problem.size()), 0);
    v = u;
    for (bool more = true; more;) {
      more = false;
      for (const Index j : columns_of_wrong_sign(problem, v)) more = more || wrong[at(j)] == 0, wrong[at(j)] = 1;
      if (!more || !proposes(way == 0, [&](Index j) { return wrong[at(j)] != 0; })) break;
      if (proves()) return true;
    }
  }
  return false;
}

/// Where all but rounding speaks against a solution: every cell, exactly. Its answer, or its proof, into s.
void Solver::search_cells(const Lcp& problem, Solution& s, const Budget& share) {
  Enumerate search({.tolerance = tolerance()});
  search.set_proof_search(false);
  search.set_time_limit(share.remaining()), search.set_cancel(share.cancel());
  Solution found;
  search.solve(problem, found);
  const bool better = found.status == Status::infeasible || found.status == Status::solved ||
                      (found.status == Status::rounded && unsettled(s));
  if (!better) return;
  found.iterations = s.iterations;
  if (found.status == Status::infeasible) found.ray = proof_;  // a proof but for rounding
  s = std::move(found);
  if (!has_answer(s.status)) return;
  judge_.certify(problem, tolerance(), Claim::candidate, s);
}

bool Solver::passes(const Lcp& problem, Solution& s) {
  before_ = s.z;
  judge(problem, std::min(goal(), tolerance()), Claim::stalled, s);
  if (has_answer(s.status) && !s.coarse) {
    before_ = s.z, passed_ = s.status;
    return true;
  }
  s.z = before_;
  return false;
}

Solver& Solver::with_discs() {
  constexpr int kTurns = 20;
  if (!discs_) discs_ = for_discs();
  if (!discs_) discs_ = std::make_unique<Facets>(*this, facets_, kTurns, tolerance());
  return *discs_;
}

struct Solver::FixedPyramids {
  FacetForm form;
  Solution linear;
};

Solver::Solver() {
  judge_.set_stop([this] { return budget_.exhausted(); });
}
Solver::~Solver() = default;

void Solver::set_pyramids(int sides) {
  if (sides != 0 && sides < 3)
    throw std::invalid_argument("option facets = " + std::to_string(sides) + ": must be 0 (discs) or in [3, 1024]");
  pyramid_sides_ = sides;
}

/// The linear form's status and residual are the answer's: the judge has seen that form. A proof keeps the entries of
/// the problem's own rows.
const Solution& Solver::solve_pyramids(const Lcp& problem, Solution& s) {
  if (!fixed_pyramids_) fixed_pyramids_ = std::make_unique<FixedPyramids>();
  const Lcp& linear = fixed_pyramids_->form.linear(problem, pyramid_sides_);
  Solution& found = fixed_pyramids_->linear;
  solve_checked(linear, found, Start::cold);
  fixed_pyramids_->form.restore(problem, found.z, s.z);
  s.w.resize(problem.size());
  multiply(problem.A, s.z, s.w, scratch_);
  s.w += problem.b;
  s.status = found.status, s.residual = found.residual, s.rounding = found.rounding, s.coarse = found.coarse;
  s.iterations = found.iterations, s.factorizations = found.factorizations, s.factorized_rows = found.factorized_rows;
  s.miss = found.miss, s.miss.row = fixed_pyramids_->form.row_of(problem, found.miss.row);
  s.certificate.resize(0), s.ray.resize(0), s.cells.clear();
  if (found.certificate.size() == linear.size())
    fixed_pyramids_->form.restore_certificate(problem, found.certificate, s.certificate);
  return s;
}

std::string Solver::refusal(const Lcp& problem) {
  if (problem.discs() && pyramid_sides_ > 0) {
    FacetForm form;
    return why_not(form.linear(problem, pyramid_sides_));
  }
  return problem.discs() && !takes_discs() ? with_discs().why_not(problem) : why_not(problem);
}

/// Of a problem that check() has seen.
const Solution& Solver::solve_discs(const Lcp& problem, Solution& s, Start start) {
  with_discs();
  discs_->set_time_limit(time_limit_), discs_->set_outer_budget(outer_), discs_->set_cancel(cancel_),
      discs_->set_log(log_);
  discs_->set_proof_search(proof_search_);
  const double limit = time_limit_;
  IterationLog* const log = std::exchange(log_, nullptr);  // a pyramid's own iterations are another matter
  discs_->solve_checked(problem, s, start);
  time_limit_ = limit, log_ = log;
  return s;
}

const Solution& Solver::solve(const Lcp& problem, Solution& s, Start start) {
  check(problem);
  judge_.forget();
  if (problem.discs() && pyramid_sides_ > 0) return solve_pyramids(problem, s);
  if (problem.discs() && !takes_discs()) return solve_discs(problem, s, start);
  return solve_checked(problem, s, start);
}

const Solution& Solver::solve_checked(const Lcp& problem, Solution& s, Start start) {
  const Index n = problem.size();
  judge_.forget();
  s.status = Status::not_run;
  s.residual = kInf;
  s.rounding = 0;
  s.iterations = 0;
  s.factorizations = 0;
  s.factorized_rows = 0;
  s.miss = {};
  s.coarse = false;
  s.certificate.resize(0), s.ray.resize(0), s.cells.clear();
  if (start == Start::cold || s.z.size() != n || !s.z.allFinite()) {
    start = Start::cold;
    s.z.resize(n);
    s.z.setZero();
  }
  s.w.resize(n);
  if (n <= kKeptRows) {  // for the judge's further looks, needed or not
    fine_rows_.reserve(n);
    if (put_.z.size() < n) put_.z.resize(n), put_.w.resize(n);
  }
  if (!finite(problem)) {
    s.w.setConstant(std::numeric_limits<double>::quiet_NaN());
    s.status = Status::numerical_error;
    multiply(problem.A, s.z, scratch_, put_.w);
    for (Index i = n; i-- > 0;)  // 0 · ∞ is NaN
      if (!std::isfinite(scratch_[i] + problem.b[i])) s.miss.row = i, s.miss.by = kInf;
    return s;
  }
  if (!why_not(problem).empty()) {
    multiply(problem.A, s.z, s.w, scratch_);
    s.w += problem.b;
    s.status = Status::unsupported;
    return s;
  }
  begin();
  proof_sought_ = false;
  const FactorizationCount before = factorization_count();
  kept_ = false, passed_ = Status::not_run;
  Claim claim = run(problem, s, start);
  const double goal_residual = std::min(goal(), tolerance());
  const bool seen =
      kept_ && has_answer(passed_) && s.status == passed_ && s.z.size() == before_.size() && s.z == before_;
  if (!seen) judge(problem, goal_residual, claim, s);
  if (s.status == Status::ray) take_ray_in_whole_numbers(problem, s);
  if (unsettled(s)) seek_proof(problem, s);
  best_.residual = kInf, best_.status = Status::not_run;
  for (int attempt = 1; unsettled(s) && !budget_.exhausted(); ++attempt) {
    if (!better(best_, s)) best_ = s;
    if (!run_again(problem, s, attempt, claim)) break;
    judge(problem, goal_residual, claim, s);
  }
  if (unsettled(s) && better(best_, s)) {  // a harder attempt may do worse: the best z is what is reported
    best_.iterations = s.iterations;
    s = best_;
  }
  if (s.status != Status::solved && s.status != Status::infeasible && goal_residual < tolerance()) {
    const Status status = s.status;
    judge(problem, tolerance(), Claim::stalled, s);
    if (open(s)) s.status = status;
  }
  if (s.status == Status::rounded) seek_proof(problem, s);
  if (s.status == Status::infeasible && proof_search_) put_proof_in_doubles(problem, s);
  if (open(s) && budget_.exhausted()) s.status = budget_.cancelled() ? Status::cancelled : Status::time_limit;
  if (open(s) && proof_search_) judge_.explain(problem, tolerance(), s);  // else the caller judges again
  s.factorizations = factorization_count().factorizations - before.factorizations;
  s.factorized_rows = factorization_count().rows - before.rows;
  if (n > kKeptRows) {
    judge_.release(), release();
    free_memory(before_, scratch_, proof_);
  }
  return s;
}

}  // namespace orthant
