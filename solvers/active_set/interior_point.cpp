#include <orthant/solvers/active_set/interior_point.h>

#include <orthant/core/lcp/judge/definite.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace orthant {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kExact = 1e-13;   // residual, relative as certify() has it, at which crossover is done
constexpr double kExplained = 16;  // ρ (solution.h) times this: what rounding explains
constexpr std::array kStarts = {1.0, 1e3, 1e6, 1e9};  // the slacks at the start, relative to Mehrotra's

}  // namespace

std::string InteriorPoint::why_not(const Lcp& problem) const {
  for (const Friction& f : problem.friction)
    if (f.mu > 0) return "friction rows: their bounds depend on z, which makes the problem not monotone";
  return "";
}

void InteriorPoint::load(const Lcp& p) {
  block_.load(p.A, &budget());
  detail::row_sizes(p.A, scale_);
  lo_ = p.lo, hi_ = p.hi;
  for (const Friction& f : p.friction) lo_[f.first] = hi_[f.first] = 0;  // μ = 0
  bounds_.clear(), open_.clear();
  for (Index i = 0; i < p.size(); ++i) {
    if (lo_[i] == hi_[i]) continue;
    open_.push_back(i);
    if (lo_[i] > -kInf) bounds_.push_back({i, 1, lo_[i]});
    if (hi_[i] < kInf) bounds_.push_back({i, -1, hi_[i]});
  }
  const auto m = static_cast<Index>(bounds_.size());
  for (Vector* v : {&s_, &l_, &ds_, &dl_, &target_, &gap_, &lean_}) v->resize(m);
  side_.resize(at(p.size()));
  shift_.resize(p.size()), D_.resize(p.size()), dz_.resize(p.size()), r_.resize(p.size());
}

void InteriorPoint::residuals(const Lcp& p) {
  multiply(p.A, z_, w_, scratch_);
  size_ = p.b.lpNorm<Eigen::Infinity>() + w_.lpNorm<Eigen::Infinity>();
  w_ += p.b;
  r_ = w_;
  mu_ = 0, error_ = 0;
  for (std::size_t k = 0; k < bounds_.size(); ++k) {
    const auto& [i, sign, value] = bounds_[k];
    const Index j = static_cast<Index>(k);
    r_[i] -= sign * l_[j];
    gap_[j] = sign * (z_[i] - value) - s_[j];
    mu_ += s_[j] * l_[j];
    error_ = std::max({error_, scale_[i] * std::abs(gap_[j]), std::min(scale_[i] * s_[j], l_[j])});
  }
  if (!bounds_.empty()) mu_ /= static_cast<double>(bounds_.size());
  for (const Index i : open_) error_ = std::max(error_, std::abs(r_[i]));
  if (size_ > 0) error_ /= size_;
}

void InteriorPoint::barrier() {
  D_.setZero();
  for (Index k = 0; k < s_.size(); ++k) D_[bounds_[at(k)].row] += l_[k] / s_[k];
}

bool InteriorPoint::factorize() {
  barrier();
  for (double least = 1e-14; least < 1e-4; least *= 100) {  // A + D is regular, up to rounding
    shift_ = D_.cwiseMax(least * scale_);
    if (block_.factorize(open_, &shift_)) return true;
  }
  return false;
}

/// x ← (A + D)⁻¹ x on the rows with lo < hi, 0 on the others.
void InteriorPoint::solve_open(Vector& x) {
  const auto m = static_cast<Index>(open_.size());
  rhs_.resize(m);
  for (Index k = 0; k < m; ++k) rhs_[k] = x[open_[at(k)]];
  block_.solve(rhs_, part_);
  x.setZero();
  for (Index k = 0; k < m; ++k) x[open_[at(k)]] = part_[k];
}

