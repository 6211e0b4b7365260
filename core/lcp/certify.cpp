#include <orthant/core/lcp/certify.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace orthant {

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kCoarsest = 4e-5;  // residual beside β that rounding may excuse
// s above this: w is unknown. By s, not by ρ = ε s, which is no number any more where s < 1e-308.
double runaway(double beta) { return std::min(1e-6 / kEpsilon * (1 + beta), 1e-4 / kEpsilon * beta); }
// s above this: no z is worth looking for. Between the two nothing is claimed: a z may hold that no double can show.
double unknowable(double beta) { return 1e-2 / kEpsilon * beta; }
constexpr double kOfBox = 1e-6;     // of its width, that a z may be beside the bound of a box
constexpr double kRoundings = 20;   // residuals below this many ρ are noise
constexpr double kTelling = 1e-11;  // 20 ρ beside β below which an operator's sums need no second look
constexpr Index kFew = 8;           // rows
constexpr long double kRounding = std::numeric_limits<long double>::epsilon() / 2;
constexpr double kProducts = 1e-290;  // a sum below it may have lost terms that are smaller than any double
constexpr double kFormed = 7e7;       // products up to which an operator's entries are formed

// Its first 26 bits.
double head(double value) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(value) & ~std::uint64_t{0x7ffffff});
}

// w ← A z + b, abs ← |A| |z| + |b|; a Delassus operator is bounded through its factors, as it is applied.
void apply(const Matrix& A, const Vector& b, const Vector& z, Vector& w, Vector& abs, Vector& inner,
           Vector& inner_abs) {
  const Index n = z.size();
  w.resize(n);
  abs.resize(n);
  if (const auto* dense = std::get_if<DenseMatrix>(&A)) {
    double* const wi = w.data();
    double* const ai = abs.data();
    if (n <= kFew) {  // the same sums row by row: what few rows cost is else the loops around them
      for (Index i = 0; i < n; ++i) {
        double sum = b[i], size = std::abs(b[i]);
        for (Index j = 0; j < n; ++j) {
          const double product = dense->data()[i + j * n] * z[j];
          sum += product;
          size += std::abs(product);
        }
        wi[i] = sum, ai[i] = size;
      }
      return;
    }
    for (Index i = 0; i < n; ++i) wi[i] = b[i], ai[i] = std::abs(b[i]);
    for (Index j = 0; j < n; ++j) {
      const double* const column = dense->data() + j * n;
      const double zj = z[j];
      for (Index i = 0; i < n; ++i) {  // zeros too: 0 · NaN must not pass unseen
        const double product = column[i] * zj;
        wi[i] += product;
        ai[i] += std::abs(product);
      }
    }
    return;
  }
  const auto rows_times = [](const RowSparse& M, const Vector& x, const Vector& x_abs, Index i, double& sum,
                             double& sum_abs) {
    for (std::size_t k = at(M.start[at(i)]); k < at(M.start[at(i) + 1]); ++k) {
      sum += M.value[k] * x[M.column[k]];
      sum_abs += std::abs(M.value[k]) * x_abs[M.column[k]];
    }
  };
  if (const auto* sparse = std::get_if<RowSparse>(&A)) {
    inner_abs.resize(n);
    inner_abs = z.cwiseAbs();
    for (Index i = 0; i < n; ++i) {
      w[i] = b[i], abs[i] = std::abs(b[i]);
      rows_times(*sparse, z, inner_abs, i, w[i], abs[i]);
    }
    return;
  }
  const auto& [W, inverse_mass, regularization] = std::get<Delassus>(A);
  inner.resize(W.cols);
  inner_abs.resize(W.cols);
  inner.setZero();
  inner_abs.setZero();
  for (Index i = 0; i < n; ++i)
    for (std::size_t k = at(W.start[at(i)]); k < at(W.start[at(i) + 1]); ++k) {
      const double product = W.value[k] * z[i];
      inner[W.column[k]] += product;
      inner_abs[W.column[k]] += std::abs(product);
    }
  inner.array() *= inverse_mass.array();
  inner_abs.array() *= inverse_mass.array();
  for (Index i = 0; i < n; ++i) {
    w[i] = b[i], abs[i] = std::abs(b[i]);
    if (regularization.size() != 0) {
      w[i] += regularization[i] * z[i];
      abs[i] += regularization[i] * std::abs(z[i]);
    }
    rows_times(W, inner, inner_abs, i, w[i], abs[i]);
  }
}

