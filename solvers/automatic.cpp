#include <orthant/solvers/active_set/small_active_set.h>
#include <orthant/solvers/automatic.h>
#include <orthant/solvers/pivoting/dantzig.h>
#include <orthant/solvers/registry.h>

#include <orthant/core/support/options.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace orthant {

namespace {

struct Look {
  Index n = 0;
  bool sparse = false, applied = false;  // storage: rows, or an operator that is only applied
  bool warm = false;                     // a start value is given
  bool friction = false, symmetric = true, saddle = true, positive_diagonal = true, no_diagonal = true, z_matrix = true;
  bool nonnegative = false;  // a dense matrix without a negative entry
  bool thin = false;         // sparse: at most eight entries a row
  bool even = false;         // dense: positive diagonal entries within 10⁸ of each other
  bool skew = false;         // sparse: no positive diagonal, and rows with a zero there are their columns times −1
  bool grid = false;         // of two or three dimensions: more than four entries a row
  bool loose = false;        // an operator over at least an eighth as many velocities as rows
  bool uneven = false;       // an operator with diagonal entries a hundredfold apart
};

struct Step {
  const char* solver;
  const char* why;
  bool (*when)(const Look&);
};

constexpr Index kHandful = 6;     // rows up to which another look costs more than principal pivoting does
constexpr Index kDriven = 12;     // rows from which a look at all entries costs little
constexpr Index kTiny = 40;       // rows up to which a tableau is quickest with friction, too
constexpr Index kSmall = 400;     // rows up to which a tableau is quickest
constexpr Index kSwept = 60;      // rows from which first-order methods are quicker than a tableau, where they converge
constexpr Index kResumed = 150;   // the same from a start value, from which path is quick, too
constexpr Index kPyramids = 250;  // rows up to which 400 pivots are mostly enough for pyramids, else 1000
constexpr Index kGrid = 400;      // rows up to which sweeps over a grid are quicker than multigrid

// Rows up to which the active set is guessed first: at 300, mostly 2 to 100 times as quick; at 1000, dense, 3 to 9
// times.
constexpr Index kBold = 1500;
constexpr Index kBoldFormed = 600;  // of an operator, which has to be formed for it
constexpr Index kBoldRows = 100;    // in sparse storage, which it does not use
// With that share of an operator's rows inside, all are tried: towers of boxes, one factorization for 80 pivots.
constexpr double kPressed = 0.5;
constexpr Index kFull = 1500;   // the same of a matrix without zeros: at 1000, 4 times as quick as interior-point
constexpr Index kDense = 3000;  // rows beyond which a dense factorization is not tried lightly

constexpr Index kFewCells = 4;  // rows of which all cells cost less than another method does
constexpr Index kCells = 100;   // largest number of rows for enumerate, which itself refuses more than 2²⁰ cells

bool always(const Look&) { return true; }
bool smooth(const Look& p) { return !p.friction; }
bool quadratic_friction(const Look& p) { return p.friction && p.symmetric && p.positive_diagonal; }
bool sweeps(const Look& p) { return quadratic_friction(p) && p.n > (p.warm ? kResumed : kSwept); }
bool resumed(const Look& p) { return quadratic_friction(p) && p.warm && p.n > kDriven && p.n <= kResumed; }
bool followed(const Look& p) { return p.friction && p.n > (p.warm ? kTiny : kBoldRows) && p.n <= kSmall; }
bool pyramids(const Look& p) {
  const bool saddle = p.saddle && !p.sparse;  // n = 150, 300: the tableau is 3 to 5 times as quick
  return smooth(p) && !p.applied && !p.symmetric && !p.positive_diagonal && !saddle && p.n > kDriven && p.n <= kSmall;
}
bool game(const Look& p) { return smooth(p) && p.saddle && p.no_diagonal && p.n > kSwept && p.n <= kSmall; }
bool small_pyramids(const Look& p) { return pyramids(p) && p.even && p.n > kSwept && p.n <= kPyramids; }
bool large_pyramids(const Look& p) { return pyramids(p) && p.even && p.n > kPyramids; }
bool swept(const Look& p) { return smooth(p) && p.sparse && !p.symmetric && p.positive_diagonal && p.n > kBoldRows; }
bool nonnegative(const Look& p) {
  return smooth(p) && p.nonnegative && !p.symmetric && p.positive_diagonal && p.n > kBoldRows;
}
bool thin(const Look& p) {
  return smooth(p) && p.sparse && p.thin && p.symmetric && p.positive_diagonal && p.n > kBoldRows && p.n <= kSmall;
}
bool unswept(const Look& p) { return swept(p) && p.n <= kSmall; }
bool loose_contacts(const Look& p) {
  return quadratic_friction(p) && p.loose && !p.warm && p.n > kBoldRows && p.n <= kFull;
}
bool relaxed_cones(const Look& p) {
  return smooth(p) && p.applied && p.symmetric && p.positive_diagonal && p.n > kBoldRows;
}
bool shared_bodies(const Look& p) { return sweeps(p) && p.applied && !p.loose && !p.warm && p.n > 2 * kBoldRows; }
bool uneven_contacts(const Look& p) { return loose_contacts(p) && p.uneven; }
bool dense(const Look& p) { return quadratic_friction(p) && !p.applied && !p.sparse && p.n <= kFull; }
bool dense_friction(const Look& p) { return dense(p) && !p.warm && p.n > kBoldRows; }
bool resumed_dense_friction(const Look& p) { return dense(p) && p.warm && p.n > kTiny; }
bool small_dense_friction(const Look& p) { return dense_friction(p) && p.n <= kSmall; }
bool few_dense_friction(const Look& p) { return dense_friction(p) && p.n <= 2 * kBoldRows; }

// Where the driving variable does not end soon it seldom ends.
constexpr const char* kDrive = "dantzig:rescue=false,max_pivots=250";
constexpr const char* kRevised = "lemke:form=revised,rescue=false,max_pivots=5000";
constexpr const char* kTableau = "lemke:rescue=false,max_pivots=5000";

// Dense symmetric problems of the families take at most 45 iterations, or hundreds where interior-point takes 20 of
// five times the cost. Sparse ones take at most 10, and interior-point's iterations cost little more.
constexpr const char* kBlock = "block-pivot:max_iterations=50";
constexpr const char* kSparseBlock = "block-pivot:max_iterations=10";

// In this order; a solver that says why_not() is passed over.
constexpr Step kSteps[] = {
    {"psor:max_sweeps=1000,stop_early=true", "small grid",
     [](const Look& p) {
       return smooth(p) && p.sparse && p.grid && p.z_matrix && p.symmetric && p.n > 100 && p.n <= kGrid;
     }},
    // Tridiagonal and a random entry or two a row. 150 rows: 0.06 ms, Lemke's revised form 0.2 ms, its tableau 1.4 ms.
    // 10 000 rows: 0.02 s, path 0.09 s, interior-point 10 s, as the factors of such matrices fill in. Convection and
    // diffusion on an obstacle, 1600 rows: 1 ms, block-pivot and newton-min 50 ms.
    {"psor:max_sweeps=400,stop_early=true", "sparse, unsymmetric, cheap sweeps", swept},
    // Dense and nonnegative, 150 and 300 rows: 70 and 20 sweeps, 0.1 and 0.2 ms, Lemke's tableau 0.9 and 2.3 ms.
    {"psor:max_sweeps=100,stop_early=true", "unsymmetric, nonnegative", nonnegative},
    // Balls and journal bearings with 4000, 16 000, 65 000, 262 000 rows: 2 to 7 times as quick as block-pivot.
    {"multigrid:max_cycles=60,stop_early=true", "large grid",
     [](const Look& p) { return smooth(p) && p.sparse && p.grid && p.z_matrix && p.positive_diagonal && p.n > kGrid; }},
    {kSparseBlock, "sparse, no positive entry off the diagonal",
     [](const Look& p) { return smooth(p) && p.sparse && p.z_matrix && p.n > 100; }},
    {"newton-min", "sparse, no positive entry off the diagonal",
     [](const Look& p) { return smooth(p) && p.sparse && p.z_matrix && p.n > 100; }},
    {"lemke-howson", "no diagonal: a game?", [](const Look& p) { return smooth(p) && p.no_diagonal && p.n > 1; }},
    // Piles, walls and stacks of loose bodies, 144 to 400 rows, from no start value: sweeps answer soon (1 to 2 ms), or
    // Newton's method does, 2 to 10 ms; more sweeps 3 to 9 ms, path 13 to 35 ms. A table on 40 legs, three velocities:
    // newton-ac 20 to 50 ms, mprgp 3 ms. Mass ratio 10⁴: a spatial stack mprgp 1.2 ms, newton-ac 21 ms; a wall prox
    // 17 ms, path 80 ms.
    {"psor:max_sweeps=1000,stop_early=true", "friction, symmetric, loose bodies", loose_contacts},
    {"mprgp:max_iterations=300,stop_early=true", "friction, symmetric, loose bodies of unequal mass", uneven_contacts},
    {"newton-ac:max_steps=170", "friction, symmetric, loose bodies", loose_contacts},
    {"prox:max_outer=150", "friction, symmetric, loose bodies", loose_contacts},
    // Random contacts, 120 to 300 rows: 0.5 to 4 ms, prox 1.4 to 8 ms, Lemke's tableau 1.4 to 15 ms. Stacks, 160 rows:
    // in vain, the tableau 1.2 ms, prox 3.3 ms. n = 300 and 600, where sweeps crawl: prox 4 and 33 ms, path 400 ms.
    {"newton-ac:max_steps=20", "friction, symmetric, dense", small_dense_friction},
    {"lemke:rescue=false,max_pivots=250", "friction, symmetric, dense", few_dense_friction},
    {"prox:max_outer=100", "friction, symmetric, dense", dense_friction},
    // Tables on 40 legs, 320 rows, three or six velocities: 3 to 6 ms, where psor takes 5 to 8 ms or crawls.
    {"mprgp:max_iterations=1000,stop_early=true", "friction, symmetric, many contacts of few bodies", shared_bodies},
    // Piles of equal discs, 222 to 308 rows: 1 to 9 ms, path 8 to 31 ms. Stacks, where sweeps crawl, cost it 128 of
    // them.
    {"psor:max_sweeps=6000,stop_early=true", "friction, symmetric, cheap sweeps", sweeps},
    // Stacks and tables with 240 to 324 rows: 1 to 6 ms, path 8 to 31 ms.
    {"mprgp:max_iterations=4000,stop_early=true", "friction, symmetric", sweeps},
    // An arch of ten stones, 44 rows: 0.1 ms a step of stewart-trinkle, path 35 ms, Lemke's tableau 31 ms.
    {"mprgp:max_iterations=200", "friction, symmetric, from the start value", resumed},
    // The tightened track of a vehicle, 206 and 406 rows: 90 and 450 ms a step, where path and the tableau in more
    // digits take up to a hundred times as long.
    {"prox:max_outer=300", "friction, symmetric, dense, from the start value", resumed_dense_friction},
    // Stewart and Trinkle's form: random contacts with 80 rows 0.11 to 0.15 ms, Lemke's tableau 0.31 to 0.42 ms; 318
    // rows of a stack: 3 ms and 19 ms.
    {kDrive, "unsymmetric, a zero on the diagonal", pyramids},
    // Ten bricks, 64 rows, from the last step's impulses: 0.3 ms a solve, Lemke's tableau 1.5 ms.
    // Cold, steps of an arch and random contacts up to 84 rows: Lemke's tableau is 1.3 to 40 times as quick.
    {"path:restarts=0", "friction, from the start value or large", followed},
    // Pyramids of eight edges, six boxes, 288 rows: 10 iterations from the start value, 1200 pivots of Lemke's tableau.
    {"apgd:max_iterations=2000", "symmetric, many rows of few bodies", relaxed_cones},
    {kSparseBlock, "sparse, symmetric, positive diagonal", thin},
    {kRevised, "small, sparse, unsymmetric", unswept},
    // Games and Stewart and Trinkle's form are half zeros: friction with 240 and 400 rows takes 305 and 938 pivots, 5
    // and 36 ms, the tableau 9 and 79 ms. Mass ratio 10¹⁰ takes three times the pivots, the tableau not.
    {kRevised, "a game", game},
    {"lemke:form=revised,rescue=false,max_pivots=400", "unsymmetric, a zero on the diagonal", small_pyramids},
    {"lemke:form=revised,rescue=false,max_pivots=1000", "unsymmetric, a zero on the diagonal", large_pyramids},
    {kTableau, "small", [](const Look& p) { return p.n <= kSmall && !unswept(p); }},
    {"enumerate", "few cells", [](const Look& p) { return smooth(p) && p.n <= kFewCells; }},
    {"path:restarts=0", "friction", [](const Look& p) { return p.friction && p.n > kTiny && p.n <= kSmall; }},
    {"lemke:rescue=false,max_pivots=10000", "dense",
     [](const Look& p) { return smooth(p) && !p.sparse && p.n > kSmall && p.n <= kFull; }},
    {kSparseBlock, "sparse, symmetric, positive diagonal",
     [](const Look& p) { return smooth(p) && p.sparse && p.symmetric && p.positive_diagonal && p.n > kSmall; }},
    {kBlock, "symmetric, positive diagonal",
     [](const Look& p) {
       return smooth(p) && !p.applied && !p.sparse && p.symmetric && p.positive_diagonal && p.n > kSmall;
     }},
    // Traffic equilibria of a city, n = 3355 and 13 915: 12 and 16 factorizations, path 80 and more than 239.
    {"interior-point", "large, sparse, a saddle point",
     [](const Look& p) { return smooth(p) && p.skew && p.n > kSmall; }},
    {"path:restarts=0", "large, sparse, unsymmetric",
     [](const Look& p) { return smooth(p) && p.sparse && !p.symmetric && p.n > kSmall; }},
    {"interior-point", "large, perhaps monotone", [](const Look& p) { return smooth(p) && p.n > kSmall; }},
    // Thousands of sweeps cost less than path's restarts do, which seldom help where its first variation ended nowhere.
    {"path:restarts=0", "large, friction",
     [](const Look& p) { return p.friction && p.n > kSmall && (p.sparse || p.n <= kDense); }},
    {"nncg:max_sweeps=20000", "large, friction", [](const Look& p) { return p.friction && p.n > kSmall; }},
    {"path", "any kind", [](const Look& p) { return p.sparse || p.n <= kDense; }},
    {"interior-point", "perhaps monotone", smooth},
    {"block-pivot", "positive diagonal, more patience",
     [](const Look& p) { return smooth(p) && !p.applied && p.symmetric && p.positive_diagonal && p.n > kBoldRows; }},
    {"lemke", "small enough for more digits", [](const Look& p) { return p.n <= kDense; }},
    {"enumerate", "every cell", [](const Look& p) { return p.n <= kCells; }},
    {"newton-fb", "any kind, from the start value", [](const Look& p) { return p.sparse || p.n <= kDense; }},
    {"apgd", "nothing that factorizes was left", smooth},
    {"pgs", "nothing that factorizes was left", always},
};
constexpr std::size_t kCount = std::size(kSteps);
template <class... Kind> constexpr auto kinds(Kind... of) { return std::array{of...}; }
// Steps that try what is quick where it helps: a failure says nothing of a proof.
constexpr auto kAttempts =
    kinds(sweeps, resumed, followed, pyramids, swept, nonnegative, dense_friction, loose_contacts, uneven_contacts,
          thin, small_dense_friction, few_dense_friction, resumed_dense_friction, shared_bodies, relaxed_cones);

/// As the methods for symmetric matrices take it: W M⁻¹ Wᵀ computed row by row is symmetric to rounding only.
bool symmetric_pair(double a, double b, double diagonal_i, double diagonal_j) {
  return a == b || std::abs(a - b) <= 1e-12 * std::sqrt(diagonal_i) * std::sqrt(diagonal_j);
}

template <class Diagonal> void look_at_diagonal(const Diagonal& diagonal, Look& p) {
  double least = kInf, most = 0;
  for (const double entry : diagonal) {
    if (entry > 0) least = std::min(least, entry), most = std::max(most, entry);
    p.positive_diagonal = p.positive_diagonal && entry > 0;
    p.no_diagonal = p.no_diagonal && entry == 0;
  }
  p.even = most <= 1e8 * least;
}

Look look(const Lcp& problem, bool warm) {
  Look p;
  p.n = problem.size(), p.warm = warm, p.friction = !problem.friction.empty();
  if (const auto* dense = std::get_if<DenseMatrix>(&problem.A)) {
    look_at_diagonal(dense->diagonal(), p);
    p.nonnegative = true;
    p.saddle = !p.positive_diagonal;
    for (Index j = 0; j < p.n; ++j)
      for (Index i = 0; i < j; ++i) {
        const double a = (*dense)(i, j), b = (*dense)(j, i);
        p.symmetric = p.symmetric && symmetric_pair(a, b, (*dense)(i, i), (*dense)(j, j));
        p.saddle = p.saddle && (a == -b || ((*dense)(i, i) != 0 && (*dense)(j, j) != 0));
        p.z_matrix = p.z_matrix && a <= 0 && b <= 0;
        p.nonnegative = p.nonnegative && a >= 0 && b >= 0;
      }
  } else if (const auto* rows = std::get_if<RowSparse>(&problem.A)) {
    p.sparse = p.skew = true;
    p.thin = rows->start[static_cast<std::size_t>(p.n)] <= 8 * p.n;
    p.grid = rows->start[static_cast<std::size_t>(p.n)] > 4 * p.n;
    for (Index i = 0; i < p.n; ++i) {
      const double diagonal = rows->entry(i, i);
      p.positive_diagonal = p.positive_diagonal && diagonal > 0;
      p.no_diagonal = p.no_diagonal && diagonal == 0;
      rows->for_each_in_row(i, [&](Index j, double value) {
        if (j == i) return;
        const double other = rows->entry(j, i);
        p.skew = p.skew && (diagonal > 0 || other == -value);
        p.z_matrix = p.z_matrix && value <= 0;
        if (p.symmetric && other != value) p.symmetric = symmetric_pair(value, other, diagonal, rows->entry(j, j));
      });
    }
    p.skew = p.skew && !p.positive_diagonal;
  } else {
    const Delassus& contacts = std::get<Delassus>(problem.A);
    p.applied = true;
    p.loose = 8 * contacts.W.cols >= p.n;
    if (loose_contacts(p)) {
      double least = kInf, most = 0;
      for (Index i = 0; i < p.n; ++i) {
        const double entry = diagonal(problem.A, i);
        least = std::min(least, entry), most = std::max(most, entry);
      }
      p.uneven = most > 100 * least;
    }
    p.no_diagonal = p.z_matrix = false;
  }
  return p;
}

}  // namespace

