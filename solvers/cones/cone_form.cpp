#include <orthant/solvers/cones/cone_form.h>

#include <algorithm>
#include <cmath>

namespace orthant {

/// Blocks, their rows and units.
void ConeForm::order(const Lcp& p) {
  all_.load(p);
  all_.scale(p.A, d_);
  all_.apply(d_);
}

void ConeForm::load_unformed(const Lcp& p) {
  order(p);
  operand_ = &std::get<Delassus>(p.A), source_ = nullptr;
  q.resize(p.size());
  for (Index i = 0; i < p.size(); ++i) q[i] = d_[all_.row(i)] * p.b[all_.row(i)];
  norm_q = q.norm();
}

bool ConeForm::load(const Lcp& p) {
  const Index n = p.size();
  order(p);
  operand_ = nullptr, source_ = std::get_if<Delassus>(&p.A);
  place_.resize(at(n)), of_.clear();
  bool in_order = true;
  for (int c = 0; c < all_.size(); ++c)
    for (const int row : all_.rows(all_[c])) {
      const auto i = static_cast<int>(of_.size());
      in_order = in_order && row == i;
      place_[at(row)] = i;
      of_.push_back(c);
    }
  const RowSparse* const rows = rows_of(p.A, formed_, kFormed);
  if (rows == nullptr) return false;
  A.rows = A.cols = n;
  A.start.assign(1, 0), A.column.clear(), A.value.clear();
  A.column.reserve(rows->column.size()), A.value.reserve(rows->value.size());
  q.resize(n), diagonal.resize(n);
  for (Index i = 0; i < n; ++i) {
    const Index row = all_.row(i);
    const double d = d_[row];
    line_.clear();
    rows->for_each_in_row(row, [&](Index j, double value) { line_.emplace_back(place_[at(j)], d * value * d_[j]); });
    if (!in_order)
      std::sort(line_.begin(), line_.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    diagonal[i] = 0;
    for (const auto& [column, value] : line_) {
      A.column.push_back(column), A.value.push_back(value);
      if (column == static_cast<int>(i)) diagonal[i] = value;
    }
    A.start.push_back(static_cast<int>(A.value.size()));
    q[i] = d * p.b[row];
  }
  norm_q = q.norm();
  return true;
}

double ConeForm::residual(const Vector& z, const Vector& w) const {
  double sum = 0;
  for (int c = 0; c < blocks(); ++c) {
    const double e = all_.residual(all_[c], z.data() + begin(c), w.data() + begin(c));
    sum += e * e;
  }
  return sum == 0 ? 0 : std::sqrt(sum) / norm_q;
}

void ConeForm::apply(const Vector& z, Vector& w) const {
  w.resize(size());
  if (operand_ != nullptr) {
    from_scaled(z, unscaled_);
    const auto& [W, inverse_mass, regularization] = *operand_;
    inner_.resize(W.cols);
    inner_.noalias() = W.view().transpose() * unscaled_;
    inner_.array() *= inverse_mass.array();
    product_.resize(size());
    product_.noalias() = W.view() * inner_;
    if (regularization.size() != 0) product_.array() += regularization.array() * unscaled_.array();
    for (Index i = 0; i < size(); ++i) w[i] = d_[all_.row(i)] * product_[all_.row(i)] + q[i];
    return;
  }
  w.noalias() = A.view() * z;
  w += q;
}

void ConeForm::to_scaled(const Vector& z, Vector& scaled) const {
  scaled.resize(size());
  for (Index i = 0; i < size(); ++i) scaled[i] = z[all_.row(i)] / d_[all_.row(i)];
}

void ConeForm::from_scaled(const Vector& scaled, Vector& z) const {
  z.resize(size());
  for (Index i = 0; i < size(); ++i) z[all_.row(i)] = scaled[i] * d_[all_.row(i)];
}

}  // namespace orthant
