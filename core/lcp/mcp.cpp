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

void certify(const Mcp& p, double tolerance, Status claim, Solution& s) {
  constexpr double eps = std::numeric_limits<double>::epsilon();
  Matrix J;
  s.status = claim;
  s.residual = kInf;
  const bool known = s.z.allFinite() && evaluate(p, s.z, s.w) && evaluate(p, s.z, J);
  if (known) {
    Vector d, size;
    d.resize(p.size()), size.resize(p.size());
    d.setOnes();
    size = s.w.cwiseAbs();
    const auto count = [&](Index i, Index j, double value) {
      d[j] = std::max(d[j], std::abs(value));
      size[i] += std::abs(value * s.z[j]);
    };
    if (const auto* dense = std::get_if<DenseMatrix>(&J)) {
      for (Index j = 0; j < p.size(); ++j)
        for (Index i = 0; i < p.size(); ++i) count(i, j, (*dense)(i, j));
    } else {
      const auto view = std::get<RowSparse>(J).view();
      for (Index i = 0; i < p.size(); ++i)
        for (RowSparse::View::InnerIterator entry(view, i); entry; ++entry) count(i, entry.col(), entry.value());
    }
    s.residual = 0;
    bool fine = true;
    for (Index i = 0; i < p.size(); ++i) {
      const double off = d[i] * std::abs(s.z[i] - std::clamp(s.z[i] - s.w[i] / d[i], p.lo[i], p.hi[i]));
      const double rounding = eps * size[i];
      s.residual = std::max(s.residual, off);
      fine = fine && (off <= tolerance || (off <= 20 * rounding && rounding <= 1e-6));
    }
    s.rounding = p.size() > 0 ? eps * size.maxCoeff() : 0;
    if (fine) {
      s.status = Status::solved;
      return;
    }
  }
  if (claim == Status::solved) s.status = known && s.rounding <= 1e-6 ? Status::stalled : Status::numerical_error;
  if (claim == Status::infeasible) s.status = Status::stalled;
}

}  // namespace orthant
