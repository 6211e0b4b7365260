// solvers/pivoting/tableau_free_rows.h — free rows of Lemke's tableau: eliminated, or split where singular.
#pragma once

#include <orthant/solvers/pivoting/lemke_tableau.h>

namespace orthant::detail {

// Free rows: z_j enters against some w_i, both free, largest entry first. True when what is left, if anything, pairs
// up (w_i with z_i) and could be split, or when it was stopped; else the caller loads again and splits all.
template <class T> template <class Entries, class Stop>
bool Tableau<T>::eliminate(const Entries& M, const Vector& q, const Vector& row, const Vector& col, const Stop& stop) {
  T scale = 0;
  for (int i = 0; i < n_; ++i)
    for (int j = 0; j < n_; ++j)
      if (free_[u(i)] && free_[u(j)]) scale = std::max(scale, abs(row_at(i)[j + 2]));
  for (;;) {
    T best = scale * T(0x1p-30);  // smaller pivots are left to the split, which is valid for any
    int r = -1, s = -1;
    for (int i = 0; i < n_; ++i) {
      if (!free_[u(i)] || frozen_[u(i)]) continue;
      for (int c = 2; c < columns_; ++c)
        if (is_z(nonbasic_[u(c)]) && free_[u(nonbasic_[u(c)] - pairs_)] && abs(row_at(i)[c]) > best)
          best = abs(row_at(i)[c]), r = i, s = c;
    }
    if (r < 0) break;
    if (stop()) return stopped_ = true;
    pivot(r, s);
    frozen_[u(r)] = 1;
  }
  for (int i = 0; i < n_; ++i)
    if (free_[u(i)] && (place_[u(w_of(i))] < 0) != (place_[u(z_of(i))] > 0)) return false;
  for (int i = 0; i < n_; ++i)
    if (free_[u(i)] && !frozen_[u(i)]) {
      clean(i, M, q, row, col);
      split(i);
    }
  return true;
}

// Row i of a dependent free row is zero except for rounding, which a pivot would take for data: what lies below the
// roundings of the sums it came from, entry = M_ij + Σ_e k_e M_ej over the eliminated rows e, becomes 0.
template <class T> template <class Entries>
void Tableau<T>::clean(int i, const Entries& M, const Vector& q, const Vector& row, const Vector& col) {
  T* const line = row_at(i);
  for (int c = 0; c < columns_; ++c) {
    const int variable = nonbasic_[u(c)];
    if (c == covering_ || (c != 0 && !is_z(variable))) continue;
    const auto given = [&](int e) {
      const int j = c == 0 ? 0 : origin_[u(variable - pairs_)];
      return abs(c == 0 ? scaled(q[e], row[e], 1) : scaled(M(e, j), row[e], col[j]));
    };
    T size = given(i);
    for (int e = 0; e < n_; ++e)
      if (free_[u(e)] && place_[u(w_of(e))] > 0) size += abs(line[place_[u(w_of(e))]]) * given(e);
    if (abs(line[c]) <= T(n_) * Roundings<T>::snap * size) line[c] = 0;
  }
}

// Row i and the column of z_i get a twin with the sign turned: z_i = z⁺ − z⁻, w_i ≥ 0 and −w_i ≥ 0.
template <class T> void Tableau<T>::split(int i) {
  const int pair = split_end_++, s = place_[u(z_of(i))], r = rows_++, column = columns_++;
  T* const line = row_at(i);
  T* const twin = row_at(r);
  for (int k = 0; k < r; ++k) row_at(k)[column] = -row_at(k)[s];
  for (int c = 0; c < columns_; ++c) twin[c] = -line[c];
  line[covering_] = twin[covering_] = cover_of(i);
  set_basic(r, w_of(pair));
  set_nonbasic(column, z_of(pair));
  origin_[u(pair)] = i;
  given_[u(pair)] = given_[u(i)];
  error_[u(r)] = error_[u(i)];
  frozen_[u(r)] = 0;
  paired_[u(i)] = paired_[u(pair)] = 1;
}

}  // namespace orthant::detail
