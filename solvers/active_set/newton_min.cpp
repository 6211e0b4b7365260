#include <orthant/solvers/active_set/newton_min.h>

#include <algorithm>
#include <cmath>

namespace orthant {

namespace {

constexpr Index kPure = 500;    // rows of a problem with friction beyond which its dense pure form is not tried
constexpr double kMet = 1e-15;  // of b in each row of large problems, all in one unit: what is left is rounding
constexpr Index kSquare = 500;  // rows of a sparse problem up to which it is squared, dense

}  // namespace

Claim NewtonMin::run(const Lcp& problem, Solution& s, Start start) {
  if (problem.size() == 0) return Claim::candidate;
  warm_ = start == Start::warm;
  if (!problem.friction.empty()) start_ = s.z;
  large_ = nullptr;
  if (problem.friction.empty()) {
    if (start == Start::cold && !(options_.coarse_start == 1 && coarse_.guess(problem, budget(), s.z))) {
      rows_.load(problem, s.z, budget());
      if (rows_.release_all()) s.z = rows_.z.cwiseMax(problem.lo).cwiseMin(problem.hi);
    }
    const Claim claim = iterate(problem, s, s.z);
    s.z = s.z.cwiseMax(problem.lo).cwiseMin(problem.hi);  // a rounding outside is none of the answer's
    return claim;
  }
  large_ = by_rows(problem);
  if (large_ != nullptr) return rounds(*large_, problem, s);
  const Lcp& pure = pyramid_.pure(problem);
  pyramid_.guess(problem, s.z, y_);
  const Claim claim = iterate(pure, s, y_);
  y_ = y_.cwiseMax(pure.lo).cwiseMin(pure.hi);  // a rounding outside is none of the answer's
  pyramid_.restore(problem, y_, s.z);
  return claim;
}

bool NewtonMin::run_again(const Lcp& problem, Solution& s, int attempt, Claim& claim) {
  if (problem.friction.empty()) {
    if (attempt > 3 || (attempt == 2 && !warm_)) return false;
    if (attempt == 2) {
      s.z.setZero();
      claim = run(problem, s, Start::cold);
    } else {
      polish_.improve(problem, s.z, budget(), true);  // the merit adds up rows: a light one may not be right yet
    }
    return true;
  }
  if (large_ != nullptr) {
    if (attempt > 1 || !warm_) return false;
    s.z.setZero();
    claim = rounds(*large_, problem, s);
    return true;
  }
  if (attempt > 3) return false;
  if (attempt == 3) {  // the pure form once more
    s.z.setZero();
    claim = run(problem, s, Start::cold);
    return true;
  }
  s.z = start_;
  if (attempt == 2) s.z.setZero();
  claim = frozen_.iterate(problem, s.z, budget(), [this, &s](const Lcp& box, Vector& z) {
    const Claim round = iterate(box, s, z);
    z = z.cwiseMax(box.lo).cwiseMin(box.hi);
    return round;
  });
  return true;
}

/// A large problem with friction, its matrix by rows; null where it is small or dense.
const Lcp* NewtonMin::by_rows(const Lcp& problem) {
  if (problem.size() <= kPure || std::holds_alternative<DenseMatrix>(problem.A)) return nullptr;
  return &with_rows(problem, formed_);
}

/// Friction frozen round by round, until the judge would take z.
Claim NewtonMin::rounds(const Lcp& problem, const Lcp& given, Solution& s) {
  Vector& z = y_;
  z = s.z;
  const auto solve_box = [this, &s](const Lcp& box, Vector& from) {
    const Claim round = iterate(box, s, from);
    from = from.cwiseMax(box.lo).cwiseMin(box.hi);
    return round;
  };
  const auto done = [this, &given, &s](const Vector& now) {
    s.z = now;
    return passes(given, s);
  };
  const Claim claim = frozen_.iterate(problem, z, budget(), solve_box, done);
  s.z = z;
  return claim;
}

double NewtonMin::merit(const Lcp& p, const Vector& z) {
  multiply(p.A, z, w_, scratch_);
  w_ += p.b;
  H_.resize(z.size());
  for (Index i = 0; i < z.size(); ++i) {
    const double d = rows_.scale(i);
    H_[i] = d * (z[i] - std::clamp(z[i] - w_[i] / d, p.lo[i], p.hi[i]));
  }
  return H_.squaredNorm();
}

Claim NewtonMin::iterate(const Lcp& p, Solution& s, Vector& z) {
  const Index n = p.size();
  rows_.load(p, z, budget());
  double now = merit(p, z);
  recent_.assign(1, now);
  double best = now;
  Vector& kept = s.w;  // free until the judge writes w: the best point so far
  kept = z;
  bool full = false;
  const double met = large_ == nullptr ? 0 : kMet * std::sqrt(static_cast<double>(n)) * p.b.lpNorm<Eigen::Infinity>();
  for (int begun = s.iterations; s.iterations - begun < options_.max_iterations;) {
    ++s.iterations;
    rows_.z = z;
    rows_.w = w_;
    bool same = full;  // the choice that led here by a full step: what is left is rounding
    for (Index i = 0; i < n; ++i) {
      const Side side = rows_.target(i);
      same = same && side == rows_.side[at(i)];
      rows_.side[at(i)] = side;
    }
    const double limit = *std::max_element(recent_.begin(), recent_.end());
    double length = 0;
    if (rows_.solve() || rows_.solve_near(z)) {
      direction_ = rows_.z - z;
      const bool rounding = (direction_.array().abs() <= 0x1p-50 * z.array().abs()).all();
      if (rounding || (same && !(merit(p, rows_.z) < now))) {
        z = kept;
        return Claim::candidate;  // a fixed point: to be judged
      }
      for (length = 1; length > 1e-8; length /= 2) {
        trial_ = z + length * direction_;
        const double value = merit(p, trial_);
        if (value <= (1 - 1e-4 * length) * limit) break;
      }
      if (length <= 1e-8) length = 0;
    }
    if (length == 0) {
      trial_ = z;
      if (!marquardt(p, trial_, limit)) {
        z = kept;
        return Claim::candidate;  // no progress: the judge says whether it is enough
      }
    }
    z = trial_;
    now = merit(p, z);
    full = length == 1;
    log(s.iterations, std::sqrt(now), length, length > 0 ? "newton" : "levenberg-marquardt");
    if (now < best) best = now, kept = z;
    if (std::sqrt(now) <= met) return Claim::candidate;  // redundant rows: another step would lead away again
    if (recent_.size() >= at(options_.memory)) recent_.erase(recent_.begin());
    recent_.push_back(now);
    if (budget().exhausted()) return Claim::time_limit;
  }
  z = kept;
  return Claim::iteration_limit;
}

/// (JᵀJ + λ I) d = −Jᵀ H on the element chosen in rows_.side, λ raised from small until ‖H‖² falls. Dense algebra.
bool NewtonMin::marquardt(const Lcp& p, Vector& z, double limit) {
  const Index n = p.size();
  // A full n × n product each: beyond this, honest failure.
  if (n > (std::holds_alternative<RowSparse>(p.A) ? kSquare : 2000) || budget().exhausted()) return false;
  const double start = merit(p, z);
  to_dense(p.A, J_);
  for (Index i = 0; i < n; ++i)
    if (rows_.side[at(i)] != Side::inside) J_.row(i).setZero(), J_(i, i) = rows_.scale(i);
  gradient_.resize(n);
  gradient_.noalias() = J_.transpose() * H_;
  if (!gradient_.allFinite() || gradient_.lpNorm<Eigen::Infinity>() == 0) return false;
  normal_.resize(n, n);
  normal_.noalias() = J_.transpose() * J_;
  const double unit = normal_.diagonal().maxCoeff();
  from_ = z;
  for (double weight = 1e-10; weight < 1e4 && !budget().exhausted(); weight *= 100) {
    shifted_.A = normal_;
    shifted_.A.diagonal().array() += weight * unit;
    if (!shifted_.factorize(0)) continue;
    direction_ = gradient_;
    shifted_.solve(direction_);
    z = from_ - direction_;
    if (z.allFinite() && merit(p, z) < std::min(limit, start) * (1 - 1e-10)) return true;
  }
  z = from_;
  return false;
}

}  // namespace orthant
