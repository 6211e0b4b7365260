#include <orthant/solvers/pivoting/path.h>

#include <orthant/solvers/factorization_count.h>
#include <orthant/solvers/pivoting/path_work.h>
#include <orthant/solvers/proof/farkas.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace orthant {
namespace {

using Digits = PathDigits;
constexpr PathVariation kVariations[] = {
    {"from the crash point", true, false, Digits::plain, 0, 0},
    {"on the ray", false, true, Digits::plain, 0, 0},
    {"from the start, long double", false, false, Digits::extended, 0, 0},
    {"on the ray, long double", false, true, Digits::extended, 0, 0},
    {"on the ray, 256 bits", false, true, Digits::wide, 0, 0},
    {"from the start, proximal", false, false, Digits::plain, 1e-4, 0},
    {"on the ray, other covering", false, true, Digits::extended, 0, 1},
    {"from another start", true, false, Digits::plain, 0, 2},
    {"on the ray, other covering", false, true, Digits::extended, 0, 3},
    {"from another start, proximal", true, false, Digits::plain, 1e-2, 4},
    {"on the ray, other covering", false, true, Digits::extended, 0, 5},
    {"from another start", false, false, Digits::extended, 0, 6},
    {"on the ray, other covering", false, true, Digits::extended, 0, 7},
    {"from another start, proximal", true, false, Digits::plain, 1, 8},
};
constexpr Index kExtendedRows = 1000;  // rows up to which long double is worth its time
constexpr Index kWideRows = 600;       // and 256 bits, of linear problems
constexpr double kTrusted = 1e4;       // growth of the merit up to which a step is taken on trust

bool worth(const PathVariation& v, Index n, bool linear) {
  return v.digits == Digits::plain || (v.digits == Digits::extended && n <= kExtendedRows) ||
         (linear && n <= kWideRows);
}

}  // namespace

// One function: the major iteration with its watchdog, restarts and line search share most of their state.
Claim Path::Work::iterate(const PathVariation& v) {
  using End = PathEnd;
  const Index n = model.size();
  ray.resize(0), cover.resize(0);
  project(start, z);
  if (v.seed != 0) {
    std::minstd_rand random(v.seed);
    const auto uniform = [&random] { return static_cast<double>(random() % 1024) / 1024; };
    cover.resize(n);
    for (double& d : cover) d = 1 / 64.0 + 16 * uniform();
    scratch = z;
    if (!v.ray)
      for (double& s : scratch) s += (std::abs(s) + 1) * (2 * uniform() - 0.5);
    project(scratch, z);
  }
  if (!model.F(z, F)) return Claim::numerical_error;
  if (v.crash) crash();
  lift(z, F, x);
  double proximal = v.proximal, best = kInf;
  int trusted = 0, idle = 0;
  merits.assign(1, merit(z, F));
  best_z = z;
  for (int k = 0; k < (linear() ? 40 : path.options_.max_steps); ++k) {
    const double residual = natural_residual(z, F);
    idle = residual < 0.5 * best ? 0 : idle + 1;
    if (residual < best) best = residual, best_z = z;
    if (residual <= model.goal && (linear() ? k > 0 : model.enough(z))) return z = best_z, Claim::candidate;
    if (linear() && idle > 3) return z = best_z, Claim::candidate;  // the judge says whether it is enough
    if (stop()) return z = best_z, Claim::time_limit;
    const Matrix* A = nullptr;
    if (!model.J(z, A)) return z = best_z, Claim::numerical_error;
    columns.load(*A);
    const double size = largest();
    if (proximal > 0) columns.load(*A, proximal * size);
    if (linear() && proximal == 0) {
      q = *model.constant;
    } else {
      q = F;
      for (Index j = 0; j < n; ++j) columns.each(j, [&](Index i, double value) { q[i] -= value * z[j]; });
    }
    points.clear();
    ++iterations;
    const bool on_ray = v.ray && (k == 0 || !linear());
    int pivots = 0;
    End end = pursue(*A, v.digits, on_ray, pivots);
    if (!linear() && !on_ray && (end == End::ray || end == End::singular)) {  // Lemke's start for the same step
      path.log(iterations, residual, 0, "on the ray");
      if (const End other = pursue(*A, v.digits, true, pivots); other == End::solved) end = other, points.clear();
    }
    if (linear()) iterations += pivots - 1;
    if (end == End::stopped) return z = best_z, Claim::time_limit;
    if (end == End::singular || (end == End::ray && !linear() && proximal < 1e-3)) {
      path.log(iterations, residual, 0, end == End::ray ? "ray: proximal" : "singular: proximal");
      if (proximal >= 1) return z = best_z, Claim::stalled;
      proximal = std::max(linear() ? 1e-6 : 1e-2, 10 * proximal);
      continue;
    }
    if (linear()) {
      path.log(iterations, natural_residual(trial_z, F), 1, v.name);
      if (end == End::ray) return Claim::ray;
      if (end == End::limit) return Claim::iteration_limit;
      x = trial_x, z = trial_z;
      if (proximal == 0) return Claim::candidate;
      model.F(z, F);
      lift(z, F, x);
      continue;
    }
    scratch = trial_x;
    const bool known = end == End::solved && scratch.allFinite() && visit(scratch);
    const double value = known ? merit(trial_z, trial_F) : kInf;
    if (value <= (1 - kDescent) * reference()) {
      accept();
      remember(value);
      trusted = 0;
      proximal = v.proximal > 0 ? proximal / 10 : 0;
      path.log(iterations, std::sqrt(2 * value), 1, v.name);
    } else if ((trusted < path.options_.watchdog || value <= 0.5 * merit(z, F)) && value <= kTrusted * reference()) {
      if (trusted++ == 0) {
        good_x = x;
        std::swap(points, good_points);
      }
      accept();
      path.log(iterations, std::sqrt(2 * value), 1, "on trust");
    } else {
      if (trusted > 0) {
        std::swap(points, good_points);
        visit(good_x);
        accept();
        trusted = 0;
      }
      const double before = merit(z, F);
      if (!search(reference())) {
        path.log(iterations, std::sqrt(2 * before), 0, "no descent");
        return z = best_z, Claim::stalled;
      }
      const double now = merit(z, F);
      remember(now);
      path.log(iterations, std::sqrt(2 * now), 0.5, "search from the last good point");
      if (now > 0.9 * before) return z = best_z, Claim::stalled;  // a valley without a solution
    }
  }
  z = best_z;
  return linear() ? Claim::stalled : Claim::iteration_limit;
}

