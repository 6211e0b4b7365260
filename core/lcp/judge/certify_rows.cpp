// Every part of a problem by itself, and every row in its own unit.
#include <orthant/core/lcp/judge/certify.h>
#include <orthant/core/lcp/judge/certify_sums.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace orthant {
namespace {

using detail::kCoarsest, detail::kEpsilon, detail::kRoundings;
constexpr double kOfBox = 1e-6;  // of its width: distance of a z from the bound of a box

}  // namespace

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
  for (const Friction& f : problem.friction)
    for (Index t = f.first; t < f.first + f.rows; ++t) join(t, f.normal);
  for (Index i = 0; i < n; ++i) part_[at(i)] = root(i);
}

// x_i ← the least with x_i ≥ x_i and x_i ≥ min(width(A_ij, j), x_j) for all j. The widest paths, the widest first: n
// log n for n rows, where sweeps over a long chain whose rows are in no order take n². Friction has its normal's.
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
    for (const Friction& f : problem.friction) place(f.normal, f.first, kInf);
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
        if (f.normal == j) raise(f.first, much);
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
  for (Index i = 0; i < n; ++i) at_bound_[at(i)] = detail::on_bound(s.z[i], problem.lo[i], problem.hi[i]);
  for (const Friction& f : problem.friction)
    at_bound_[at(f.first)] = at_bound_[at(f.normal)] != 0 && std::abs(s.z[f.first]) == f.mu * s.z[f.normal];
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
  const auto sums = [&](Vector& size) { detail::sum_rows(problem.A, problem.b, beta_, lo_, size, inner_, inner_abs_); };
  detail::largest_of_columns(problem.A, d_);
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
  if (settled_ && size_ <= detail::runaway(least_scale_)) return true;
  label_parts(problem);
  const auto* delassus = std::get_if<Delassus>(&problem.A);
  const bool formed = delassus == nullptr || to_rows(*delassus, entries_, detail::kFormed);
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
      double allowance = std::max(tolerance * std::min(own, row.size), std::min(noise(i), most));
      double accepted = std::min(allowance, allowed(tolerance, kEpsilon * whole.most, beta));
      if (row.residual > accepted && row.residual < detail::kLeastNormal) {
        accepted = std::max(accepted, detail::lost_to_underflow(problem.A, d_));
        allowance = std::max(allowance, accepted);
      }
      if (!(whole.most <= detail::runaway(beta) && row.size <= detail::runaway(own) && row.residual <= accepted))
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

// A z_i near its bound changes the other rows when it is moved there: by no more than the w_k that holds z_k at its own
// bound, and for each such z_i what is excused in the row.
bool Judge::others_bear_moves(const Lcp& problem) {
  const Index n = problem.size();
  for (Index k = 0; k < n; ++k) rows_[at(k)].charge = 0;
  for (const Friction& f : problem.friction)
    rows_[at(f.first)].move += f.mu * rows_[at(f.normal)].move;  // its bounds move
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

}  // namespace orthant