/// s dl + l ds = target, ds = σ dz + gap, A dz − Σ σ dl = −r.
void InteriorPoint::direction() {
  const auto m = static_cast<Index>(bounds_.size());
  dz_ = -r_;
  for (Index k = 0; k < m; ++k) {
    const auto& [i, sign, value] = bounds_[at(k)];
    dz_[i] += sign * (target_[k] - l_[k] * gap_[k]) / s_[k];
  }
  solve_open(dz_);
  for (Index k = 0; k < m; ++k) {
    const auto& [i, sign, value] = bounds_[at(k)];
    ds_[k] = sign * dz_[i] + gap_[k];
    dl_[k] = (target_[k] - l_[k] * ds_[k]) / s_[k];
  }
}

double InteriorPoint::step_length() const {
  double step = 1e300;
  for (Index k = 0; k < s_.size(); ++k) {
    if (ds_[k] < 0) step = std::min(step, -s_[k] / ds_[k]);
    if (dl_[k] < 0) step = std::min(step, -l_[k] / dl_[k]);
  }
  return step;
}

/// (A + diag) z = −b, then Mehrotra's shifts, the slacks `farther` from the boundary.
bool InteriorPoint::start(const Lcp& p, double farther) {
  shift_ = scale_;
  for (int attempt = 0; !block_.factorize(open_, &shift_); ++attempt) {  // A = −diag, say
    if (attempt == 3) return false;
    shift_ *= 8;
  }
  z_.resize(p.size());
  for (Index i = 0; i < p.size(); ++i) z_[i] = std::clamp(0.0, lo_[i], hi_[i]);
  multiply(p.A, z_, w_, scratch_);
  dz_ = -w_ - p.b;
  solve_open(dz_);
  z_ += dz_;
  multiply(p.A, z_, w_, scratch_);
  w_ += p.b;
  double least_s = 0, least_l = 0;
  const Index m = s_.size();
  for (Index k = 0; k < m; ++k) {
    const auto& [i, sign, value] = bounds_[at(k)];
    s_[k] = sign * (z_[i] - value);
    l_[k] = sign * w_[i];
    if (hi_[i] < kInf && lo_[i] > -kInf) l_[k] = std::max(l_[k], 0.0);
    least_s = std::min(least_s, s_[k]);
    least_l = std::min(least_l, l_[k]);
  }
  s_.array() -= 1.5 * least_s, l_.array() -= 1.5 * least_l;
  const double product = s_.dot(l_), sum_s = s_.sum(), sum_l = l_.sum();
  const double unit_l = std::max(p.b.lpNorm<Eigen::Infinity>(), w_.lpNorm<Eigen::Infinity>());
  const double more_s = product > 0 ? 0.5 * product / sum_l : 0, more_l = product > 0 ? 0.5 * product / sum_s : 0;
  for (Index k = 0; k < m; ++k) {
    const double scale = scale_[bounds_[at(k)].row];
    lean_[k] = l_[k] > scale * s_[k] ? -1 : 0;
    s_[k] += more_s, l_[k] += more_l;
    if (!(s_[k] > 0)) s_[k] = unit_l > 0 ? unit_l / scale : 1;
    if (!(l_[k] > 0)) l_[k] = unit_l > 0 ? unit_l : scale;
    if (farther > 1) s_[k] = farther * std::max(s_[k], more_s);
  }
  return z_.allFinite();
}

/// z cut to the bounds, judged; true when it is accepted at rounding level. The best is kept.
bool InteriorPoint::keep(const Lcp& p, const Vector& z) {
  trial_.z = z.cwiseMax(lo_).cwiseMin(hi_);
  judge_.certify(p, kExact, Claim::candidate, trial_);
  const auto settled = [this](const Solution& s) { return has_answer(s.status) && !judge_.coarse(); };
  bool solved = settled(trial_);  // row by row: the largest residual may still be another's
  if (!solved && at_bounds_.put(p, trial_, put_.z)) {
    judge_.certify(p, kExact, Claim::candidate, put_);
    solved = settled(put_);
    if (solved || put_.residual < best_.residual) best_.residual = put_.residual, best_.z = put_.z;
    return solved;
  }
  if (solved || trial_.residual < best_.residual) best_.residual = trial_.residual, best_.z = trial_.z;
  return solved;
}

