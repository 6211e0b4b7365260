#include <orthant/solvers/pivoting/path.h>

#include <orthant/core/lcp/pyramid.h>
#include <orthant/solvers/active_set/coarse_start.h>
#include <orthant/solvers/active_set/fischer_burmeister.h>
#include <orthant/solvers/factorization_count.h>
#include <orthant/solvers/pivoting/normal_path.h>
#include <orthant/solvers/proof/farkas.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace orthant {
namespace {

/// What a restart changes. The first is the method as it stands in path.h; the others go where theory promises most.
enum class Digits { plain, extended, wide };  // double, long double, 256 bits (scalars.h)
struct Variation {
  const char* name;
  bool crash, ray;  // crash first; paths start on the ray
  Digits digits;    // to pivot in
  double proximal;  // ε relative to the largest entry of J
  unsigned seed;    // 0: the given start and e as covering vector; else random ones
};
constexpr Variation kVariations[] = {
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
constexpr int kCrashNonlinear = 2;     // a step costs a Jacobian there, and is counted as one
constexpr double kDescent = 1e-4;      // share of the promised decrease that must be had

bool worth(const Variation& v, Index n, bool linear) {
  return v.digits == Digits::plain || (v.digits == Digits::extended && n <= kExtendedRows) ||
         (linear && n <= kWideRows);
}

/// The problem as the method sees it, linear or not.
struct Model {
  const Vector *lo = nullptr, *hi = nullptr;
  std::function<bool(const Vector& z, Vector& F)> F;         // false: not finite
  std::function<bool(const Vector& z, Matrix const*& J)> J;  // false: not finite
  const Vector* constant = nullptr;                          // of a linear problem: b
  double goal = 0;                                           // natural residual at which to stop
  std::function<bool(const Vector&)> enough;                 // nonlinear: whether the judge would accept z
  Index size() const { return lo->size(); }
};

}  // namespace

struct Path::Work {
  explicit Work(Path& owner) : path(owner) {}
  Path& path;
  Pyramid pyramid;
  const Lcp* pure = nullptr;
  bool reduced = false;
  std::size_t variation = 0;
  Model model;
  Matrix J;
  Vector start, y, scratch;

  Columns columns;
  Basis<double> basis;  // of the crash
  CoarseStart coarse;
  NormalPath<double> normal_path;
  NormalPath<long double> long_path;
  NormalPath<detail::Float256> wide_path;
  PathPoints points, good_points;  // of the last step; of the one from good_x, while steps are taken on trust
  Vector z, x, F, q, trial_z, trial_x, trial_F, good_x, ray, cover, step, gradient;
  std::vector<double> merits;
  int iterations = 0;
  unsigned tie_breaker = 0;

  double merit(const Vector& at_z, const Vector& at_F) const {
    double sum = 0;
    for (Index i = 0; i < at_z.size(); ++i) {
      const double phi = detail::complementarity_row(1, at_z[i], at_F[i], (*model.lo)[i], (*model.hi)[i]).value;
      sum += phi * phi;
    }
    return std::isfinite(sum) ? 0.5 * sum : kInf;
  }
  double natural_residual(const Vector& at_z, const Vector& at_F) const {
    double r = 0;
    for (Index i = 0; i < at_z.size(); ++i)
      r = std::max(r, std::abs(at_z[i] - std::clamp(at_z[i] - at_F[i], (*model.lo)[i], (*model.hi)[i])));
    return r;
  }
  void project(const Vector& from, Vector& to) const {
    to.resize(from.size());
    for (Index i = 0; i < from.size(); ++i) to[i] = std::clamp(from[i], (*model.lo)[i], (*model.hi)[i]);
  }
  /// The x that stands for z: beyond a bound by as much as F presses against it.
  void lift(const Vector& at_z, const Vector& at_F, Vector& to) const {
    to = at_z;
    for (Index i = 0; i < to.size(); ++i)
      if ((at_z[i] == (*model.lo)[i] && at_F[i] > 0) || (at_z[i] == (*model.hi)[i] && at_F[i] < 0)) to[i] -= at_F[i];
  }
  BasisStorage storage(const Matrix& A) const {
    return std::holds_alternative<RowSparse>(A) ? BasisStorage::sparse : BasisStorage::dense;
  }
  double largest() const {
    double size = 0;
    for (const double value : columns.value) size = std::max(size, std::abs(value));
    return size;
  }
  bool linear() const { return model.constant != nullptr; }
  int max_pivots() const {
    return path.options_.max_pivots > 0 ? path.options_.max_pivots : 3000 + 50 * static_cast<int>(model.size());
  }
  bool stop() const { return path.budget().exhausted(); }

