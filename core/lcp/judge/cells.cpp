#include <orthant/core/lcp/judge/cells.h>

#include <orthant/core/lcp/judge/cell_words.h>
#include <orthant/core/lcp/judge/exact.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace orthant {
namespace {

using exact::Rational;
using exact::Row;
using exact::Table;

constexpr Index kFewRows = 12;
constexpr double kFewCells = 4096;
constexpr signed char kLower = -1, kInside = 0, kUpper = 1;

struct RowKind {
  const Friction* friction = nullptr;
  bool below = false, above = false, fixed = false;  // bounds that there are

  std::vector<signed char> sides() const {
    std::vector<signed char> all;
    if (below) all.push_back(kLower);
    if (!fixed) all.push_back(kInside);
    if (above && !fixed) all.push_back(kUpper);
    return all;
  }
};

std::vector<RowKind> kinds_of_rows(const Lcp& p) {
  std::vector<RowKind> all(at(p.size()));
  for (const Friction& f : p.friction) all[at(f.first)] = {&f, true, true, f.mu == 0};
  for (Index i = 0; i < p.size(); ++i)
    if (all[at(i)].friction == nullptr) all[at(i)] = {nullptr, p.lo[i] > -kInf, p.hi[i] < kInf, p.lo[i] == p.hi[i]};
  return all;
}

/// The tree of classes, walked once: z as an affine function of the entries that the equations leave.
class CellCheck {
 public:
  CellCheck(const Lcp& problem, const std::vector<Cell>& cells, const std::function<bool()>& stop)
      : p_(problem),
        cells_(cells),
        stop_(stop),
        n_(at(problem.size())),
        A_(exact::table(problem.A)),
        kinds_(kinds_of_rows(problem)),
        order_(order_of_decision(problem)) {
    for (std::size_t k = 0; k < cells.size(); ++k) sorted_.push_back(k);
    std::sort(sorted_.begin(), sorted_.end(), [&](auto a, auto b) { return cells_[a].sides < cells_[b].sides; });
    sides_.assign(n_, kInside), decided_.assign(n_, 0);
  }

  bool run() {
    if (cells_.empty()) return false;
    Table z(n_, Row(n_ + 1));
    for (std::size_t i = 0; i < n_; ++i) {
      const RowKind& kind = kinds_[i];
      const Index row = static_cast<Index>(i);
      z[i][i + 1] = kind.below || !kind.above ? 1 : -1;
      if (kind.friction == nullptr && (kind.below || kind.above)) z[i][0] = kind.below ? p_.lo[row] : p_.hi[row];
    }
    for (const Friction& f : p_.friction)
      for (std::size_t k = 0; k <= n_; ++k) z[at(f.first)][k] -= Rational(f.mu) * z[at(f.normal)][k];
    return visit(z, 0, 0, sorted_.size());
  }

 private:
  static bool constant(const Row& form) {
    return std::all_of(form.begin() + 1, form.end(), [](const Rational& x) { return x.is_zero(); });
  }
  static bool vanishes(const Row& form) { return form[0].is_zero() && constant(form); }

  Row w(const Table& z, std::size_t i) const {
    Row form(n_ + 1);
    form[0] = p_.b[static_cast<Index>(i)];
    for (std::size_t j = 0; j < n_; ++j)
      if (!A_[i][j].is_zero())
        for (std::size_t k = 0; k <= n_; ++k) exact::add_product(form[k], A_[i][j], z[j][k]);
    return form;
  }

  /// z_i − lo_i or hi_i − z_i.
  Row distance(const Table& z, std::size_t i, bool upper) const {
    Row form = z[i];
    if (const Friction* f = kinds_[i].friction)
      for (std::size_t k = 0; k <= n_; ++k) form[k] += Rational(upper ? -f->mu : f->mu) * z[at(f->normal)][k];
    else
      form[0] -= upper ? p_.hi[static_cast<Index>(i)] : p_.lo[static_cast<Index>(i)];
    if (upper)
      for (Rational& x : form) x = -x;
    return form;
  }

  Row equation(const Table& z, std::size_t i, signed char side) const {
    return side == kInside ? w(z, i) : distance(z, i, side == kUpper);
  }

  bool any_sign(std::size_t entry) const { return !kinds_[entry].below && !kinds_[entry].above; }

  /// What w_i must be times: 1 ≥ 0, −1 ≤ 0, 0: of any sign so far.
  int wanted(std::size_t i) const {
    const RowKind& kind = kinds_[i];
    if (kind.fixed) return 0;
    if (decided_[i] != 0) return -sides_[i];
    return kind.below == kind.above ? 0 : kind.below ? 1 : -1;
  }

  bool never(Row form, int sign) const {
    if (sign < 0)
      for (Rational& x : form) x = -x;
    if (!(form[0] < 0)) return false;
    for (std::size_t k = 0; k < n_; ++k)
      if (form[k + 1] > 0 || (form[k + 1] < 0 && any_sign(k))) return false;
    return true;
  }

  bool no_common_point(const Table& z) const {
    Table G(1, Row(n_ + 1));
    G[0][0] = 1;
    for (std::size_t k = 0; k < n_; ++k)
      if (!any_sign(k)) G.emplace_back(n_ + 1), G.back()[k + 1] = 1;
    for (std::size_t i = 0; i < n_; ++i) {
      if (kinds_[i].below) G.push_back(distance(z, i, false));
      if (kinds_[i].above) G.push_back(distance(z, i, true));
      const int sign = wanted(i);
      if (sign == 0) continue;
      G.push_back(w(z, i));
      if (sign < 0)
        for (Rational& x : G.back()) x = -x;
    }
    const exact::Cone cone = exact::cone(G, n_ + 1, stop_);
    const auto within = [](const Row& ray) { return !ray[0].is_zero(); };
    return !(stop_ && stop_()) && std::none_of(cone.rays.begin(), cone.rays.end(), within) &&
           std::none_of(cone.lines.begin(), cone.lines.end(), within);
  }