/// Proximal steps from z towards w = 0 inside, w = A z + b (b null: 0), the weights D brought to at most `most` of A's
/// entries.
bool InteriorPoint::solve_inside(const Lcp& p, const Vector* b, double most, Vector& z) {
  double largest = most;
  for (const Index i : inside_) largest = std::max(largest, D_[i] / scale_[i]);
  shift_ = (most / largest * D_).cwiseMax(1e-14 * scale_);
  if (!block_.factorize(inside_, &shift_)) return false;
  double last = kInf;
  const auto m = static_cast<Index>(inside_.size());
  rhs_.resize(m);
  for (int step = 0; step < 40 && !budget().exhausted(); ++step) {
    multiply(p.A, z, w_, scratch_);
    if (b != nullptr) w_ += *b;
    for (Index k = 0; k < m; ++k) rhs_[k] = -w_[inside_[at(k)]];
    const double now = m > 0 ? rhs_.lpNorm<Eigen::Infinity>() : 0;
    inside_error_ = now;
    if (!(now < 0.5 * last)) break;
    last = now;
    block_.solve(rhs_, part_);
    for (Index k = 0; k < m; ++k) z[inside_[at(k)]] += part_[k];
  }
  return z.allFinite();
}

/// The number of rows on the wrong side, by more than rounding explains; they change sides.
Index InteriorPoint::correct(const Vector& z) {
  const double noise = kExplained * trial_.rounding;
  Index count = 0;
  for (const Index i : open_) {
    Side& side = side_[at(i)];
    const double w = trial_.w[i];
    const Side next = side == Side::inside ? (scale_[i] * (lo_[i] - z[i]) > noise   ? Side::lower
                                              : scale_[i] * (z[i] - hi_[i]) > noise ? Side::upper
                                                                                    : side)
                      : (side == Side::lower ? w < -noise : w > noise) ? Side::inside
                                                                       : side;
    count += next != side;
    side = next;
  }
  return count;
}

bool InteriorPoint::cross(const Lcp& p, int iteration) {
  Vector& z = dz_;  // free between two directions
  z = z_;
  for (Index wrong = p.size() / 14 + 10;;) {  // more: not yet a guess
    inside_.clear();
    for (Index i = 0; i < p.size(); ++i)
      if (side_[at(i)] == Side::inside)
        inside_.push_back(i);
      else
        z[i] = side_[at(i)] == Side::lower ? lo_[i] : hi_[i];
    for (const double most : {1e-8, 1e-11, 1e-14}) {
      if (!solve_inside(p, &p.b, most, z)) return false;
      if (keep(p, z)) return log(iteration, trial_.residual, 0, "crossover"), true;
      if (inside_error_ <= kExplained * trial_.rounding) break;  // else A_FF has eigenvalues as small as D
    }
    const Index count = correct(z);
    log(iteration, static_cast<double>(count), 0, "rows change sides");
    if (count == 0 || 10 * count > 7 * wrong || budget().exhausted()) return false;
    wrong = count;
    z = trial_.z;
  }
}

/// Rows given their sides by what the last predictor does: ds/s + dl/l = −1, and the one that vanishes is near −1.
void InteriorPoint::guess_sides() {
  std::fill(side_.begin(), side_.end(), Side::lower);  // rows with lo = hi
  for (const Index i : open_) side_[at(i)] = Side::inside;
  for (Index k = 0; k < s_.size(); ++k)
    if (lean_[k] < -0.5) side_[at(bounds_[at(k)].row)] = bounds_[at(k)].sign > 0 ? Side::lower : Side::upper;
  barrier();
}