// max_j |A_ji| for all i. Delassus: |A_ji| ≤ √(A_ii A_jj) ≤ √(A_ii max A_jj), at least the column's norm.
void largest_of_columns(const Matrix& A, Vector& d) {
  if (const auto* dense = std::get_if<DenseMatrix>(&A)) {
    d.resize(dense->cols());
    for (Index j = 0; j < d.size(); ++j) d[j] = dense->col(j).cwiseAbs().maxCoeff();
  } else if (const auto* sparse = std::get_if<RowSparse>(&A)) {
    d.resize(sparse->cols);
    d.setZero();
    for (std::size_t k = 0; k < sparse->value.size(); ++k)
      d[sparse->column[k]] = std::max(d[sparse->column[k]], std::abs(sparse->value[k]));
  } else {
    diagonal(A, d);
    d = (d * d.maxCoeff()).cwiseSqrt();
  }
}

bool on_bound(double z, double lo, double hi) { return (z == lo || z == hi) && std::abs(z) < kInf; }
double nearest_to_zero(double lo, double hi) { return lo > 0 ? lo : hi < 0 ? hi : 0; }

}  // namespace

/// Room for problems of that size, needed now or not: a later z must find it there.
void Judge::prepare(const Lcp& problem) {
  const Index n = problem.size();
  const auto* delassus = std::get_if<Delassus>(&problem.A);
  if (delassus != nullptr && at(delassus->W.cols) > inner_ld_.capacity())
    for (auto* each : {&inner_ld_, &inner_abs_ld_}) each->reserve(at(delassus->W.cols));
  if (const auto* rows = std::get_if<RowSparse>(&problem.A))
    ways_.reserve(rows->value.size() + problem.friction.size());
  if (at(n) <= rows_.size()) return;
  for (Vector* each : {&d_, &lo_, &hi_, &beta_, &reach_}) each->resize(n);
  for (auto* each : {&g_, &g_abs_, &g_error_}) each->reserve(at(n));
  rows_.resize(at(n));
  heap_.reserve(at(2 * n + 1));
}

