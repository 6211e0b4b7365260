#include <orthant/core/lcp/judge/definite.h>

#include <cholmod.h>

#include <algorithm>
#include <cmath>

namespace orthant {

namespace {

constexpr double kRoundoff = std::numeric_limits<double>::epsilon();

using Sparse = Formed::Sparse;

Sparse empty(Index n) { return {n, n}; }

}  // namespace

Formed formed(const Matrix& A) {
  const auto* delassus = std::get_if<Delassus>(&A);
  if (delassus == nullptr) {
    RowSparse room;
    return {rows_of(A, room)->view(), empty(order(A))};
  }
  const auto& [W, inverse_mass, regularization] = *delassus;
  const Sparse w = W.view(), size = w.cwiseAbs();
  Formed result{w * inverse_mass.asDiagonal() * Sparse(w.transpose()),
                size * inverse_mass.asDiagonal() * Sparse(size.transpose())};
  if (regularization.size() != 0) {
    Sparse R(W.rows, W.rows);
    R.setIdentity();
    R.diagonal() = regularization;
    result.value += R;
    result.error += R;
  }
  result.error *= static_cast<double>(W.cols + 4) * kRoundoff;
  return result;
}

Formed symmetric_part(const Formed& A) {
  Formed S{0.5 * (A.value + Sparse(A.value.transpose())), 0.5 * (A.error + Sparse(A.error.transpose()))};
  S.error += kRoundoff * S.value.cwiseAbs();
  return S;
}

exact::Filtered entry(const Formed& A, Index i, Index j) {
  exact::Filtered f(A.value.coeff(i, j));
  f.error = A.error.coeff(i, j);
  return f;
}

Sparse comparison(const Formed& A) {
  Sparse C = A.value;
  for (Index j = 0; j < C.outerSize(); ++j)
    for (Sparse::InnerIterator it(C, j); it; ++it) it.valueRef() = (it.row() == j ? 1 : -1) * std::abs(it.value());
  return C;
}

std::vector<exact::Filtered> comparison_times(const Formed& A, const Eigen::VectorXd& v) {
  std::vector<exact::Filtered> sums(static_cast<std::size_t>(v.size()));
  for_each_entry(A, [&](Index i, Index j, exact::Filtered a) {
    a.value = (i == j ? 1 : -1) * std::abs(a.value);
    exact::add_product(sums[static_cast<std::size_t>(i)], a, exact::Filtered(v[j]));
  });
  return sums;
}

bool surely_m_matrix(const Formed& A, const Eigen::VectorXd& d) {
  if (!d.allFinite() || !(d.minCoeff() > 0)) return false;
  const auto sums = comparison_times(A, d);
  return std::all_of(sums.begin(), sums.end(), [](const auto& s) { return exact::sign(s) == exact::Sign::positive; });
}

bool surely_definite(const Formed& symmetric, double above) {
  const Index n = symmetric.value.rows();
  if (n == 0) return true;
  Vector diagonal(Eigen::VectorXd(symmetric.value.diagonal()));
  diagonal.array() -= above;
  if (!(diagonal.minCoeff() > 0) || !diagonal.allFinite()) return false;
  Vector scale = diagonal;
  for (double& d : scale) d = std::ldexp(1.0, -std::ilogb(d) / 2);
  Sparse S = scale.asDiagonal() * symmetric.value * scale.asDiagonal();
  S.diagonal().array() -= above * scale.array().square();  // one more rounding of the diagonal, in γ
  const Vector error(Eigen::VectorXd(scale.asDiagonal() * (symmetric.error * scale)));
  const double gamma = static_cast<double>(n + 4) * kRoundoff;
  const double trace = S.diagonal().sum() + above * scale.squaredNorm();
  const double shift = 1.01 * (gamma / (1 - gamma) * trace + error.maxCoeff()) + 0x1p-1000;
  if (!(shift < 1)) return false;

  cholmod_common common;
  cholmod_start(&common);
  common.print = 0;
  common.error_handler = nullptr;
  common.quick_return_if_not_posdef = 1;
  cholmod_sparse view{};
  view.nrow = view.ncol = static_cast<std::size_t>(n);
  view.nzmax = static_cast<std::size_t>(S.nonZeros());
  S.makeCompressed();
  view.p = S.outerIndexPtr();
  view.i = S.innerIndexPtr();
  view.x = S.valuePtr();
  view.stype = 1;  // the upper triangle is read
  view.itype = CHOLMOD_INT;
  view.xtype = CHOLMOD_REAL;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = view.packed = 1;
  cholmod_factor* factor = cholmod_analyze(&view, &common);
  bool definite = false;
  if (factor != nullptr) {
    common.final_ll = 1;
    double beta[2] = {-shift, 0};
    cholmod_factorize_p(&view, beta, nullptr, 0, factor, &common);
    definite = common.status == CHOLMOD_OK && factor->minor == static_cast<std::size_t>(n) && factor->is_ll != 0;
  }
  cholmod_free_factor(&factor, &common);
  cholmod_finish(&common);
  return definite;
}

}  // namespace orthant