/// Iterates that run away do so along a u with u ≥ 0, A u = −Aᵀu ≥ 0, uᵀA u = 0, bᵀu < 0 (for [0, ∞) rows): on the rows
/// that do, A u = 0, which is solved for from z.
bool InteriorPoint::prove(const Lcp& p, Vector& u) {
  D_.setZero();
  const double size = z_.lpNorm<Eigen::Infinity>();
  u.resize(p.size());
  for (const double share : {1e-6, 1e-3}) {
    inside_.clear();
    for (Index i = 0; i < p.size(); ++i) {
      const bool box = lo_[i] > -kInf && hi_[i] < kInf, runs = !box && std::abs(z_[i]) > share * size;
      u[i] = runs ? z_[i] : 0;
      if (runs) inside_.push_back(i), D_[i] = scale_[i];
    }
    if (!solve_inside(p, nullptr, 1e-8, u)) return false;
    tidy_certificate(p, u);
    if (judge_.proves_infeasible(p, u)) return true;
  }
  return false;
}

Claim InteriorPoint::iterate(const Lcp& p, Solution& s, double farther) {
  if (!start(p, farther)) return Claim::numerical_error;
  const int patience = farther < kStarts.back() ? 8 : 20;
  const double unit = std::max(z_.lpNorm<Eigen::Infinity>(), s_.size() > 0 ? s_.lpNorm<Eigen::Infinity>() : 0.0);
  // Crossover is worth its factorizations once the guess stands still, and then again when it moved less or μ fell.
  Index changed = s_.size(), few = changed / 200;
  double tried = 1e-5, least = kInf, far = 1e3 * unit;
  int stuck = 0;
  for (; s.iterations < options_.max_iterations; ++s.iterations) {
    residuals(p);
    stuck = error_ < 0.9 * least ? 0 : stuck + 1;
    least = std::min(least, error_);
    const double size = z_.lpNorm<Eigen::Infinity>();
    const bool last = error_ <= 1e-14 || bounds_.empty() || stuck > patience || size > 1e12 * unit;
    if (!options_.crossover) {
      if (keep(p, z_)) return Claim::candidate;
    } else if (last || error_ <= tried || (error_ <= 1e-3 && changed <= few)) {
      tried = 0.1 * error_;
      few = changed > 0 ? changed / 4 : -1;
      guess_sides();
      if (cross(p, s.iterations)) return Claim::candidate;
    }
    if (size > far || last) {
      far = 100 * size;
      if (prove(p, ray_)) return s.ray = ray_, Claim::ray;
    }
    if (last) {
      keep(p, z_);
      break;
    }
    if (budget().exhausted()) return Claim::time_limit;
    if (!factorize()) break;
    target_ = -s_.cwiseProduct(l_);
    direction();
    const double to_boundary = std::min(1.0, step_length());
    const double mu_there = (s_ + to_boundary * ds_).dot(l_ + to_boundary * dl_) / static_cast<double>(s_.size());
    const double centering = std::pow(std::max(mu_there, 0.0) / mu_, 3);
    changed = 0;
    for (Index k = 0; k < s_.size(); ++k) {
      const double lean = ds_[k] / s_[k];
      changed += (lean < -0.5) != (lean_[k] < -0.5);
      lean_[k] = lean;
    }
    second_ = ds_.cwiseProduct(dl_);
    double step = 0;
    // Where the full correction allows no long step: a smaller one (Colombo & Gondzio), then centring only.
    const double weight[] = {1, to_boundary * to_boundary, 0}, target[] = {centering, std::max(centering, 0.1), 0.8};
    for (int attempt = 0; attempt < 3 && step < 0.3; ++attempt) {
      target_ = (target[attempt] * mu_ - s_.array() * l_.array() - weight[attempt] * second_.array()).matrix();
      direction();
      step = std::min(1.0, 0.995 * step_length());
    }
    log(s.iterations, error_, step);
    z_ += step * dz_, s_ += step * ds_, l_ += step * dl_;
    if (!z_.allFinite() || !l_.allFinite()) return Claim::numerical_error;
  }
  if (z_.lpNorm<Eigen::Infinity>() > 1e3 * unit) return Claim::ray;
  return s.iterations < options_.max_iterations ? Claim::candidate : Claim::iteration_limit;
}