void Judge::evaluate(const Lcp& problem, Solution& s, bool extended) {
  const Index n = problem.size();
  prepare(problem);
  apply(problem.A, problem.b, s.z, s.w, abs_, inner_, inner_abs_);
  if (extended) {
    product(problem.A, s.z, false);
    for (Index i = 0; i < n; ++i) s.w[i] = static_cast<double>(problem.b[i] + g_[at(i)]);
  }

  const double* lo = problem.lo.data();
  const double* hi = problem.hi.data();
  if (!problem.friction.empty()) {
    lo_.resize(n), hi_.resize(n);
    for (Index i = 0; i < n; ++i) lo_[i] = lo[i], hi_[i] = hi[i];
    for (const Friction& f : problem.friction) {
      hi_[f.row] = f.mu * std::max(s.z[f.normal], 0.0);
      lo_[f.row] = -hi_[f.row];
    }
    lo = lo_.data();
    hi = hi_.data();
  }

  double residual = 0, size = 0, scale = 0, least = kInf, checksum = 0;
  bool bounded = false, weighed = false;
  settled_ = true;
  for (Index i = 0; i < n; ++i) {
    const double z = s.z[i], w = s.w[i];
    checksum += 0.0 * z + 0.0 * w;  // NaN when one of them is not finite
    size = std::max(size, abs_[i]);
    const double data = std::abs(problem.b[i]);
    scale = std::max(scale, data);
    if (data > 0) least = std::min(least, data);
    bounded = bounded || nearest_to_zero(problem.lo[i], problem.hi[i]) != 0 ||
              (z != 0 && on_bound(z, problem.lo[i], problem.hi[i]));
    // d |z − clamp(z − w/d)| = max(d · how far z is out of its bounds, min(d · distance to the bound that w pushes against, |w|)):
    // never by z − w/d, which is z where w/d is below its rounding, whatever w is.
    double r = std::abs(w), out = 0, beside = 0, held = 0;
    const double room = w >= 0 ? z - lo[i] : hi[i] - z;
    if (room == 0 && r > 0 && lo[i] <= z && z <= hi[i]) {  // on the bound that w holds it at: most are
      held = lo[i] < hi[i] ? r : kInf, r = 0;
    } else if (z < lo[i] || z > hi[i] || room < r) {
      // d matters only here, where z is off its bound by less than |w|: most verdicts never need the weights.
      if (room != 0 && !weighed) largest_of_columns(problem.A, d_), weighed = true;
      const double d = room == 0 ? 1.0 : std::max(1.0, d_[i]);
      out = std::max({lo[i] - z, z - hi[i], 0.0});
      if (d * std::max(room, 0.0) < r) beside = std::max(room, 0.0), held = lo[i] < hi[i] ? r : kInf, r = d * beside;
      r = std::max(d * out, r);
    }
    residual = std::max(residual, r);
    Row& row = rows_[at(i)];
    row.residual = r, row.data = data, row.size = row.most = abs_[i];
    row.out = out, row.room = beside, row.held = held;
    settled_ = settled_ && r <= kRoundings * kEpsilon * abs_[i] && !(beside > 0);
  }
  if (bounded) {
    beta_.resize(n);
    for (Index i = 0; i < n; ++i) {
      const double z = s.z[i], lower = problem.lo[i], upper = problem.hi[i];
      beta_[i] = on_bound(z, lower, upper) ? z : nearest_to_zero(lower, upper);
    }
    apply(problem.A, problem.b, beta_, lo_, abs_, inner_, inner_abs_);
    scale = 0, least = kInf;
    for (Index i = 0; i < n; ++i) {
      rows_[at(i)].data = abs_[i];
      scale = std::max(scale, abs_[i]);
      if (abs_[i] > 0) least = std::min(least, abs_[i]);
    }
  }
  if (const auto* delassus = std::get_if<Delassus>(&problem.A);
      extended && delassus != nullptr && to_rows(*delassus, entries_, kFormed)) {
    // The factors bound Σ_j |A_ij z_j| from above, by far where they cancel: here the sum itself is the measure.
    size = 0;
    for (Index i = 0; i < n; ++i) {
      double sum = std::abs(problem.b[i]);
      for (std::size_t k = at(entries_.start[at(i)]); k < at(entries_.start[at(i) + 1]); ++k)
        sum += std::abs(entries_.value[k] * s.z[entries_.column[k]]);
      rows_[at(i)].size = rows_[at(i)].most = sum;
      size = std::max(size, sum);
    }
  }
  s.residual = checksum == 0.0 && residual < kInf ? residual : kInf;
  size_ = checksum == 0.0 ? size : kInf;
  s.rounding = kEpsilon * size_;
  scale_ = scale;
  least_scale_ = least;
}

double Judge::allowed(double tolerance, double rounding, double beta) {
  return std::max(tolerance * beta, std::min(kRoundings * rounding, kCoarsest * beta));
}

