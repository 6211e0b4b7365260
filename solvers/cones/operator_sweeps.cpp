#include <orthant/core/support/kept_memory.h>
#include <orthant/solvers/cones/operator_sweeps.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace orthant {

/// Three rows of W with entries in the same columns.
struct OperatorSweeps::Lines {
  Lines(const RowSparse& W, std::span<const int> rows)
      : count(W.start[at(rows[0]) + 1] - W.start[at(rows[0])]),
        column(W.column.data() + W.start[at(rows[0])]),
        first(W.value.data() + W.start[at(rows[0])]),
        second(W.value.data() + W.start[at(rows[1])]),
        third(W.value.data() + W.start[at(rows[2])]) {}
  int count;
  const int* column;
  const double *first, *second, *third;
};

void OperatorSweeps::load(const ConeForm& form, ThreadTeam* team) {
  form_ = &form, team_ = team != nullptr ? team : &alone_;
  domains_.load(form);
  const int count = form.blocks();
  place_.resize(at(count)), alike_.resize(at(count));
  int size = 0;
  for (int c = 0; c < count; ++c) place_[at(c)] = size, size += form.block(c).rows * form.block(c).rows;
  own_.resize(at(size));
  team_->run(domains_.count(), [&](int domain) {
    for (const int c : domains_.contacts(domain)) find_own(c);
  });
  part_.resize(at(domains_.count()));
}

void OperatorSweeps::release() { free_memory(domains_, own_, part_, place_, alike_, state_); }

void OperatorSweeps::find_own(int c) {
  const auto& [W, inverse_mass, regularization] = form_->operand();
  const cones::Block& b = form_->block(c);
  const auto rows = form_->rows(c);
  double* const own = own_.data() + place_[at(c)];
  const auto columns = [&W = W](int row) {
    return std::span<const int>(W.column.data() + W.start[at(row)], W.column.data() + W.start[at(row) + 1]);
  };
  alike_[at(c)] = b.rows == 3 && std::ranges::equal(columns(rows[0]), columns(rows[1])) &&
                  std::ranges::equal(columns(rows[0]), columns(rows[2]));
  std::array<double, 9> sum{};
  if (alike_[at(c)]) {
    const Lines l(W, rows);
    for (int k = 0; k < l.count; ++k) {
      const double m = inverse_mass[l.column[k]], x = l.first[k] * m, y = l.second[k] * m;
      sum[0] += x * l.first[k], sum[1] += x * l.second[k], sum[2] += x * l.third[k];
      sum[4] += y * l.second[k], sum[5] += y * l.third[k], sum[8] += l.third[k] * m * l.third[k];
    }
    sum[3] = sum[1], sum[6] = sum[2], sum[7] = sum[5];
  }
  for (int r = 0; r < b.rows; ++r)
    for (int s = 0; s < b.rows; ++s) {
      const int row = rows[at(r)], other = rows[at(s)];
      double value = 0;
      if (!alike_[at(c)])
        value = entry(form_->operand(), row, other);
      else
        value = sum[at(r + 3 * s)] + (r == s && regularization.size() != 0 ? regularization[row] : 0.0);
      own[r + b.rows * s] = form_->scale_of(row) * value * form_->scale_of(other);
    }
}

/// work(domain), colour by colour.
template <class Work> void OperatorSweeps::each_domain(bool backward, const Work& work) {
  for (int k = 0; k < domains_.colours(); ++k) {
    const auto domains = domains_.domains(backward ? domains_.colours() - 1 - k : k);
    team_->run(static_cast<int>(domains.size()), [&](int i) { work(domains[at(i)]); });
  }
}

void OperatorSweeps::start(const Vector& z) {
  since_fresh_ = 0;
  state_.resize(form_->operand().W.cols);
  state_.setZero();
  each_domain(false, [&](int domain) {
    for (const int c : domains_.contacts(domain)) push(c, z.data() + form_->begin(c));
  });
}