struct Automatic::Work {
  explicit Work(double accepted) : few(DantzigOptions{.tolerance = accepted, .rescue = false}) {
    few.set_proof_search(false);  // once, here, is enough
  }

  Look look;
  bool looked = false;
  std::size_t next = 0;
  std::array<std::unique_ptr<Solver>, kCount> solvers;  // made when first needed, kept
  Vector start;
  bool warm = false;
  Solution inner;
  int iterations = 0;
  double overrun = 0;  // [s] of the last step beyond its share of the time
  SmallActiveSet bold;
  Dantzig few;
  Lcp dense;  // a small problem stored otherwise, formed once
  const Lcp* formed = nullptr;

  void look_at(const Lcp& problem) {
    if (!looked) look = orthant::look(problem, warm), looked = true;
  }

  /// The problem with a dense matrix.
  const Lcp& small(const Lcp& problem) {
    if (std::holds_alternative<DenseMatrix>(problem.A)) return problem;
    to_dense(problem.A, as<DenseMatrix>(dense.A));
    dense.b = problem.b, dense.lo = problem.lo, dense.hi = problem.hi, dense.friction = problem.friction;
    return dense;
  }

  std::string tolerance;  // "tolerance=1e-6" where the caller asks for another than is usual

  Solver* step(std::size_t k, const Lcp& problem) {
    if (!kSteps[k].when(look)) return nullptr;
    for (std::size_t before = 0; before < k; ++before)
      if (std::string_view(kSteps[before].solver) == kSteps[k].solver && kSteps[before].when(look)) return nullptr;
    auto& solver = solvers[k];
    if (!solver) {
      const std::string spec = kSteps[k].solver;
      solver = make_solver(tolerance.empty() ? spec : spec + (spec.find(':') == spec.npos ? ":" : ",") + tolerance);
      solver->set_proof_search(false);  // once, here, is enough
    }
    return solver->why_not(problem).empty() ? solver.get() : nullptr;
  }
};