// Which rows belong together: path-halving union of the rows that an entry of A, a body or a friction bound couples.
void Judge::label_parts(const Lcp& problem) {
  const Index n = problem.size();
  part_.resize(at(n));
  for (Index i = 0; i < n; ++i) part_[at(i)] = static_cast<int>(i);
  const auto root = [this](Index i) {
    auto k = static_cast<std::size_t>(i);
    while (part_[k] != static_cast<int>(k)) {
      part_[k] = part_[at(part_[k])];
      k = at(part_[k]);
    }
    return static_cast<int>(k);
  };
  const auto join = [&](Index i, Index j) {
    const int a = root(i), b = root(j);
    part_[at(std::max(a, b))] = std::min(a, b);
  };
  if (const auto* dense = std::get_if<DenseMatrix>(&problem.A)) {
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i)
        if ((*dense)(i, j) != 0 && i != j) join(i, j);
  } else if (const auto* sparse = std::get_if<RowSparse>(&problem.A)) {
    for (Index i = 0; i < n; ++i)
      for (std::size_t k = at(sparse->start[at(i)]); k < at(sparse->start[at(i) + 1]); ++k)
        if (sparse->value[k] != 0) join(i, sparse->column[k]);
  } else {
    const RowSparse& W = std::get<Delassus>(problem.A).W;
    first_.assign(at(W.cols), -1);
    for (Index i = 0; i < n; ++i)
      for (std::size_t k = at(W.start[at(i)]); k < at(W.start[at(i) + 1]); ++k) {
        int& first = first_[at(W.column[k])];
        if (first < 0) first = static_cast<int>(i);
        join(i, first);
      }
  }
  for (const Friction& f : problem.friction) join(f.row, f.normal);
  for (Index i = 0; i < n; ++i) part_[at(i)] = root(i);
}

// x_i ← the least with x_i ≥ x_i and x_i ≥ min(width(A_ij, j), x_j) for all j. The widest paths, the widest first: n log n
// for n rows, where sweeps over a long chain whose rows are in no order take n². Friction has its normal's.
template <class Width> void Judge::spread(const Lcp& problem, const Width& width, Vector& x) {
  const auto* dense = std::get_if<DenseMatrix>(&problem.A);
  const auto* rows = std::get_if<RowSparse>(&problem.A);
  if (std::holds_alternative<Delassus>(problem.A)) rows = &entries_;
  const Index n = problem.size();
  if (rows != nullptr) {  // by columns
    first_.assign(at(n + 1), 0);
    for (const int column : rows->column) ++first_[at(column)];
    for (const Friction& f : problem.friction) ++first_[at(f.normal)];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    ways_.resize(at(first_[at(n)]));
    const auto place = [&](Index j, Index i, double wide) { ways_[at(--first_[at(j)])] = {wide, static_cast<int>(i)}; };
    for (Index i = 0; i < n; ++i)
      for (std::size_t k = at(rows->start[at(i)]); k < at(rows->start[at(i) + 1]); ++k)
        place(rows->column[k], i, width(rows->value[k], rows->column[k]));
    for (const Friction& f : problem.friction) place(f.normal, f.row, kInf);
  }
  heap_.clear();
  for (Index i = 0; i < n; ++i)
    if (x[i] > 0) heap_.emplace_back(x[i], static_cast<int>(i));
  std::make_heap(heap_.begin(), heap_.end());
  const auto stale = [&](const Way& each) { return each.first < x[each.second]; };
  const auto raise = [&](Index i, double by) {
    if (by <= x[i]) return;
    x[i] = by;
    if (heap_.size() > at(2 * n)) {  // no more than n are not stale
      std::erase_if(heap_, stale);
      std::make_heap(heap_.begin(), heap_.end());
    }
    heap_.emplace_back(by, static_cast<int>(i));
    std::push_heap(heap_.begin(), heap_.end());
  };
  while (!heap_.empty()) {
    std::pop_heap(heap_.begin(), heap_.end());
    const Way next = heap_.back();
    heap_.pop_back();
    if (stale(next)) continue;
    const auto [much, j] = next;
    if (dense != nullptr) {
      for (Index i = 0; i < n; ++i) raise(i, std::min(width((*dense)(i, j), j), much));
      for (const Friction& f : problem.friction)
        if (f.normal == j) raise(f.row, much);
    } else {
      for (std::size_t k = at(first_[at(j)]); k < at(first_[at(j + 1)]); ++k)
        raise(ways_[k].second, std::min(ways_[k].first, much));
    }
  }
}