  /// Trial point x moved to z = π(x) and its F: false when F is not finite there.
  bool visit(const Vector& to_x) {
    trial_x = to_x;
    project(trial_x, trial_z);
    return model.F(trial_z, trial_F);
  }
  void accept() { x = trial_x, z = trial_z, F = trial_F; }

  // Projected Newton steps while they do some good. z, F: start and result.
  void crash() {
    double now = merit(z, F);
    const int most = linear() ? path.options_.max_crash : std::min(path.options_.max_crash, kCrashNonlinear);
    for (int k = 0; k < most && !stop(); ++k) {
      if (natural_residual(z, F) <= model.goal) return;
      const Matrix* A = nullptr;
      if (!model.J(z, A)) return;
      if (!linear() || k == 0) columns.load(*A);
      const auto pressed = [&](Index i) {
        return (z[i] == (*model.lo)[i] && F[i] >= 0) || (z[i] == (*model.hi)[i] && F[i] <= 0);
      };
      basis.reset(model.size(), storage(*A), 64, &path.budget());
      if (!basis.factorize([&](Index i, const auto& add) {
            if (pressed(i))
              add(i, 1.0);
            else
              columns.each(i, add);
          }))
        return;
      if (!linear()) ++iterations;
      step = -F;
      basis.solve(step);
      bool moved = false;
      for (double length = 1; length > 0.1 && !moved; length /= 2) {
        scratch = z;
        for (Index i = 0; i < model.size(); ++i)
          if (!pressed(i)) scratch[i] += length * step[i];
        if (!scratch.allFinite() || !visit(scratch)) continue;
        const double value = merit(trial_z, trial_F);
        if (value > (1 - 0.1 * length) * now) continue;
        z = trial_z, F = trial_F, now = value, moved = true;
        path.log(iterations, std::sqrt(2 * now), length, "crash");
      }
      if (!moved) return;
    }
  }

  // The step: points holds the path from x for the linearization there; claims like NormalPath.
  template <class T> PathEnd follow(NormalPath<T>& p, const Matrix& A, bool on_ray) {
    using End = PathEnd;
    p.load(columns, q, *model.lo, *model.hi, storage(A), path.budget());
    p.break_ties_by(tie_breaker);
    if (!(on_ray ? p.start_on_ray(cover) : p.start(x))) return End::singular;
    const auto end = p.follow(
        max_pivots(), [&](double) { return stop(); }, linear() ? nullptr : &points);
    p.point(trial_z, trial_x);
    if (end == End::ray) p.direction(ray);
    return end;
  }

