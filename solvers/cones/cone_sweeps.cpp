#include <orthant/solvers/cones/cone_sweeps.h>
#include <orthant/solvers/cones/contact_solve.h>

#include <array>
#include <cmath>

namespace orthant {

void ConeSweeps::load(const ConeForm& form) {
  form_ = &form;
  own_.clear(), place_.clear();
  const RowSparse& A = form.A;
  for (int c = 0; c < form.blocks(); ++c) {
    const int m = form.block(c).rows, first = form.begin(c);
    place_.push_back(static_cast<int>(own_.size()));
    own_.resize(own_.size() + at(m * m), 0.0);
    double* const own = own_.data() + place_.back();
    for (int r = 0; r < m; ++r)
      for (std::size_t k = at(A.start[at(first + r)]); k < at(A.start[at(first + r) + 1]); ++k)
        if (A.column[k] >= first && A.column[k] < first + m) own[r + m * (A.column[k] - first)] = A.value[k];
  }
}

double ConeSweeps::sweep(Vector& z, double omega, bool backward) {
  const RowSparse& A = form_->A;
  std::array<double, cones::kMostRows> q{}, next{};
  double moved = 0;
  const int count = form_->blocks();
  for (int place = 0; place < count; ++place) {
    const int c = backward ? count - 1 - place : place;
    const cones::Block& b = form_->block(c);
    const int m = b.rows, first = b.start;
    const double* const own = own_.data() + place_[at(c)];
    for (int r = 0; r < m; ++r) {
      double sum = form_->q[first + r];
      for (std::size_t k = at(A.start[at(first + r)]); k < at(A.start[at(first + r) + 1]); ++k)
        sum += A.value[k] * z[A.column[k]];
      for (int s = 0; s < m; ++s) sum -= own[r + m * s] * z[first + s];
      q[at(r)] = sum;
      next[at(r)] = z[first + r];
    }
    solve_contact(form_->all(), b, own, q.data(), next.data());
    for (int r = 0; r < m; ++r) {
      const double change = omega * (next[at(r)] - z[first + r]);
      z[first + r] += change;
      moved += change * change;
    }
  }
  return std::sqrt(moved);
}

}  // namespace orthant
