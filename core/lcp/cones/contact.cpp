#include <orthant/core/lcp/cones/contact.h>
#include <orthant/core/support/kept_memory.h>

#include <algorithm>
#include <cmath>

namespace orthant::cones {
namespace {

double slip_length(const double* t, int rows) {
  if (rows == 1) return std::abs(t[0]);
  const double square = t[0] * t[0] + t[1] * t[1];
  return square > 1e-280 && square < 1e280 ? std::sqrt(square) : std::hypot(t[0], t[1]);  // a fifth of the time
}

}  // namespace

void Blocks::load(const Lcp& p) {
  const Index n = p.size();
  head_.assign(at(n) + 1, 0), entry_.resize(p.friction.size());  // friction entries by normal
  taken_.assign(at(n), 0);
  for (const Friction& f : p.friction) {
    ++head_[at(f.normal) + 1];
    for (Index r = 0; r < f.rows; ++r) taken_[at(f.first + r)] = 1;
  }
  for (std::size_t i = 1; i < head_.size(); ++i) head_[i] += head_[i - 1];
  place_.assign(head_.begin(), head_.end() - 1);
  for (std::size_t k = 0; k < p.friction.size(); ++k)
    entry_[at(place_[at(p.friction[k].normal)]++)] = static_cast<int>(k);
  blocks_.clear(), parts_.clear(), row_.clear();
  row_.reserve(at(n)), parts_.reserve(p.friction.size());
  blocks_.reserve(at(std::ranges::count(taken_, 0)));
  most_rows_ = 0;
  for (Index i = 0; i < n; ++i) {
    if (taken_[at(i)]) continue;
    Block b{.start = static_cast<int>(row_.size()), .parts_start = static_cast<int>(parts_.size())};
    b.lo = p.lo[i], b.hi = p.hi[i];
    row_.push_back(static_cast<int>(i));
    for (int e = head_[at(i)]; e < head_[at(i) + 1]; ++e) {
      const Friction& f = p.friction[at(entry_[at(e)])];
      parts_.push_back({.place = b.rows, .rows = static_cast<int>(f.rows), .mu = f.mu});
      for (Index r = 0; r < f.rows; ++r) row_.push_back(static_cast<int>(f.first + r));
      b.rows += static_cast<int>(f.rows), ++b.parts;
    }
    most_rows_ = std::max(most_rows_, b.rows);
    blocks_.push_back(b);
  }
  if (n > kKeptRows) free_memory(head_, place_, entry_, taken_);
}

void Blocks::scale(const Matrix& A, Vector& d) const {
  diagonal(A, d);
  double largest = 0;
  for (const double a : d)
    if (a < kInf) largest = std::max(largest, std::abs(a));
  if (!(largest > 0)) largest = 1;
  for (const Block& b : blocks_) {
    const auto row = rows(b);
    const auto set = [&](int first, int count) {
      double sum = 0;
      for (int r = first; r < first + count; ++r) sum += std::abs(d[row[at(r)]]);  // signs must not cancel
      const double mean = sum / count;
      const double value = 1 / std::sqrt(mean > 0 && mean < kInf ? mean : largest);
      for (int r = first; r < first + count; ++r) d[row[at(r)]] = value;
    };
    const auto part = parts(b);
    set(0, 1 + (b.parts > 0 ? part[0].rows : 0));
    for (std::size_t j = 1; j < part.size(); ++j) set(part[j].place, part[j].rows);
  }
}

void Blocks::apply(const Vector& d) {
  for (Block& b : blocks_) {
    const auto row = rows(b);
    const double normal = d[row[0]];
    b.lo /= normal, b.hi /= normal;
    for (int j = 0; j < b.parts; ++j) {
      Part& part = parts_[at(b.parts_start + j)];
      part.mu *= normal / d[row[at(part.place)]];
    }
  }
}

/// a; whether it sits at lo or hi, and Σ_A μ_j² where it does not.
double Blocks::normal(const Block& b, const double* x, bool* clamped, double* squares) const {
  // φ'(a) = a − x_n − Σ_A μ_j (s_j − μ_j a) rises with a: parts join A from the largest s_j / μ_j downward.
  double sum = x[0], square = 0, a = sum;
  const auto part = parts(b);
  // Few parts: repeat until none joins. Each pass has at least one more in A, or ends.
  for (std::size_t pass = 0; pass <= part.size() + 1; ++pass) {
    double next_sum = x[0], next_square = 0;
    const double at_least = std::max(a, 0.0);
    for (const Part& p : part) {
      const double s = slip_length(x + p.place, p.rows);
      if (s > p.mu * at_least) next_sum += p.mu * s, next_square += p.mu * p.mu;
    }
    const double next = next_sum / (1 + next_square);
    if (pass > 0 && next_square == square) break;
    sum = next_sum, square = next_square, a = next;
  }
  const double bounded = std::clamp(a, b.lo, b.hi);
  if (clamped != nullptr) *clamped = a <= b.lo || a >= b.hi;
  if (squares != nullptr) *squares = square;
  return bounded;
}

void Blocks::project(const Block& b, const double* x, double* z) const {
  const double a = normal(b, x, nullptr, nullptr);
  z[0] = a;
  for (const Part& p : parts(b)) {
    const double s = slip_length(x + p.place, p.rows), radius = p.mu * std::max(a, 0.0);
    const double share = s <= radius ? 1.0 : radius / s;
    for (int r = p.place; r < p.place + p.rows; ++r) z[r] = share == 1.0 ? x[r] : x[r] * share;
  }
}

void Blocks::project(const Block& b, const double* x, double* z, double* D) const {
  bool clamped = false;
  double squares = 0;
  const double a = normal(b, x, &clamped, &squares), radius_of = std::max(a, 0.0);
  const auto part = parts(b);
  const int m = b.rows;
  std::fill(D, D + m * m, 0.0);
  if (!clamped) {
    D[0] = 1 / (1 + squares);
    for (const Part& p : part) {
      const double s = slip_length(x + p.place, p.rows);
      if (s > p.mu * radius_of)
        for (int r = p.place; r < p.place + p.rows; ++r) D[m * r] = p.mu * x[r] / s / (1 + squares);
    }
  }
  for (const Part& p : part) {
    const double s = slip_length(x + p.place, p.rows), radius = p.mu * radius_of;
    for (int r = p.place; r < p.place + p.rows; ++r) {
      if (s <= radius) {
        D[r + m * r] = 1;
        continue;
      }
      for (int c = 0; c < m; ++c) D[r + m * c] = p.mu * x[r] / s * D[m * c];  // t̂ d(μ a)
    }
    if (s > radius)
      for (int r = p.place; r < p.place + p.rows; ++r)
        for (int c = p.place; c < p.place + p.rows; ++c)
          D[r + m * c] += radius / s * ((r == c ? 1.0 : 0.0) - x[r] / s * (x[c] / s));
  }
  z[0] = a;
  for (const Part& p : part) {
    const double s = slip_length(x + p.place, p.rows), radius = p.mu * radius_of;
    const double share = s <= radius ? 1.0 : radius / s;
    for (int r = p.place; r < p.place + p.rows; ++r) z[r] = share == 1.0 ? x[r] : x[r] * share;
  }
}

void Blocks::correct(const Block& b, const double* w, double* corrected) const {
  double sum = w[0];
  for (const Part& p : parts(b)) sum += p.mu * slip_length(w + p.place, p.rows);
  std::copy(w + 1, w + b.rows, corrected + 1);
  corrected[0] = sum;
}

/// The same of a normal row [0, ∞) with one disc.
double Blocks::disc_residual(double mu, const double* z, const double* w) {
  const double x1 = z[1] - w[1], x2 = z[2] - w[2], x0 = z[0] - (w[0] + mu * slip_length(w + 1, 2));
  const std::array<double, 2> x{x1, x2};
  const double s = slip_length(x.data(), 2);
  double e0 = z[0], e1 = z[1], e2 = z[2];
  if (x0 >= 0 && s <= mu * x0) {
    e0 -= x0, e1 -= x1, e2 -= x2;
  } else if (const double a = (x0 + mu * s) / (1 + mu * mu); !(a <= 0)) {  // NaN too
    const double share = mu * a / s;
    e0 -= a, e1 -= share * x1, e2 -= share * x2;
  }
  return std::sqrt(e0 * e0 + e1 * e1 + e2 * e2);
}

double Blocks::residual(const Block& b, const double* z, const double* w) const {
  if (b.rows == 3 && b.parts == 1 && b.lo == 0 && b.hi == kInf) return disc_residual(parts(b)[0].mu, z, w);
  std::array<double, kMostRows> few_x, few_y;
  static thread_local std::vector<double> many;
  double *x = few_x.data(), *y = few_y.data();
  if (b.rows > kMostRows) many.resize(at(2 * b.rows)), x = many.data(), y = x + b.rows;
  correct(b, w, x);
  for (int r = 0; r < b.rows; ++r) x[r] = z[r] - x[r];
  project(b, x, y);
  double sum = 0;
  for (int r = 0; r < b.rows; ++r) sum += (z[r] - y[r]) * (z[r] - y[r]);
  return std::sqrt(sum);
}

}  // namespace orthant::cones