  /// The class `cell`, whose last equation has just been taken.
  bool empty(const Cell& cell, const Table& z) const {
    if (cell.row < 0 || at(cell.row) >= n_) return false;
    const auto i = at(cell.row);
    switch (cell.why) {
      case Cell::Why::from_lower:
        return kinds_[i].below && never(distance(z, i, false), 1);
      case Cell::Why::to_upper:
        return kinds_[i].above && never(distance(z, i, true), 1);
      case Cell::Why::w:
        return wanted(i) != 0 && never(w(z, i), wanted(i));
      case Cell::Why::polyhedron:
        return cell.sides.size() == n_ && no_common_point(z);
      default:  // seen to before the equation is taken
        return false;
    }
  }

  /// One more row: its equation of `side` expresses `entry`.
  bool express(Table& z, const Row& form, int entry) const {
    if (entry < 0) return vanishes(form);
    const auto pivot = at(entry) + 1;
    if (pivot > n_ || form[pivot].is_zero()) return false;
    for (Row& row : z) {
      if (row[pivot].is_zero()) continue;
      const Rational factor = row[pivot] / form[pivot];
      for (std::size_t k = 0; k <= n_; ++k) exact::subtract_product(row[k], factor, form[k]);
    }
    return true;
  }

  /// The classes sorted_[begin … end), which agree in their first `depth` sides.
  bool visit(const Table& z, std::size_t depth, std::size_t begin, std::size_t end) {
    if (stop_ && stop_()) return false;
    if (begin == end || depth == n_) return false;  // cells that are missing; a class twice
    const auto i = at(order_[depth]);
    const bool still = vanishes(w(z, i));
    std::size_t from = begin;
    for (const signed char side : kinds_[i].sides()) {
      std::size_t to = from;
      while (to < end && cells_[sorted_[to]].sides.size() > depth && cells_[sorted_[to]].sides[depth] == side) ++to;
      if (to == from) return false;
      if (!child(z, depth, i, side, still && !kinds_[i].fixed, from, to)) return false;
      from = to;
    }
    return from == end;
  }

  bool child(const Table& z, std::size_t depth, std::size_t i, signed char side, bool still, std::size_t begin,
             std::size_t end) {
    const Cell& first = cells_[sorted_[begin]];
    const bool last = first.sides.size() == depth + 1;
    if (last && end != begin + 1) return false;
    const Row form = equation(z, i, side);
    if (last && first.why == Cell::Why::equation) return constant(form) && !form[0].is_zero();
    if (last && first.why == Cell::Why::within && side != kInside) return still;
    if (first.expressed.size() <= depth) return false;
    for (std::size_t k = begin; k < end; ++k)
      if (cells_[sorted_[k]].expressed.size() <= depth || cells_[sorted_[k]].expressed[depth] != first.expressed[depth])
        return false;
    Table inner = z;
    if (!express(inner, form, first.expressed[depth])) return false;
    if (last && first.why == Cell::Why::within)
      return !still && ((kinds_[i].below && vanishes(distance(inner, i, false))) ||
                        (kinds_[i].above && vanishes(distance(inner, i, true))));
    sides_[i] = side, decided_[i] = 1;
    const bool none = last ? empty(first, inner) : visit(inner, depth + 1, begin, end);
    decided_[i] = 0;
    return none;
  }

  const Lcp& p_;
  const std::vector<Cell>& cells_;
  const std::function<bool()>& stop_;
  const std::size_t n_;
  const Table A_;
  const std::vector<RowKind> kinds_;
  const std::vector<Index> order_;
  std::vector<std::size_t> sorted_;
  std::vector<signed char> sides_;
  std::vector<char> decided_;
};

}  // namespace

double count_cells(const Lcp& problem) {
  double count = 1;
  for (const RowKind& kind : kinds_of_rows(problem)) count *= static_cast<double>(kind.sides().size());
  return count;
}

bool has_few_cells(const Lcp& problem) {
  return problem.size() <= kFewRows && !problem.discs() && count_cells(problem) <= kFewCells;
}

std::vector<Index> order_of_decision(const Lcp& problem) {
  const auto all = kinds_of_rows(problem);
  std::vector<Index> order;
  for (const bool choice : {false, true})
    for (Index i = problem.size(); i-- > 0;)
      if ((all[at(i)].sides().size() > 1) == choice) order.push_back(i);
  return order;
}

bool no_cell_has_a_solution(const Lcp& problem, const std::vector<Cell>& cells, const std::function<bool()>& stop) {
  return problem.size() > 0 && finite(problem) && CellCheck(problem, cells, stop).run();
}

std::string letters(const Cell& cell) {
  std::string sides;
  for (const signed char side : cell.sides) sides += side < 0 ? 'L' : side > 0 ? 'U' : 'I';
  return sides;
}

std::string_view words_of(Cell::Why why) {
  constexpr std::array<std::string_view, 6> kWords = {"z - lower < 0", "upper - z < 0", "w",
                                                      "equation",      "within",        "polyhedron"};
  return kWords[at(static_cast<int>(why))];
}

}  // namespace orthant