Automatic::Automatic(const Options& options) : options_(options), work_(std::make_unique<Work>(options.tolerance)) {
  if (options.tolerance != Options{}.tolerance) work_->tolerance = "tolerance=" + detail::text_of(options.tolerance);
}
Automatic::~Automatic() = default;

Claim Automatic::run(const Lcp& problem, Solution& s, Start start) {
  Work& work = *work_;
  work.next = 0;
  work.iterations = 0;
  work.overrun = 0;
  work.warm = start == Start::warm;
  if (work.warm) work.start = s.z;
  work.looked = false;
  const bool rows = std::holds_alternative<RowSparse>(problem.A),
             contacts = std::holds_alternative<Delassus>(problem.A);
  const bool friction = !problem.friction.empty();
  const Index most = rows || friction ? kBoldRows : contacts ? kBoldFormed : kBold;
  work.formed = problem.size() <= most ? &work.small(problem) : &problem;
  bool bold = problem.size() <= most;
  if (bold && !rows && !contacts && problem.size() > kDriven && problem.size() <= kSmall && !work.warm)
    work.look_at(problem), bold = !pyramids(work.look) && !nonnegative(work.look);
  if (bold && !budget().cancelled() &&
      work.bold.solve(*work.formed, s.z, work.iterations, budget(), contacts ? kPressed : SmallActiveSet::kMostly)) {
    s.iterations = work.iterations;
    log(0, 0, 0, "active-set");
    return Claim::candidate;
  }
  Claim claim = Claim::stalled;
  if (problem.size() <= kHandful && !friction && !rows && !contacts) {
    work.few.solve(problem, work.inner, Start::cold);
    s.z = work.inner.z;
    s.iterations = work.iterations += work.inner.iterations;
    log(0, work.inner.residual, 0, "dantzig (few rows)");
    if (work.inner.status == Status::infeasible) trust(work.few);
    return handed_on(work.inner, s);
  }
  if (budget().exhausted()) {
    if (work.warm)
      s.z = work.start;
    else
      s.z.setZero();
    return Claim::time_limit;
  }
  run_again(problem, s, 0, claim);
  return claim;
}

