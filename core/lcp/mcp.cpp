#include <orthant/core/lcp/matrix.h>
#include <orthant/core/lcp/mcp.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace orthant {

void check(const Mcp& p) {
  if (p.hi.size() != p.lo.size())
    throw std::invalid_argument("Mcp: hi has " + std::to_string(p.hi.size()) + " entries: must be " +
                                std::to_string(p.lo.size()) + ", as lo");
  for (Index i = 0; i < p.size(); ++i)
    if (!(p.lo[i] <= p.hi[i]) || p.lo[i] == kInf || p.hi[i] == -kInf)
      throw std::invalid_argument("row " + std::to_string(i) + " has bounds [" + std::to_string(p.lo[i]) + ", " +
                                  std::to_string(p.hi[i]) + "]: must be lower <= upper, with a number between them");
  if (!p.F) throw std::invalid_argument("Mcp: F is empty: must be a function");
  if (!p.jacobian) throw std::invalid_argument("Mcp: jacobian is empty: must be a function");
}

bool evaluate(const Mcp& p, const Vector& z, Vector& F) {
  F.resize(p.size());
  p.F(z, F);
  if (F.size() != p.size())
    throw std::invalid_argument("Mcp: F gave " + std::to_string(F.size()) + " entries: must be " +
                                std::to_string(p.size()));
  return F.allFinite();
}

bool evaluate(const Mcp& p, const Vector& z, Matrix& J) {
  p.jacobian(z, J);
  const auto* dense = std::get_if<DenseMatrix>(&J);
  const auto* sparse = std::get_if<RowSparse>(&J);
  if (dense == nullptr && sparse == nullptr)
    throw std::invalid_argument("Mcp: jacobian gave a Delassus operator: must be dense or RowSparse");
  const Index rows = dense != nullptr ? dense->rows() : sparse->rows,
              cols = dense != nullptr ? dense->cols() : sparse->cols;
  if (rows != p.size() || cols != p.size())
    throw std::invalid_argument("Mcp: jacobian gave " + std::to_string(rows) + " x " + std::to_string(cols) +
                                ": must be " + std::to_string(p.size()) + " x " + std::to_string(p.size()));
  if (dense != nullptr) return dense->allFinite();
  check(J);
  return std::all_of(sparse->value.begin(), sparse->value.end(), [](double v) { return std::isfinite(v); });
}