// abs_, hi_ ← t_i by the sizes of z, and by what they do to w.
void Judge::find_unknown(const Lcp& problem, const Solution& s, bool formed) {
  constexpr double kMost = std::numeric_limits<double>::max();  // times an entry of 0 that is 0, unlike infinity
  const Index n = problem.size();
  at_bound_.assign(at(n), 0);
  for (Index i = 0; i < n; ++i) at_bound_[at(i)] = on_bound(s.z[i], problem.lo[i], problem.hi[i]);
  for (const Friction& f : problem.friction)
    at_bound_[at(f.row)] = at_bound_[at(f.normal)] != 0 && std::abs(s.z[f.row]) == f.mu * s.z[f.normal];
  const auto at_bound = [this](Index i) { return at_bound_[at(i)] != 0; };
  const auto computed_from = [&](Vector& x) {
    if (formed)
      return spread(
          problem, [&](double a, Index j) { return a != 0 && !at_bound(j) ? kInf : 0.0; }, x);
    for (Index i = 0; i < n; ++i) rows_[at(i)].largest = 0;
    for (Index i = 0; i < n; ++i) {
      double& largest = rows_[at(part_[at(i)])].largest;
      largest = std::max(largest, x[i]);
    }
    for (Index i = 0; i < n; ++i) x[i] = rows_[at(part_[at(i)])].largest;
  };
  const auto sums = [&](Vector& size) { apply(problem.A, problem.b, beta_, lo_, size, inner_, inner_abs_); };
  largest_of_columns(problem.A, d_);
  beta_ = s.z.cwiseAbs();
  computed_from(beta_);
  for (Index i = 0; i < n; ++i) beta_[i] = at_bound(i) ? std::abs(s.z[i]) : beta_[i];
  sums(abs_);
  for (Index i = 0; i < n; ++i) beta_[i] = d_[i] * std::abs(s.z[i]);
  computed_from(beta_);
  for (Index i = 0; i < n; ++i)
    beta_[i] = at_bound(i) ? std::abs(s.z[i]) : d_[i] > 0 ? std::min(beta_[i] / d_[i], kMost) : 0;
  sums(hi_);
}

// The rule for each part by itself, and for each row in its own unit.
bool Judge::rows_pass(const Lcp& problem, double tolerance, const Solution& s) {
  if (settled_ && size_ <= runaway(least_scale_)) return true;
  label_parts(problem);
  const auto* delassus = std::get_if<Delassus>(&problem.A);
  const bool formed = delassus == nullptr || to_rows(*delassus, entries_, kFormed);
  const Index n = problem.size();
  reach_.resize(n);
  for (Index i = 0; i < n; ++i) reach_[i] = rows_[at(i)].data;
  if (formed)
    spread(
        problem, [&](double a, Index j) { return std::abs(a * s.z[j]); }, reach_);
  for (Index i = 0; i < n; ++i) {  // the root is the first of its rows
    Row& whole = rows_[at(part_[at(i)])];
    whole.most = std::max(whole.most, rows_[at(i)].size);
    whole.data = std::max(whole.data, rows_[at(i)].data);
  }
  const auto pass = [&](const auto& noise) {
    bool moves = false;
    for (Index i = 0; i < n; ++i) {
      Row& row = rows_[at(i)];
      const Row& whole = rows_[at(part_[at(i)])];
      const double beta = whole.data > 0 ? whole.data : scale_;
      const double own = formed && reach_[i] > 0 ? std::max(reach_[i], least_scale_) : beta;
      const double unit = formed && !(reach_[i] > 0) ? std::max(std::min(row.size, beta), least_scale_) : own;
      const double most = std::max(kCoarsest * unit, kRoundings * kEpsilon * beta);  // the latter: nothing runs away
      const double allowance = std::max(tolerance * std::min(own, row.size), std::min(noise(i), most));
      if (!(whole.most <= runaway(beta) && row.size <= runaway(own) &&
            row.residual <= std::min(allowance, allowed(tolerance, kEpsilon * whole.most, beta))))
        return false;
      const bool as_zero = std::abs(s.w[i]) <= allowance;
      const double width = problem.hi[i] - problem.lo[i], room = as_zero ? 0 : row.room;
      if (room > std::max(kOfBox * width, kRoundings * kEpsilon * std::abs(s.z[i])) && problem.lo[i] < problem.hi[i])
        return false;
      row.excused = allowance;
      row.move = std::max(room, row.out);
      row.borne = as_zero && row.held < kInf ? 0 : row.held;
      moves = moves || row.move > 0;
    }
    return !moves || !formed || others_bear_moves(problem);
  };
  if (pass([](Index /*i*/) { return 0.0; })) return true;  // without what takes three times as long to find
  find_unknown(problem, s, formed);
  return pass([this](Index i) {
    const double unknown = std::min(abs_[i], hi_[i]);
    return unknown < kInf && hi_[i] == hi_[i] ? kRoundings * kEpsilon * unknown : 0;
  });
}

