#include <orthant/solvers/cones/cone_sweeps.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace orthant {
namespace {

/// q ← q + Σ columns: `rows` values a column, kRows of them where that is known.
template <int kRows>
void add_columns(const int* column, const int* end, const double* value, const double* z, int rows, double* q) {
  const int m = kRows > 0 ? kRows : rows;
  std::array<double, cones::kMostRows> sum{};
  for (int r = 0; r < m; ++r) sum[at(r)] = q[r];
  for (; column != end; ++column, value += m) {
    const double x = z[*column];
    for (int r = 0; r < m; ++r) sum[at(r)] += value[r] * x;
  }
  for (int r = 0; r < m; ++r) q[r] = sum[at(r)];
}

}  // namespace

void ConeSweeps::load(const ConeForm& form) {
  form_ = &form;
  const int count = form.blocks();
  own_.clear(), place_.clear(), contact_.resize(at(count));
  start_.assign(1, 0), column_.clear(), values_.clear(), value_.clear();
  next_.resize(at(form.all().most_rows()));
  column_.reserve(form.A.column.size()), value_.reserve(form.A.value.size());
  for (int c = 0; c < count; ++c) {
    place_.push_back(static_cast<int>(own_.size())), values_.push_back(value_.size());
    load_others(form.block(c));
    start_.push_back(static_cast<int>(column_.size()));
  }
  for (int c = 0; c < count; ++c) contact_[at(c)].prepare(form.all(), form.block(c), own_.data() + place_[at(c)]);
}

/// Own and other columns of a block's rows, merged.
void ConeSweeps::load_others(const cones::Block& b) {
  const RowSparse& A = form_->A;
  const int m = b.rows, first = b.start;
  const auto own = own_.size();
  own_.resize(own + at(m * m), 0.0);
  for (int r = 0; r < m; ++r) next_[at(r)] = at(A.start[at(first + r)]);
  constexpr int kNone = std::numeric_limits<int>::max();
  const auto column_of = [&](int r) {
    return next_[at(r)] < at(A.start[at(first + r) + 1]) ? A.column[next_[at(r)]] : kNone;
  };
  for (;;) {
    int column = kNone;
    for (int r = 0; r < m; ++r) column = std::min(column, column_of(r));
    if (column == kNone) return;
    double* to = nullptr;
    if (column >= first && column < first + m) {
      to = own_.data() + own + at(m * (column - first));
    } else {
      column_.push_back(column);
      value_.resize(value_.size() + at(m), 0.0);
      to = value_.data() + value_.size() - at(m);
    }
    for (int r = 0; r < m; ++r)
      if (column_of(r) == column) to[r] = A.value[next_[at(r)]++];
  }
}

/// q of one contact with the others held.
void ConeSweeps::find_data(int c, const Vector& z, double* q) const {
  const cones::Block& b = form_->block(c);
  for (int r = 0; r < b.rows; ++r) q[r] = form_->q[b.start + r];
  const int *const begin = column_.data() + start_[at(c)], *const end = column_.data() + start_[at(c) + 1];
  const double* const value = value_.data() + values_[at(c)];
  if (b.rows == 3)
    add_columns<3>(begin, end, value, z.data(), 3, q);
  else
    add_columns<0>(begin, end, value, z.data(), b.rows, q);
}

double ConeSweeps::sweep(Vector& z, double omega, bool backward) {
  std::array<double, cones::kMostRows> q{}, next{};
  double moved = 0;
  const int count = form_->blocks();
  for (int place = 0; place < count; ++place) {
    const int c = backward ? count - 1 - place : place;
    const cones::Block& b = form_->block(c);
    const int m = b.rows;
    double* const own = z.data() + b.start;
    find_data(c, z, q.data());
    std::copy_n(own, m, next.data());
    if (!contact_[at(c)].solve(q.data(), next.data()))
      solve_contact(form_->all(), b, own_.data() + place_[at(c)], q.data(), next.data());
    for (int r = 0; r < m; ++r) {
      const double change = omega * (next[at(r)] - own[r]);
      own[r] += change;
      moved += change * change;
    }
  }
  return std::sqrt(moved);
}

}  // namespace orthant