/// Where few of W's rows meet, a Delassus operator as rows; where the entries of A span many powers of ten, the problem
/// in other units.
const Lcp& InteriorPoint::prepared(const Lcp& given) {
  scaling_.clear();
  const Lcp* from = &given;
  if (const auto* delassus = std::get_if<Delassus>(&given.A)) {
    Vector& meetings = scratch_;  // of each coordinate
    meetings.resize(delassus->W.cols);
    meetings.setZero();
    for (const int column : delassus->W.column) meetings[column] += 1;
    const auto n = static_cast<double>(given.size());
    if (n < 64 || meetings.squaredNorm() > n * n / 16) return given;
    scaled_ = given;
    scaled_.A = RowSparse::from(formed(given.A).value);
    from = &scaled_;
  }
  const Lcp& p = *from;
  if (const auto* sparse = std::get_if<RowSparse>(&p.A))
    scaling_.fit(*sparse);
  else
    scaling_.fit(std::get<DenseMatrix>(p.A));
  if (scaling_.trivial()) return p;
  auto &row = scaling_.row, &col = scaling_.col;
  int low = 5000, high = -5000;
  for (Index i = 0; i < p.size(); ++i) {
    const int turn = std::ilogb(row[i]) - std::ilogb(col[i]);
    low = std::min(low, turn), high = std::max(high, turn);
  }
  if (high - low <= 24)  // not clearly a D₁ M D₂: only D M D surely keeps it monotone
    for (Index i = 0; i < p.size(); ++i)
      row[i] = col[i] = std::ldexp(1.0, (std::ilogb(row[i]) + std::ilogb(col[i])) / 2);
  scaling_.apply(p, scaled_);
  return scaled_;
}

Claim InteriorPoint::run(const Lcp& problem, Solution& s, Start start) {
  if (problem.size() == 0) return Claim::candidate;
  const Lcp& p = prepared(problem);
  if (!scaling_.trivial()) s.z.array() /= scaling_.col.array();
  const Claim claim = method(p, s, start);
  s.z = best_.z;
  if (scaling_.trivial()) return claim;
  s.z.array() *= scaling_.col.array();
  if (s.ray.size() > 0) s.ray.array() *= scaling_.row.array();
  return claim;
}

Claim InteriorPoint::method(const Lcp& p, Solution& s, Start start) {
  load(p);
  best_.residual = kInf;
  best_.z = s.z;
  if (keep(p, s.z)) return Claim::candidate;
  if (start == Start::warm && options_.crossover) {
    z_ = trial_.z, w_ = trial_.w;
    D_ = scale_;
    for (Index i = 0; i < p.size(); ++i) {
      const double moved = z_[i] - w_[i] / scale_[i];
      side_[at(i)] = lo_[i] == hi_[i] || moved <= lo_[i] ? Side::lower : moved >= hi_[i] ? Side::upper : Side::inside;
    }
    if (cross(p, 0)) return Claim::candidate;
  }
  Claim claim = Claim::stalled;
  for (const double farther : kStarts) {
    if (farther > 1) log(s.iterations, best_.residual, 0, "farther start");
    claim = iterate(p, s, farther);
    if (budget().exhausted() || s.ray.size() > 0 || s.iterations >= options_.max_iterations) break;
    judge_.certify(p, options_.tolerance, Claim::candidate, best_);
    if (has_answer(best_.status) && !judge_.coarse()) break;
  }
  return claim;
}

}  // namespace orthant