// A z_i beside its bound changes the other rows when it is moved there: by no more than the w_k that holds z_k at its own
// bound, and for each such z_i what is excused in the row.
bool Judge::others_bear_moves(const Lcp& problem) {
  const Index n = problem.size();
  for (Index k = 0; k < n; ++k) rows_[at(k)].charge = 0;
  for (const Friction& f : problem.friction)
    rows_[at(f.row)].move += f.mu * rows_[at(f.normal)].move;  // its bounds move
  const auto charge = [this](Index k, Index i, double a) {
    if (k == i || a == 0 || rows_[at(i)].move == 0) return;
    rows_[at(k)].charge += std::abs(a) * rows_[at(i)].move;
    rows_[at(k)].borne += rows_[at(k)].excused;
  };
  if (const auto* dense = std::get_if<DenseMatrix>(&problem.A)) {
    for (Index i = 0; i < n; ++i)
      for (Index k = 0; k < n && rows_[at(i)].move > 0; ++k) charge(k, i, (*dense)(k, i));
  } else {
    const auto* sparse = std::get_if<RowSparse>(&problem.A);
    const RowSparse& rows = sparse != nullptr ? *sparse : entries_;
    for (Index k = 0; k < n; ++k)
      for (std::size_t l = at(rows.start[at(k)]); l < at(rows.start[at(k) + 1]); ++l)
        charge(k, rows.column[l], rows.value[l]);
  }
  return std::all_of(rows_.begin(), rows_.begin() + n, [](const Row& row) { return row.charge <= row.borne; });
}