bool Automatic::run_again(const Lcp& problem, Solution& s, int attempt, Claim& claim) {
  Work& work = *work_;
  work.look_at(problem);
  Solver* solver = nullptr;
  std::size_t k = work.next;
  for (; k < kCount && solver == nullptr; ++k) solver = work.step(k, problem);
  if (solver == nullptr) return false;
  work.next = k--;
  double share = budget().remaining();
  if (share < kInf) {
    bool last = true;
    for (std::size_t later = k + 1; later < kCount && last; ++later) last = work.step(later, problem) == nullptr;
    if (!last) share /= 2;
    if (share < work.overrun) {  // looks, scaling and the judge alone would take longer
      work.next = kCount;
      claim = Claim::time_limit;
      return true;
    }
  }
  const double before = budget().remaining();
  solver->set_time_limit(share);
  solver->set_cancel(budget().cancel());
  if (work.warm) work.inner.z = work.start;
  // A tableau takes the matrix formed already; who comes later, where rounding of its entries may be the trouble, does
  // not.
  const bool tableau = kSteps[k].solver == std::string_view(kTableau);
  solver->solve(tableau ? *work.formed : problem, work.inner, work.warm ? Start::warm : Start::cold);
  if (share < kInf) work.overrun = before - budget().remaining() - share;
  s.z = work.inner.z;
  claim = handed_on(work.inner, s);
  if (work.inner.status == Status::infeasible) trust(*solver);
  s.iterations = work.iterations += work.inner.iterations;
  const auto when = kSteps[k].when;
  const bool tried = std::ranges::find(kAttempts, when) != std::end(kAttempts);
  const bool in_vain = tried && !has_answer(work.inner.status) && work.inner.status != Status::infeasible;
  if (logging())
    log(attempt, work.inner.residual, 0,
        (std::string(kSteps[k].solver) + " (" + kSteps[k].why + "): " + std::string(name(work.inner.status))).c_str());
  if (in_vain && !budget().exhausted()) return run_again(problem, s, attempt, claim);  // says nothing of a proof
  return true;
}

}  // namespace orthant