namespace {

/// The row in which F's change along z differs most from the Jacobian's, over the terms |J_ij z_j|; none where it fits,
/// or where F is small enough beside its own change.
/// Two steps by 2⁻¹³ z with signs that differ from column to column: terms that cancel in one do not in the other.
Miss misfit(const Mcp& p, const Matrix& J, const Vector& z, const Vector& F, double tolerance) {
  constexpr double kStep = 0x1p-13, kShare = 0.5;
  Vector step(Eigen::VectorXd::Zero(p.size())), terms(step), change, moved, at, scratch;
  for_each_entry(J, [&](Index i, Index j, double value) { terms[i] += std::abs(value * z[j]); });
  Miss worst;
  double share = kShare;
  for (const unsigned pattern : {0x9E3779B9U, 0x7F4A7C15U}) {
    for (Index j = 0; j < p.size(); ++j) {
      const bool down = (static_cast<unsigned>(j + 1) * pattern >> 16 & 1U) != 0;
      const auto within = [&](double d) { return p.lo[j] <= z[j] + d && z[j] + d <= p.hi[j]; };
      const double d = (down ? -kStep : kStep) * z[j];
      step[j] = within(d) ? d : within(-d) ? -d : 0;
    }
    at = z + step;
    if (!evaluate(p, at, moved)) continue;
    multiply(J, step, change, scratch);
    for (Index i = 0; i < p.size(); ++i) {
      const double off = std::abs(moved[i] - F[i] - change[i]), all = kStep * terms[i];
      const double wrong = z[i] == p.lo[i] ? -F[i] : z[i] == p.hi[i] ? F[i] : std::abs(F[i]);
      if (!(off > share * all) || kStep * wrong <= tolerance * std::abs(moved[i] - F[i])) continue;
      share = off / all;
      worst = {
          .row = i, .against = Miss::Against::jacobian, .by = off / kStep, .allowed = terms[i], .tolerance = kShare};
    }
  }
  return worst;
}

constexpr double kVanished = 1e-290, kVanishing = 1e-280;

/// Where F_i falls below kVanished on the way from r, where it does not, to z; `value`: F_i at the last point before.
Vector vanishing_place(const Mcp& p, Index i, Vector r, Vector z, double& value) {
  constexpr int kHalvings = 1200;  // more than doubles have exponents: to the next double
  Vector between, F;
  for (int k = 0; k < kHalvings && std::abs(value) >= kVanishing; ++k) {
    between = 0.5 * r + 0.5 * z;
    if (between == r || between == z || !evaluate(p, between, F)) break;
    if (std::abs(F[i]) > kVanished)
      r = between, value = F[i];
    else
      z = between;
  }
  return r;
}

/// The first row that passes only since F and J underflow at z (mcp.h).
Miss underflown(const Mcp& p, const Matrix& J, const Vector& z, const Vector& F, const Vector* start) {
  constexpr double kSame = 1e-10;
  constexpr int kExponents[] = {1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 512};
  constexpr int kPoints = static_cast<int>(std::size(kExponents));
  Vector size(F.cwiseAbs()), r, at;
  for_each_entry(J,
                 [&](Index i, Index j, double value) { size[i] += std::abs(value) * std::max(1.0, std::abs(z[j])); });
  if ((size.array() > kVanished).all()) return {};
  for (int k = start == nullptr ? -1 : -2; k < kPoints; ++k) {  // the start, the origin, 2⁻ᵏ z
    r = k == -2 ? *start : Vector(z * (k == -1 ? 0 : std::ldexp(1.0, -kExponents[k])));
    r = r.cwiseMax(p.lo).cwiseMin(p.hi);
    if (!evaluate(p, r, at)) continue;
    for (Index i = 0; i < p.size(); ++i) {
      double value = at[i];
      if (size[i] > kVanished || std::abs(value) <= kVanished) continue;
      const Vector place = vanishing_place(p, i, r, z, value);
      const double wrong = z[i] == p.lo[i] ? -value : z[i] == p.hi[i] ? value : std::abs(value);
      const double near = kSame * std::max(z.lpNorm<Eigen::Infinity>(), r.lpNorm<Eigen::Infinity>());
      if (wrong > 0 && wrong < kVanishing && (place - z).lpNorm<Eigen::Infinity>() > near)
        return {.row = i, .against = Miss::Against::underflow, .by = std::abs(value), .allowed = 0, .tolerance = 0};
    }
  }
  return {};
}

}  // namespace

void certify(const Mcp& p, double tolerance, Claim claim, Solution& s, const Vector* start) {
  Lcp linear{.A = DenseMatrix(), .b = {}, .lo = p.lo, .hi = p.hi, .friction = {}};
  s.residual = kInf, s.rounding = 0, s.miss = {};
  if (!s.z.allFinite() || !evaluate(p, s.z, s.w) || !evaluate(p, s.z, linear.A)) {
    s.status = claim == Claim::candidate ? Status::numerical_error : status_of(claim);
    return;
  }
  const Vector F = s.w;
  linear.b.resize(p.size());
  Vector scratch;
  multiply(linear.A, s.z, linear.b, scratch);
  linear.b = F - linear.b;
  Judge judge;
  judge.certify(linear, tolerance, claim == Claim::exhausted ? Claim::stalled : claim, s);
  if (judge.coarse()) s.status = claim == Claim::candidate ? Status::stalled : status_of(claim);
  if (!has_answer(s.status) && s.status != Status::infeasible) judge.explain(linear, tolerance, s);
  s.w = F;
  if (!has_answer(s.status)) return;
  Miss miss = misfit(p, linear.A, s.z, F, tolerance);
  if (miss.row < 0) miss = underflown(p, linear.A, s.z, F, start);
  if (miss.row >= 0) {
    s.status = claim == Claim::candidate ? Status::stalled : status_of(claim);
    s.miss = miss;
  }
}

}  // namespace orthant