void Judge::certify(const Lcp& problem, double tolerance, Status claim, Solution& s) {
  if (s.z.size() != problem.size()) {  // a solver that gave up before it had a z
    s.z.resize(problem.size());
    s.z.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  bool known = false;
  const auto passes = [&] {
    known = scale_ < kInf && size_ < kInf && size_ <= runaway(scale_);
    accepted_ = allowed(tolerance, s.rounding, scale_);
    return known && s.residual <= accepted_ && rows_pass(problem, tolerance, s);
  };
  // Where rounding of the sums may be what decides, they are done with more digits: what stands in the way of a z, and
  // all of an operator's, whose factors may cancel far below their own size.
  evaluate(problem, s, false);
  const bool cancels = std::holds_alternative<Delassus>(problem.A) &&
                       !(kRoundings * s.rounding <= std::max(tolerance, kTelling) * scale_);
  bool accepted = !cancels && passes();
  if (cancels || (!accepted && known && s.residual <= kRoundings * s.rounding)) {
    evaluate(problem, s, true);
    accepted = passes();
  }
  if (accepted) {
    s.status = Status::solved;
  } else if (claim == Status::ray && s.certificate.size() == problem.size() &&
             proves_infeasible(problem, s.certificate)) {
    s.status = Status::infeasible;
  } else if (claim == Status::solved || claim == Status::infeasible) {
    s.status = known ? Status::stalled : Status::numerical_error;
  } else {
    s.status = claim;
  }
}

// g_ ← Aᵀu or A u in long double, g_abs_ beside it; of Aᵀu also what rounding has taken from each sum.
void Judge::product(const Matrix& A, const Vector& u, bool transposed) {
  const Index n = u.size();
  g_.assign(at(n), 0);
  g_abs_.assign(at(n), 0);
  g_error_.assign(at(n), 0);
  const auto add = [&](Index j, double a, double x) {
    if (!transposed) {
      const long double product = static_cast<long double>(a) * x;
      g_[at(j)] += product;
      g_abs_[at(j)] += std::abs(product);
      return;
    }
    const double halves[2] = {head(a), a - head(a)}, others[2] = {head(x), x - head(x)};
    for (const double half : halves)
      for (const double other : others) {  // exact, in 54 bits
        const long double term = static_cast<long double>(half) * other, before = g_[at(j)], after = before + term;
        const long double taken = after - before;  // Knuth's exact error of a sum
        g_error_[at(j)] += std::abs((before - (after - taken)) + (term - taken));
        g_[at(j)] = after;
        g_abs_[at(j)] += std::abs(term);
      }
  };
  if (const auto* dense = std::get_if<DenseMatrix>(&A)) {
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) add(transposed ? j : i, (*dense)(i, j), u[transposed ? i : j]);
    return;
  }
  if (const auto* sparse = std::get_if<RowSparse>(&A)) {
    for (Index i = 0; i < n; ++i)
      for (std::size_t k = at(sparse->start[at(i)]); k < at(sparse->start[at(i) + 1]); ++k)
        add(transposed ? sparse->column[k] : i, sparse->value[k], u[transposed ? i : sparse->column[k]]);
    return;
  }
  const auto& [W, inverse_mass, regularization] = std::get<Delassus>(A);  // symmetric: Aᵀu = A u
  inner_ld_.assign(at(W.cols), 0);
  inner_abs_ld_.assign(at(W.cols), 0);
  for (Index i = 0; i < n; ++i)
    for (std::size_t k = at(W.start[at(i)]); k < at(W.start[at(i) + 1]); ++k) {
      const long double product = static_cast<long double>(W.value[k]) * u[i] * inverse_mass[W.column[k]];
      inner_ld_[at(W.column[k])] += product;
      inner_abs_ld_[at(W.column[k])] += std::abs(product);
    }
  for (Index i = 0; i < n; ++i) {
    for (std::size_t k = at(W.start[at(i)]); k < at(W.start[at(i) + 1]); ++k) {
      g_[at(i)] += W.value[k] * inner_ld_[at(W.column[k])];
      g_abs_[at(i)] += std::abs(W.value[k]) * inner_abs_ld_[at(W.column[k])];
    }
    if (regularization.size() != 0) {
      const long double product = static_cast<long double>(regularization[i]) * u[i];
      g_[at(i)] += product;
      g_abs_[at(i)] += std::abs(product);
    }
    g_error_[at(i)] = static_cast<long double>(n + 4) * kRounding * g_abs_[at(i)];
  }
}

