#include <orthant/core/lcp/judge/certify_sums.h>

#include <algorithm>

namespace orthant::detail {
namespace {

constexpr Index kFew = 8;  // rows

}  // namespace

void sum_rows(const Matrix& A, const Vector& b, const Vector& z, Vector& w, Vector& size, Vector& inner,
              Vector& inner_size) {
  const Index n = z.size();
  w.resize(n);
  size.resize(n);
  if (const auto* dense = std::get_if<DenseMatrix>(&A)) {
    double* const wi = w.data();
    double* const si = size.data();
    if (n <= kFew) {  // the same sums row by row: what few rows cost is else the loops around them
      for (Index i = 0; i < n; ++i) {
        double sum = b[i], sum_size = std::abs(b[i]);
        for (Index j = 0; j < n; ++j) {
          const double product = dense->data()[i + j * n] * z[j];
          sum += product;
          sum_size += std::abs(product);
        }
        wi[i] = sum, si[i] = sum_size;
      }
      return;
    }
    for (Index i = 0; i < n; ++i) wi[i] = b[i], si[i] = std::abs(b[i]);
    for (Index j = 0; j < n; ++j) {
      const double* const column = dense->data() + j * n;
      const double zj = z[j];
      for (Index i = 0; i < n; ++i) {  // zeros too: 0 · NaN must not pass unseen
        const double product = column[i] * zj;
        wi[i] += product;
        si[i] += std::abs(product);
      }
    }
    return;
  }
  const auto rows_times = [](const RowSparse& M, const Vector& x, const Vector& x_size, Index i, double& sum,
                             double& sum_size) {
    for (std::size_t k = at(M.start[at(i)]); k < at(M.start[at(i) + 1]); ++k) {
      sum += M.value[k] * x[M.column[k]];
      sum_size += std::abs(M.value[k]) * x_size[M.column[k]];
    }
  };
  if (const auto* sparse = std::get_if<RowSparse>(&A)) {
    inner_size.resize(n);
    inner_size = z.cwiseAbs();
    for (Index i = 0; i < n; ++i) {
      w[i] = b[i], size[i] = std::abs(b[i]);
      rows_times(*sparse, z, inner_size, i, w[i], size[i]);
    }
    return;
  }
  const auto& [W, inverse_mass, regularization] = std::get<Delassus>(A);
  inner.resize(W.cols);
  inner_size.resize(W.cols);
  inner.setZero();
  inner_size.setZero();
  for (Index i = 0; i < n; ++i)
    for (std::size_t k = at(W.start[at(i)]); k < at(W.start[at(i) + 1]); ++k) {
      const double product = W.value[k] * z[i];
      inner[W.column[k]] += product;
      inner_size[W.column[k]] += std::abs(product);
    }
  inner.array() *= inverse_mass.array();
  inner_size.array() *= inverse_mass.array();
  for (Index i = 0; i < n; ++i) {
    w[i] = b[i], size[i] = std::abs(b[i]);
    if (regularization.size() != 0) {
      w[i] += regularization[i] * z[i];
      size[i] += regularization[i] * std::abs(z[i]);
    }
    rows_times(W, inner, inner_size, i, w[i], size[i]);
  }
}

void largest_of_columns(const Matrix& A, Vector& d) {
  d.resize(order(A));
  d.setZero();
  if (!for_each_entry(A, [&d](Index, Index j, double value) { d[j] = std::max(d[j], std::abs(value)); })) {
    diagonal(A, d);
    d = (d * d.maxCoeff()).cwiseSqrt();
  }
}

}  // namespace orthant::detail
