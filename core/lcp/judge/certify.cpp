#include <orthant/core/lcp/judge/certify.h>
#include <orthant/core/lcp/judge/certify_cones.h>
#include <orthant/core/lcp/judge/certify_sums.h>

#include <algorithm>
#include <cmath>

namespace orthant {
namespace {

using detail::kCoarsest, detail::kEpsilon, detail::kRoundings;
constexpr double kTelling = 1e-11;  // 20 ρ relative to β below which an operator's sums need no second look

double nearest_to_zero(double lo, double hi) { return lo > 0 ? lo : hi < 0 ? hi : 0; }

}  // namespace

/// Room for problems of that size, needed now or not: a later z must find it there.
void Judge::prepare(const Lcp& problem) {
  const Index n = problem.size();
  const auto* delassus = std::get_if<Delassus>(&problem.A);
  if (delassus != nullptr && at(delassus->W.cols) > inner_ld_.capacity())
    for (auto* each : {&inner_ld_, &inner_abs_ld_}) each->reserve(at(delassus->W.cols));
  if (const auto* rows = std::get_if<RowSparse>(&problem.A))
    ways_.reserve(rows->value.size() + problem.friction.size());
  if (at(n) <= rows_.size()) return;
  for (Vector* each : {&d_, &lo_, &hi_, &beta_, &reach_}) each->resize(n);
  for (auto* each : {&g_, &g_abs_, &g_error_}) each->reserve(at(n));
  rows_.resize(at(n));
  heap_.reserve(at(2 * n + 1));
}

void Judge::evaluate(const Lcp& problem, Solution& s, bool extended) {
  const Index n = problem.size();
  prepare(problem);
  detail::sum_rows(problem.A, problem.b, s.z, s.w, abs_, inner_, inner_abs_);
  if (extended) {
    product(problem.A, s.z, false);
    for (Index i = 0; i < n; ++i) s.w[i] = static_cast<double>(problem.b[i] + g_[at(i)]);
  }

  const double* lo = problem.lo.data();
  const double* hi = problem.hi.data();
  if (!problem.friction.empty()) {
    lo_.resize(n), hi_.resize(n);
    for (Index i = 0; i < n; ++i) lo_[i] = lo[i], hi_[i] = hi[i];
    for (const Friction& f : problem.friction) {
      hi_[f.first] = f.mu * std::max(s.z[f.normal], 0.0);
      lo_[f.first] = -hi_[f.first];
    }
    lo = lo_.data();
    hi = hi_.data();
  }

  double residual = 0, size = 0, scale = 0, least = kInf, checksum = 0;
  bool bounded = false, weighed = false;
  settled_ = true;
  for (Index i = 0; i < n; ++i) {
    const double z = s.z[i], w = s.w[i];
    checksum += 0.0 * z + 0.0 * w;  // NaN when one of them is not finite
    size = std::max(size, abs_[i]);
    const double data = std::abs(problem.b[i]);
    scale = std::max(scale, data);
    if (data > 0) least = std::min(least, data);
    bounded = bounded || nearest_to_zero(problem.lo[i], problem.hi[i]) != 0 ||
              (z != 0 && detail::on_bound(z, problem.lo[i], problem.hi[i]));
    // d |z − clamp(z − w/d)| = max(d · how far z is out of its bounds, min(d · distance to the bound that w pushes
    // against, |w|)):
    // never by z − w/d, which is z where w/d is below its rounding, whatever w is.
    double r = std::abs(w), out = 0, beside = 0, held = 0;
    const double room = w >= 0 ? z - lo[i] : hi[i] - z;
    if (room == 0 && r > 0 && lo[i] <= z && z <= hi[i]) {  // on the bound that w holds it at: most are
      held = lo[i] < hi[i] ? r : kInf, r = 0;
    } else if (z < lo[i] || z > hi[i] || room < r) {
      // d matters only here, where z is off its bound by less than |w|: most verdicts never need the weights.
      if (room != 0 && !weighed) detail::largest_of_columns(problem.A, d_), weighed = true;
      const double d = room == 0 ? 1.0 : std::max(1.0, d_[i]);
      out = std::max({lo[i] - z, z - hi[i], 0.0});
      if (d * std::max(room, 0.0) < r) beside = std::max(room, 0.0), held = lo[i] < hi[i] ? r : kInf, r = d * beside;
      r = std::max(d * out, r);
    }
    residual = std::max(residual, r);
    Row& row = rows_[at(i)];
    row.residual = r, row.data = data, row.size = row.most = abs_[i];
    row.out = out, row.room = beside, row.held = held;
    settled_ = settled_ && r <= kRoundings * kEpsilon * abs_[i] && !(beside > 0);
  }
  if (bounded) {
    beta_.resize(n);
    for (Index i = 0; i < n; ++i) {
      const double z = s.z[i], lower = problem.lo[i], upper = problem.hi[i];
      beta_[i] = detail::on_bound(z, lower, upper) ? z : nearest_to_zero(lower, upper);
    }
    detail::sum_rows(problem.A, problem.b, beta_, lo_, abs_, inner_, inner_abs_);
    scale = 0, least = kInf;
    for (Index i = 0; i < n; ++i) {
      rows_[at(i)].data = abs_[i];
      scale = std::max(scale, abs_[i]);
      if (abs_[i] > 0) least = std::min(least, abs_[i]);
    }
  }
  if (const auto* delassus = std::get_if<Delassus>(&problem.A);
      extended && delassus != nullptr && to_rows(*delassus, entries_, detail::kFormed)) {
    // The factors bound Σ_j |A_ij z_j| from above, by far where they cancel: here the sum itself is the measure.
    size = 0;
    for (Index i = 0; i < n; ++i) {
      double sum = std::abs(problem.b[i]);
      for (std::size_t k = at(entries_.start[at(i)]); k < at(entries_.start[at(i) + 1]); ++k)
        sum += std::abs(entries_.value[k] * s.z[entries_.column[k]]);
      rows_[at(i)].size = rows_[at(i)].most = sum;
      size = std::max(size, sum);
    }
  }
  s.residual = checksum == 0.0 && residual < kInf ? residual : kInf;
  size_ = checksum == 0.0 ? size : kInf;
  s.rounding = kEpsilon * size_;
  scale_ = scale;
  least_scale_ = least;
}

double Judge::allowed(double tolerance, double rounding, double beta) {
  return std::max(tolerance * beta, std::min(kRoundings * rounding, kCoarsest * beta));
}

void Judge::certify(const Lcp& problem, double tolerance, Status claim, Solution& s) {
  if (s.z.size() != problem.size()) {  // a solver that gave up before it had a z
    s.z.resize(problem.size());
    s.z.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  if (problem.discs()) return certify_cones(problem, tolerance, claim, s);
  bool known = false;
  const auto passes = [&] {
    known = scale_ < kInf && size_ < kInf && size_ <= detail::runaway(scale_);
    accepted_ = allowed(tolerance, s.rounding, scale_);
    if (known && s.residual > accepted_ && s.residual < detail::kLeastNormal)
      accepted_ = std::max(accepted_, detail::lost_to_underflow(problem.A, d_));
    return known && s.residual <= accepted_ && rows_pass(problem, tolerance, s);
  };
  // Where rounding of the sums may be what decides, they are done with more digits: what stands in the way of a z, and
  // all of an operator's, whose factors may cancel far below their own size.
  evaluate(problem, s, false);
  const bool cancels = std::holds_alternative<Delassus>(problem.A) &&
                       !(kRoundings * s.rounding <= std::max(tolerance, kTelling) * scale_);
  bool accepted = !cancels && passes();
  if (cancels || (!accepted && known && s.residual <= kRoundings * s.rounding)) {
    evaluate(problem, s, true);
    accepted = passes();
  }
  const auto disproved = [&] {
    return claim == Status::ray && s.certificate.size() == problem.size() && proves_infeasible(problem, s.certificate);
  };
  if (accepted && !(doubtful(s) && disproved())) {
    s.status = Status::solved;
  } else if (accepted || disproved()) {
    s.status = Status::infeasible;
  } else if (claim == Status::solved || claim == Status::infeasible) {
    s.status = known ? Status::stalled : Status::numerical_error;
  } else {
    s.status = claim;
  }
}

// Discs: certify_cones.h has the rule.
void Judge::certify_cones(const Lcp& problem, double tolerance, Status claim, Solution& s) {
  ConeJudge judge;
  s.w.resize(problem.size());
  const bool accepted = judge.passes(problem, tolerance, s);
  scale_ = kInf;  // nothing is doubtful()
  accepted_ = accepted ? s.residual : 0;
  if (accepted)
    s.status = Status::solved;
  else if (claim == Status::ray && s.certificate.size() == problem.size() && proves_infeasible(problem, s.certificate))
    s.status = Status::infeasible;
  else if (claim == Status::solved || claim == Status::infeasible)
    s.status = judge.unknown() ? Status::numerical_error : Status::stalled;
  else
    s.status = claim;
}

}  // namespace orthant