/// w' of one contact.
void OperatorSweeps::rates(int c, const double* z, double* w) const {
  const auto& [W, inverse_mass, regularization] = form_->operand();
  const auto rows = form_->rows(c);
  const double* const q = form_->q.data() + form_->begin(c);
  if (alike_[at(c)]) {
    const Lines l(W, rows);
    double x = 0, y = 0, t = 0;
    for (int k = 0; k < l.count; ++k) {
      const double u = state_[l.column[k]];
      x += l.first[k] * u, y += l.second[k] * u, t += l.third[k] * u;
    }
    w[0] = x, w[1] = y, w[2] = t;
  } else {
    for (std::size_t r = 0; r < rows.size(); ++r) {
      w[r] = 0;
      W.for_each_in_row(rows[r], [&](Index k, double value) { w[r] += value * state_[k]; });
    }
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double d = form_->scale_of(rows[r]);
    if (regularization.size() != 0) w[r] += regularization[rows[r]] * d * z[r];
    w[r] = d * w[r] + q[r];
  }
}

/// u for a change of z' of one contact.
void OperatorSweeps::push(int c, const double* change) {
  const auto& [W, inverse_mass, regularization] = form_->operand();
  const auto rows = form_->rows(c);
  if (alike_[at(c)]) {
    const Lines l(W, rows);
    const double x = change[0] * form_->scale_of(rows[0]), y = change[1] * form_->scale_of(rows[1]),
                 t = change[2] * form_->scale_of(rows[2]);
    for (int k = 0; k < l.count; ++k)
      state_[l.column[k]] += inverse_mass[l.column[k]] * (l.first[k] * x + l.second[k] * y + l.third[k] * t);
    return;
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const double x = change[r] * form_->scale_of(rows[r]);
    W.for_each_in_row(rows[r], [&, &m = inverse_mass](Index k, double value) { state_[k] += m[k] * value * x; });
  }
}

/// Returns ‖z_new − z_old‖² of the contact.
double OperatorSweeps::solve_block(int c, Vector& z, double omega) {
  const cones::Block& b = form_->block(c);
  const int m = b.rows;
  std::array<double, cones::kMostRows> q{}, next{};
  double* const mine = z.data() + b.start;
  const double* const own = own_.data() + place_[at(c)];
  rates(c, mine, q.data());
  for (int s = 0; s < m; ++s)
    for (int r = 0; r < m; ++r) q[at(r)] -= own[r + m * s] * mine[s];
  std::copy_n(mine, m, next.data());
  if (!DiscContact::solve_once(form_->all(), b, own, q.data(), next.data()))
    solve_contact(form_->all(), b, own, q.data(), next.data());
  double moved = 0;
  for (int r = 0; r < m; ++r) {
    const double change = omega * (next[at(r)] - mine[r]);
    mine[r] += change, next[at(r)] = change;
    moved += change * change;
  }
  if (moved != 0) push(c, next.data());
  return moved;
}

double OperatorSweeps::sweep_domain(int domain, Vector& z, double omega, bool backward) {
  const auto contacts = domains_.contacts(domain);
  double moved = 0;
  if (backward)
    for (std::size_t k = contacts.size(); k-- > 0;) moved += solve_block(contacts[k], z, omega);
  else
    for (const int c : contacts) moved += solve_block(c, z, omega);
  return moved;
}

double OperatorSweeps::sweep(Vector& z, double omega, bool backward) {
  if (++since_fresh_ > kFresh) start(z);
  each_domain(backward, [&](int domain) { part_[at(domain)] = sweep_domain(domain, z, omega, backward); });
  double moved = 0;
  for (const double part : part_) moved += part;
  return std::sqrt(moved);
}

double OperatorSweeps::residual(const Vector& z) const {
  team_->run(domains_.count(), [&](int domain) {
    double sum = 0;
    std::array<double, cones::kMostRows> w{};
    for (const int c : domains_.contacts(domain)) {
      rates(c, z.data() + form_->begin(c), w.data());
      const double e = form_->all().residual(form_->block(c), z.data() + form_->begin(c), w.data());
      sum += e * e;
    }
    part_[at(domain)] = sum;
  });
  double sum = 0;
  for (const double part : part_) sum += part;
  return sum == 0 ? 0 : std::sqrt(sum) / form_->norm_q;
}

}  // namespace orthant