bool Judge::proves_infeasible(const Lcp& problem, const Vector& u) {
  const Index n = problem.size();
  if (n == 0 || u.size() != n) return false;
  const double* const lo = problem.lo.data();
  const double* const hi = problem.hi.data();
  double norm1 = 0;
  for (Index i = 0; i < n; ++i) {
    const bool below = lo[i] != -kInf, above = hi[i] != kInf;
    const bool allowed = below == above ? (below ? u[i] == 0 : true) : (below ? u[i] >= 0 : u[i] <= 0);
    if (!allowed || !std::isfinite(u[i])) return false;
    norm1 += std::abs(u[i]);
  }
  for (const Friction& f : problem.friction)
    if (u[f.row] != 0) return false;

  product(problem.A, u, true);
  const auto error = [&](Index j) { return 1.01L * g_error_[at(j)]; };  // 1.01: its own sum was rounded, too

  // Friction rows take part through their normal: sup over |z_t| ≤ μ z_n of g_n z_n + g_t z_t = (g_n + μ |g_t|) z_n.
  // A z that uses the slack of the sum has at least one of its terms: the least of them is what κ is relative to.
  least_ = g_abs_;
  for (const Friction& f : problem.friction)
    if (g_[at(f.normal)] + error(f.normal) <= 0) least_[at(f.normal)] = std::numeric_limits<long double>::infinity();
  for (const Friction& f : problem.friction) {
    if (f.mu == 0 || g_abs_[at(f.row)] == 0) continue;
    least_[at(f.normal)] = std::min(least_[at(f.normal)], f.mu * g_abs_[at(f.row)]);
    const long double push = f.mu * (std::abs(g_[at(f.row)]) + error(f.row));
    g_[at(f.normal)] += push;
    g_abs_[at(f.normal)] += push;
    g_error_[at(f.normal)] += 4 * kRounding * std::max(std::abs(g_[at(f.normal)]), push);
    g_[at(f.row)] = g_abs_[at(f.row)] = 0;
  }
  for (const Friction& f : problem.friction) g_[at(f.row)] = g_abs_[at(f.row)] = 0;

  long double sum = 0, sum_abs = 0, kappa = 0;
  int terms = 0;
  const auto add = [&](long double product) {
    sum += product;
    sum_abs += std::abs(product);
    terms += product != 0;
  };
  for (Index i = 0; i < n; ++i) add(static_cast<long double>(problem.b[i]) * u[i]);
  for (Index j = 0; j < n; ++j) {
    if (g_abs_[at(j)] == 0) continue;
    const long double g = g_[at(j)], e = error(j);
    if (hi[j] == kInf && g + e > 0) kappa = std::max(kappa, (g + e) / least_[at(j)]);
    if (lo[j] == -kInf && g - e < 0) kappa = std::max(kappa, (e - g) / least_[at(j)]);
    // The supremum lies at a finite bound; where the sign of g is not certain, both candidates count.
    long double best = -std::numeric_limits<long double>::infinity();
    if (lo[j] != -kInf) best = std::max({best, (g - e) * lo[j], (g + e) * lo[j]});
    if (hi[j] != kInf && (lo[j] == -kInf || g + e > 0)) best = std::max({best, (g - e) * hi[j], (g + e) * hi[j]});
    if (best > -std::numeric_limits<long double>::infinity()) add(best);
  }
  if (!(kappa <= 32 * static_cast<long double>(kEpsilon))) return false;

  long double threshold = terms <= 1 ? 0 : static_cast<long double>(n + 4) * 2 * kRounding * sum_abs;
  if (kappa > 0) {
    double scale = 0;  // of the rows that the proof speaks of, and of those they are coupled with
    bool bounded = false;
    beta_.resize(n);
    label_parts(problem);
    spoken_.assign(at(n), 0);
    for (Index i = 0; i < n; ++i)
      if (u[i] != 0) spoken_[at(part_[at(i)])] = 1;
    const auto spoken = [this](Index i) { return spoken_[at(part_[at(i)])] != 0; };
    for (Index i = 0; i < n; ++i) {
      const double low = std::abs(lo[i]), high = std::abs(hi[i]);
      beta_[i] = std::max(low < kInf ? low : 0, high < kInf ? high : 0);
      bounded = bounded || beta_[i] != 0;
      if (spoken(i)) scale = std::max(scale, std::abs(problem.b[i]));
    }
    if (bounded) {
      apply(problem.A, problem.b, beta_, lo_, abs_, inner_, inner_abs_);
      for (Index i = 0; i < n; ++i)
        if (spoken(i)) scale = std::max(scale, abs_[i]);
    }
    if (scale < kProducts) return false;
    threshold += 2 * kappa * unknowable(scale) * norm1;
  }
  return sum + threshold < 0;
}

}  // namespace orthant