  // Backwards along the path, then along the first piece, then down the gradient of the merit. x, z, F: the good point.
  bool search(double reference) {
    const auto n = static_cast<std::size_t>(model.size());
    const auto good_enough = [&](double gain) { return merit(trial_z, trial_F) <= (1 - kDescent * gain) * reference; };
    const Vector origin = x;
    for (std::size_t p = points.t.size(); p-- > 1;) {
      const std::size_t left = points.t.size() - p;
      if (left > 8 && (left & (left - 1)) != 0 && p > 1) continue;  // the last ones, then ever fewer, and the first
      scratch = Eigen::Map<const Eigen::VectorXd>(points.x.data() + p * n, model.size());
      if (scratch.allFinite() && visit(scratch) && good_enough(std::max(points.t[p], 0.01))) return accept(), true;
    }
    if (points.t.size() > 1) {
      const Eigen::Map<const Eigen::VectorXd> first(points.x.data() + n, model.size());
      for (double length = 0.5; length > 1e-6; length /= 2) {
        scratch = (1 - length) * origin + length * first;
        if (scratch.allFinite() && visit(scratch) && good_enough(0.01 * length)) return accept(), true;
      }
    }
    return descend();
  }
  bool descend() {
    const Index n = model.size();
    const Matrix* A = nullptr;
    if (!model.J(z, A)) return false;
    columns.load(*A);
    Vector da, right;
    da.resize(n), right.resize(n), gradient.resize(n);
    for (Index i = 0; i < n; ++i) {
      const auto s = detail::complementarity_row(1, z[i], F[i], (*model.lo)[i], (*model.hi)[i]);
      da[i] = s.da * s.value, right[i] = s.db * s.value;
    }
    for (Index j = 0; j < n; ++j) {
      gradient[j] = da[j];
      columns.each(j, [&](Index i, double value) { gradient[j] += value * right[i]; });
    }
    const double now = merit(z, F), size = gradient.squaredNorm();
    const double longest = 2 * now / size;  // infinite where the gradient's square is lost to underflow
    if (!(size > 0) || !std::isfinite(size) || !std::isfinite(longest)) return false;
    const Vector from = z;
    for (double length = longest; length > 5e-15 * longest && !stop(); length /= 4) {
      scratch = from - length * gradient;
      if (!scratch.allFinite() || !visit(scratch)) continue;
      const double promised = gradient.dot(from - trial_z);
      if (promised > 0 && merit(trial_z, trial_F) <= now - kDescent * promised) {
        lift(trial_z, trial_F, trial_x);
        return accept(), true;
      }
    }
    return false;
  }

  // One variation from `start`; the result in z. One function: the major iteration with its watchdog, restarts and line
  // search share most of their state.
  Claim iterate(const Variation& v) {
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
      const auto pursue = [&](bool from_ray) {
        return v.digits == Digits::plain      ? follow(normal_path, *A, from_ray)
               : v.digits == Digits::extended ? follow(long_path, *A, from_ray)
                                              : follow(wide_path, *A, from_ray);
      };
      End end = pursue(on_ray);
      if (!linear() && !on_ray && (end == End::ray || end == End::singular)) {  // Lemke's start for the same step
        path.log(iterations, residual, 0, "on the ray");
        if (const End other = pursue(true); other == End::solved) end = other, points.clear();
      }
      const int pivots = v.digits == Digits::plain      ? normal_path.pivots()
                         : v.digits == Digits::extended ? long_path.pivots()
                                                        : wide_path.pivots();
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
  double reference() const { return *std::max_element(merits.begin(), merits.end()); }
  void remember(double value) {
    if (merits.size() >= static_cast<std::size_t>(path.options_.memory)) merits.erase(merits.begin());
    merits.push_back(value);
  }
  Vector best_z;
};

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
  const Variation& v = kVariations[work.variation++];
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
                      certify(problem, options_.tolerance, Claim::stalled, looked_at);
                      return has_answer(looked_at.status);
                    }};
  Solution best;
  for (int k = 0; k <= options_.restarts; ++k) {
    const Variation& v = kVariations[k];
    if (!worth(v, n, false)) continue;
    if (k > 0) log(work.iterations, s.residual, 0, v.name);
    Claim claim = n == 0 ? Claim::candidate : work.iterate(v);
    if (claim == Claim::ray) claim = Claim::stalled;
    s.iterations = work.iterations;
    s.factorizations = factorization_count().factorizations - before.factorizations;
    s.factorized_rows = factorization_count().rows - before.rows;
    s.z = n == 0 ? s.z : work.z;
    certify(problem, options_.tolerance, claim, s);
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