Path::Path(const Options& options) : options_(options), work_(std::make_unique<Work>(*this)) {}
Path::~Path() = default;

std::string Path::why_not(const Lcp& problem) const {
  const Index n = problem.size() + 3 * static_cast<Index>(problem.friction.size());
  const bool sparse = std::holds_alternative<RowSparse>(problem.A) && problem.friction.empty();
  if (sparse || n <= 5000) return {};
  return "n = " + std::to_string(n) + ": dense problems take at most 5000 rows";
}

Claim Path::run(const Lcp& problem, Solution& s, Start start) {
  if (problem.size() == 0) return Claim::candidate;
  Work& work = *work_;
  work.variation = 0;
  work.iterations = 0;
  work.reduced = !problem.friction.empty();
  work.pure = work.reduced ? &work.pyramid.pure(problem, Pyramid::Form::stewart_trinkle) : &problem;
  if (work.reduced)
    work.pyramid.guess(problem, s.z, work.start);
  else
    work.start = s.z;
  if (start == Start::cold && options_.max_crash > 0 && !work.reduced &&
      work.coarse.guess(problem, budget(), work.start))
    log(0, kInf, 0, "coarse grids");
  const Lcp* pure = work.pure;
  work.model = {.lo = &pure->lo,
                .hi = &pure->hi,
                .F =
                    [pure, &work](const Vector& z, Vector& F) {
                      multiply(pure->A, z, F, work.y);
                      F += pure->b;
                      return F.allFinite();
                    },
                .J = [pure](const Vector&, Matrix const*& J) { return J = &pure->A, true; },
                .constant = &pure->b,
                .goal = 1e-14 * pure->b.lpNorm<Eigen::Infinity>()};
  Claim claim = Claim::stalled;
  run_again(problem, s, 0, claim);
  return claim;
}

bool Path::run_again(const Lcp& problem, Solution& s, int, Claim& claim) {
  if (problem.size() == 0) return false;
  Work& work = *work_;
  if (work.variation > static_cast<std::size_t>(options_.restarts)) return false;
  while (!worth(kVariations[work.variation], work.pure->size(), true))
    if (++work.variation > static_cast<std::size_t>(options_.restarts)) return false;
  work.tie_breaker = static_cast<unsigned>(work.variation);
  const PathVariation& v = kVariations[work.variation++];
  claim = work.iterate(v);
  s.iterations = work.iterations;
  if (claim == Claim::ray) {
    tidy_certificate(*work.pure, work.ray);
    if (work.reduced)
      work.pyramid.restore_certificate(problem, work.ray, s.ray);
    else
      s.ray = work.ray;
  }
  if (work.reduced)
    work.pyramid.restore(problem, work.z, s.z);
  else
    s.z = work.z;
  return true;
}

const Solution& Path::solve(const Mcp& problem, Solution& s, Start start) {
  check(problem);
  begin();
  const FactorizationCount before = factorization_count();
  const Index n = problem.size();
  Work& work = *work_;
  s.status = Status::not_run;
  s.residual = kInf, s.rounding = 0, s.iterations = 0;
  s.ray.resize(0);
  if (start == Start::cold || s.z.size() != n || !s.z.allFinite()) {
    s.z.resize(n);
    s.z.setZero();
  }
  work.start = s.z;
  work.iterations = 0;
  Solution looked_at;
  work.model = {.lo = &problem.lo,
                .hi = &problem.hi,
                .F = [&](const Vector& z, Vector& F) { return evaluate(problem, z, F); },
                .J = [&](const Vector& z, Matrix const*& J) { return J = &work.J, evaluate(problem, z, work.J); },
                .goal = 0.1 * options_.tolerance,
                .enough =
                    [&](const Vector& z) {
                      looked_at.z = z;
                      certify(problem, options_.tolerance, Claim::stalled, looked_at, &work.start);
                      return has_answer(looked_at.status);
                    }};
  Solution best;
  for (int k = 0; k <= options_.restarts; ++k) {
    const PathVariation& v = kVariations[k];
    if (!worth(v, n, false)) continue;
    if (k > 0) log(work.iterations, s.residual, 0, v.name);
    Claim claim = n == 0 ? Claim::candidate : work.iterate(v);
    if (claim == Claim::ray) claim = Claim::stalled;
    s.iterations = work.iterations;
    s.factorizations = factorization_count().factorizations - before.factorizations;
    s.factorized_rows = factorization_count().rows - before.rows;
    s.z = n == 0 ? s.z : work.z;
    certify(problem, options_.tolerance, claim, s, &work.start);
    if (has_answer(s.status)) return s;
    if (!(s.residual >= best.residual) || k == 0) best = s;
    if (budget().exhausted() || (k == 0 && claim == Claim::numerical_error)) break;
  }
  s = best;
  s.iterations = work.iterations;
  if (budget().exhausted()) s.status = budget().cancelled() ? Status::cancelled : Status::time_limit;
  return s;
}

}  // namespace orthant
