#include <orthant/solvers/derivatives/active_pattern.h>

#include <algorithm>
#include <cmath>

namespace orthant {

namespace {

// Largest |A_ij| of each row, at least 1: how far z moves w.
Eigen::VectorXd row_weights(const Matrix& A, Index n) {
  Eigen::VectorXd weight = Eigen::VectorXd::Ones(n);
  if (!for_each_entry(A, [&](Index i, Index, double a) { weight[i] = std::max(weight[i], std::abs(a)); })) {
    // |A_ij| ≤ √(A_ii A_jj)
    Vector diag;
    diagonal(A, diag);
    const double largest = n > 0 ? diag.maxCoeff() : 0;
    for (Index i = 0; i < n; ++i) weight[i] = std::max(1.0, std::sqrt(std::max(0.0, diag[i]) * std::max(0.0, largest)));
  }
  return weight;
}

}  // namespace

ActivePattern::ActivePattern(const Lcp& problem, const Solution& s)
    : threshold(std::max(s.residual, 20 * s.rounding)), friction_(problem.friction) {
  const Index n = problem.size();
  place_.assign(at(n), Place::inside);
  is_friction_.assign(at(n), 0);
  weak_column_of_.assign(at(n), -1);
  direction_.resize(friction_.size());
  margin.resize(n);
  for (const Friction& f : friction_) {
    for (Index i = f.first; i < f.first + f.rows; ++i) is_friction_[at(i)] = 1;
    normal_force_.push_back(s.z[f.normal]);
  }
  weight = row_weights(problem.A, n);
  place_box(problem, s);
  place_friction(problem, s);
  collect(problem);
  std::sort(weak.begin(), weak.end(), [](const WeaklyActive& a, const WeaklyActive& b) { return a.row < b.row; });
}

void ActivePattern::place_box(const Lcp& problem, const Solution& s) {
  for (Index i = 0; i < problem.size(); ++i) {
    if (is_friction_[at(i)]) continue;
    const double below = s.z[i] - problem.lo[i], above = problem.hi[i] - s.z[i], w = s.w[i];
    const bool low = weight[i] * below <= threshold, high = weight[i] * above <= threshold;
    Place& place = place_[at(i)];
    if (problem.lo[i] == problem.hi[i])
      place = w >= 0 ? Place::lower : Place::upper, margin[i] = kInf;
    else if (low && w > threshold)
      place = Place::lower, margin[i] = w;
    else if (high && w < -threshold)
      place = Place::upper, margin[i] = -w;
    else if (!low && !high)
      place = Place::inside, margin[i] = weight[i] * std::min(below, above);
    else {
      place = low && (!high || below <= above) ? Place::weak_lower : Place::weak_upper;
      margin[i] = std::max(std::abs(w), weight[i] * std::min(std::abs(below), std::abs(above)));
      weak.push_back({i, std::min(below, above), w});
    }
  }
}

void ActivePattern::place_friction(const Lcp& problem, const Solution& s) {
  // Box rows first: a friction's column may be bounded by its normal's.
  for (Index i = 0; i < problem.size(); ++i) {
    if (is_friction_[at(i)]) continue;
    const Place place = place_[at(i)];
    if (place == Place::lower || place == Place::upper) continue;
    const double sign = place == Place::weak_upper ? -1 : 1;
    Column column{{{i, sign}}, {{i, sign}}, 0};
    if (place == Place::inside) {
      free_.push_back(std::move(column));
      continue;
    }
    weak_column_of_[at(i)] = static_cast<Index>(weak_columns_.size());
    weak_columns_.push_back(std::move(column));
  }
  for (std::size_t k = 0; k < friction_.size(); ++k) {
    const Friction& f = friction_[k];
    const double radius = f.mu * s.z[f.normal];
    const Place of_normal = place_[at(f.normal)];
    const double w[2] = {s.w[f.first], f.rows > 1 ? s.w[f.first + 1] : 0};
    const double z[2] = {s.z[f.first], f.rows > 1 ? s.z[f.first + 1] : 0};
    const double slip = std::hypot(w[0], w[1]), force = std::hypot(z[0], z[1]);
    const double heavy = f.rows > 1 ? std::max(weight[f.first], weight[f.first + 1]) : weight[f.first];
    const auto note = [&](double value) {
      for (Index i = f.first; i < f.first + f.rows; ++i) margin[i] = value;
    };
    const auto note_weak = [&] {
      for (Index i = 0; i < f.rows; ++i) weak.push_back({f.first + i, radius - force, w[i]});
      note(std::max(slip, heavy * std::abs(radius - force)));
    };
    const auto add = [&](std::vector<Column>& columns, double x, double y, double d = 0) {
      Column column;
      column.d = d;
      for (auto* part : {&column.e, &column.p}) {
        if (x != 0) part->push_back({f.first, x});
        if (y != 0) part->push_back({f.first + 1, y});
      }
      columns.push_back(std::move(column));
    };
    Direction& along = direction_[k];
    const bool open = (of_normal == Place::lower || of_normal == Place::weak_lower) && problem.lo[f.normal] == 0;
    const bool none = f.mu == 0 || open || !(radius > 0) || !(force > 0 || heavy * radius > threshold);  // no disc
    if (slip > threshold && (none || heavy * (radius - force) <= threshold)) {
      along = {{-w[0] / slip, -w[1] / slip}, true};
      if (f.rows > 1 && !none) add(free_, -w[1] / slip, w[0] / slip, slip / radius);
      note(slip);
    } else if (!none && heavy * (radius - force) > threshold) {
      add(free_, 1, 0);
      if (f.rows > 1) add(free_, 0, 1);
      note(heavy * (radius - force));
    } else if (!none) {  // on the edge without slip
      along = {{z[0] / force, z[1] / force}, true};
      if (f.rows > 1) add(free_, -z[1] / force, z[0] / force);
      add(weak_columns_, -z[0] / force, -z[1] / force);
      note_weak();
    } else if (of_normal == Place::weak_lower && f.mu > 0) {
      weak_friction.push_back({weak_column_of_[at(f.normal)], static_cast<Index>(weak_columns_.size()), f.rows, f.mu});
      add(weak_columns_, 1, 0);
      if (f.rows > 1) add(weak_columns_, 0, 1);
      note_weak();
    } else {
      note(f.mu == 0 ? kInf : margin[f.normal]);
    }
  }
}

void ActivePattern::collect(const Lcp& problem) {
  std::vector<Column*> of_row(at(problem.size()), nullptr);
  for (auto* columns : {&free_, &weak_columns_})
    for (Column& column : *columns)
      if (const Index i = column.e.front().row; !is_friction_[at(i)]) of_row[at(i)] = &column;
  for (std::size_t k = 0; k < friction_.size(); ++k) {
    const Friction& f = friction_[k];
    Column* column = of_row[at(f.normal)];
    if (!direction_[k].follows || column == nullptr) continue;
    const double sign = column->p.front().value;
    for (Index i = 0; i < f.rows; ++i)
      if (const double s = direction_[k].s[i]; s != 0) column->e.push_back({f.first + i, sign * f.mu * s});
  }
  std::vector<Entry> sorted;
  const auto form = [&](const std::vector<Column>& columns, bool dragged, Sparse& to) {
    to.resize(problem.size(), static_cast<Index>(columns.size()));
    if (columns.empty()) return;
    to.reserve(3 * to.cols());
    for (std::size_t j = 0; j < columns.size(); ++j) {
      sorted = dragged ? columns[j].e : columns[j].p;
      std::sort(sorted.begin(), sorted.end(), [](const Entry& x, const Entry& y) { return x.row < y.row; });
      to.startVec(static_cast<Index>(j));
      for (const Entry& entry : sorted) to.insertBack(entry.row, static_cast<Index>(j)) = entry.value;
    }
    to.finalize();
  };
  form(free_, true, E), form(free_, false, P);
  form(weak_columns_, true, E_weak), form(weak_columns_, false, P_weak);
  D.resize(static_cast<Index>(free_.size()));
  for (Index j = 0; j < D.size(); ++j) D[j] = free_[at(j)].d;
  free_.clear(), weak_columns_.clear();
}

void ActivePattern::held(const Vector& lo, const Vector& hi, const Vector& mu, Eigen::VectorXd& p) const {
  p.setZero(margin.size());
  for (Index i = 0; i < p.size(); ++i) {
    const Place place = place_[at(i)];
    if (is_friction_[at(i)] || place == Place::inside) continue;
    const bool low = place == Place::lower || place == Place::weak_lower;
    if (const Vector& bound = low ? lo : hi; bound.size() > 0) p[i] = bound[i];
  }
  for (std::size_t k = 0; k < friction_.size(); ++k) {
    const Friction& f = friction_[k];
    if (!direction_[k].follows) continue;
    const double radius = (mu.size() > 0 ? mu[static_cast<Index>(k)] * normal_force_[k] : 0) + f.mu * p[f.normal];
    for (Index i = 0; i < f.rows; ++i) p[f.first + i] = direction_[k].s[i] * radius;
  }
}

void ActivePattern::held_transposed(const Eigen::VectorXd& pi, Vector& lo, Vector& hi, Vector& mu) const {
  Eigen::VectorXd rest = pi;
  const Index n = pi.size();
  lo = Eigen::VectorXd::Zero(n), hi = Eigen::VectorXd::Zero(n);
  mu = Eigen::VectorXd::Zero(static_cast<Index>(friction_.size()));
  for (std::size_t k = 0; k < friction_.size(); ++k) {
    const Friction& f = friction_[k];
    if (!direction_[k].follows) continue;
    double along = 0;
    for (Index i = 0; i < f.rows; ++i) along += direction_[k].s[i] * pi[f.first + i];
    mu[static_cast<Index>(k)] = normal_force_[k] * along;
    rest[f.normal] += f.mu * along;
  }
  for (Index i = 0; i < n; ++i) {
    const Place place = place_[at(i)];
    if (is_friction_[at(i)] || place == Place::inside) continue;
    (place == Place::lower || place == Place::weak_lower ? lo : hi)[i] = rest[i];
  }
}

}  // namespace orthant
