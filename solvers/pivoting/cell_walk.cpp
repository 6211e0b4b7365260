#include <orthant/solvers/pivoting/cell_walk.h>

#include <algorithm>
#include <type_traits>

namespace orthant::cell_walk {

bool within(const Support& a, const Support& b) {
  for (std::size_t k = 0; k < a.size(); ++k)
    if ((a[k] & ~b[k]) != 0) return false;
  return true;
}

bool Walk::run() { return !visit<Filtered>(0); }

/// One function: forms row by row, then the bounds that they have in common.
void Walk::form(const Lcp& problem) {
  const Table A = exact::table(problem.A);
  const Index n = rows_ = problem.size();
  lo_ = problem.lo;
  hi_ = problem.hi;
  friction_ = problem.friction;
  columns_ = static_cast<int>(n) + 1;
  std::vector<const Friction*> coupled(at(n));
  for (const Friction& f : friction_) coupled[at(f.first)] = &f;

  // z in the entries x: z − lo, hi − z, z itself on free rows, z + μ z_n on friction rows.
  Table z(at(n), exact::Row(at(columns_)));
  Node<Rational> root;
  root.left = static_cast<int>(n);
  root.any_sign.assign(at(columns_), 0);
  for (int k = 0; k < columns_; ++k) root.entry.push_back(static_cast<std::int16_t>(k - 1));
  for (Index i = 0; i < n; ++i) {
    exact::Row& zi = z[at(i)];
    const bool below = lo_[i] != -kInf, above = hi_[i] != kInf;
    zi[at(i) + 1] = below || !above ? 1 : -1;
    if (below || above) zi[0] = below ? lo_[i] : hi_[i];
    root.any_sign[at(i) + 1] = !below && !above && coupled[at(i)] == nullptr;
  }
  for (const Friction& f : friction_)
    for (std::size_t k = 0; k < at(columns_); ++k) z[at(f.first)][k] -= Rational(f.mu) * z[at(f.normal)][k];

  Table forms;
  const auto add = [&](exact::Row form, int wanted) {
    forms.push_back(std::move(form));
    root.wanted.push_back(wanted);
    return static_cast<int>(forms.size()) - 1;
  };
  std::vector<Line> free;
  std::uint32_t bit = 1;
  for (Index i = n; i-- > 0;) {
    Line line{.row = i};
    const Friction* const f = coupled[at(i)];
    const bool below = lo_[i] != -kInf || f != nullptr, above = hi_[i] != kInf || f != nullptr;
    line.fixed = f != nullptr ? f->mu == 0 : lo_[i] == hi_[i];
    line.wanted = below == above ? 0 : below ? 1 : -1;
    line.z = add(z[at(i)], 0);
    const auto distance = [&](double bound,
                              int sign) {  // sign · (z_i − bound), the bound being −sign μ z_n with friction
      exact::Row d = z[at(i)];
      if (f == nullptr)
        d[0] -= bound;
      else
        for (std::size_t k = 0; k < d.size(); ++k) d[k] += sign * Rational(f->mu) * z[at(f->normal)][k];
      if (sign < 0)
        for (Rational& entry : d) entry = -entry;
      return add(std::move(d), 1);
    };
    if (below) line.from_lower = distance(lo_[i], 1);
    if (above) line.to_upper = distance(hi_[i], -1);
    exact::Row w(at(columns_));
    w[0] = problem.b[i];
    for (std::size_t j = 0; j < at(n); ++j)
      if (!A[at(i)][j].is_zero())
        for (std::size_t k = 0; k < w.size(); ++k) exact::add_product(w[k], A[at(i)][j], z[j][k]);
    line.w = add(std::move(w), line.wanted);
    if (below) line.choices.push_back(lower);
    if (!line.fixed) line.choices.push_back(inside);
    if (above && !line.fixed) line.choices.push_back(upper);
    if (line.choices.size() > 1) line.bit = bit, bit <<= 1;
    (line.choices.size() > 1 ? lines_ : free).push_back(std::move(line));
  }
  lines_.insert(lines_.begin(), free.begin(), free.end());  // rows without a choice first

  forms_ = static_cast<int>(forms.size());
  for (exact::Row& form : forms) root.forms.insert(root.forms.end(), form.begin(), form.end());
  exact_.resize(lines_.size() + 1);
  filtered_.resize(lines_.size() + 1);
  path_.resize(lines_.size());
  Node<Filtered>& start = filtered_.front();
  start.left = root.left;
  start.any_sign = root.any_sign;
  start.wanted = root.wanted;
  start.entry = root.entry;
  for (const Rational& entry : root.forms) start.forms.emplace_back(entry);
  exact_.front() = std::move(root);
}

// Form f = 0 from now on: one entry is expressed by the others. zero: done, negative: it cannot vanish.
template <class T> Sign Walk::equate(Node<T>& node, int f, int preferred) {
  T* const row = form_of(node, f);
  node.expressed = -1;
  int pivot = 0;
  bool open = false;
  for (int k = 1; k <= node.left; ++k) {
    open = open || exact::sign(row[k]) == Sign::unknown;
    if (exact::weight(row[k]) > (pivot == 0 ? 0 : exact::weight(row[pivot]))) pivot = k;
  }
  if (preferred >= 0)
    pivot = static_cast<int>(std::find(node.entry.begin(), node.entry.end(), preferred) - node.entry.begin());
  if (pivot == 0) {
    const Sign constant = exact::sign(row[0]);
    return open || constant == Sign::unknown ? Sign::unknown : constant == Sign::zero ? Sign::zero : Sign::negative;
  }
  for (int g = 0; g < forms_; ++g) {
    T* const other = form_of(node, g);
    if (g == f) continue;
    if (exact::sign(other[pivot]) != Sign::zero) {
      const T factor = exact::quotient(other[pivot], row[pivot]);
      for (int k = 0; k <= node.left; ++k)
        if (k != pivot) exact::subtract_product(other[k], factor, row[k]);
    }
    other[pivot] = other[node.left];
  }
  std::fill(row, row + node.left, T(0.0));
  node.any_sign[at(pivot)] = node.any_sign[at(node.left)];
  node.expressed = node.entry[at(pivot)], node.entry[at(pivot)] = node.entry[at(node.left)];
  --node.left;
  return Sign::zero;
}

template <class T> bool Walk::vanishes(Node<T>& node, int f) const {
  const T* const row = form_of(node, f);
  return std::all_of(row, row + node.left + 1, [](const T& x) { return exact::sign(x) == Sign::zero; });
}

// A form that has the wrong sign wherever the entries have theirs; −1: none.
template <class T> int Walk::impossible(Node<T>& node) {
  for (int f = 0; f < forms_; ++f) {
    const int wanted = node.wanted[at(f)];
    if (wanted == 0) continue;
    const T* const row = form_of(node, f);
    const auto wrong = wanted > 0 ? Sign::negative : Sign::positive;
    if (exact::sign(row[0]) != wrong) continue;
    bool all = true;
    for (int k = 1; all && k <= node.left; ++k) {
      const Sign s = exact::sign(row[k]);
      all = s == Sign::zero || (s == wrong && node.any_sign[at(k)] == 0);
    }
    if (all) return f;
  }
  return -1;
}

// The node below, in the place for it. zero: it is there, negative: it is empty or part of another.
template <class T> Sign Walk::child(std::size_t depth, Choice choice) {
  const Line& line = lines_[depth];
  Node<T>& node = nodes_of<T>()[depth + 1];
  node = nodes_of<T>()[depth];
  const int f = choice == lower ? line.from_lower : choice == upper ? line.to_upper : line.w;
  if (!line.fixed && choice != inside) node.wanted[at(line.w)] = choice == lower ? 1 : -1;
  const bool as_before = std::is_same_v<T, Rational> && cells_ != nullptr && depth < agreed_;
  if (const Sign outcome = equate(node, f, as_before ? filtered_[depth + 1].expressed : -1); outcome != Sign::zero) {
    if (outcome == Sign::negative) cut<T>(depth, Cell::Why::equation, static_cast<int>(line.row));
    return outcome;
  }
  const bool taken = node.left < nodes_of<T>()[depth].left;  // else lower and upper were not visited
  if (choice == inside && taken &&
      ((line.from_lower >= 0 && vanishes(node, line.from_lower)) ||
       (line.to_upper >= 0 && vanishes(node, line.to_upper)))) {
    cut<T>(depth, Cell::Why::within, static_cast<int>(line.row));
    return Sign::negative;
  }
  const int wrong = impossible(node);
  if (wrong < 0) return Sign::zero;
  cut_by_form<T>(depth, wrong);
  return Sign::negative;
}

// The class of the path down to `depth` has no solution.
template <class T> void Walk::cut(std::size_t depth, Cell::Why why, int row) {
  if (cells_ == nullptr || cells_->size() > kMostCells) return;
  constexpr signed char kSides[] = {-1, 0, 1};
  Cell& cell = cells_->emplace_back();
  cell.why = why, cell.row = row;
  for (std::size_t d = 0; d <= depth; ++d) {
    cell.sides.push_back(kSides[path_[d]]);
    if (d < depth || (why != Cell::Why::equation && (why != Cell::Why::within || path_[d] == inside)))
      cell.expressed.push_back(static_cast<std::int16_t>(nodes_of<T>()[d + 1].expressed));
  }
}

template <class T> void Walk::cut_by_form(std::size_t depth, int form) {
  for (const Line& line : lines_)
    for (const auto& [f, why] : {std::pair{line.from_lower, Cell::Why::from_lower},
                                 {line.to_upper, Cell::Why::to_upper},
                                 {line.w, Cell::Why::w}})
      if (f == form) return cut<T>(depth, why, static_cast<int>(line.row));
}

template <class T> bool Walk::visit_child(std::size_t depth, Choice choice) {
  path_[depth] = choice;
  const Sign outcome = child<T>(depth, choice);
  if constexpr (std::is_same_v<T, Rational>) {
    exact_path_.resize(depth);
    exact_path_.push_back(choice);
  } else if (outcome == Sign::unknown) {
    return visit_exactly(depth + 1, depth);
  }
  return outcome == Sign::zero && visit<T>(depth + 1);
}

// True: enough was found, or the time is over.
template <class T> bool Walk::visit(std::size_t depth) {
  if ((++nodes_ & 63) == 0 && stop_()) return true;
  if (depth == lines_.size()) return leaf(nodes_of<T>()[depth]);
  const Line& line = lines_[depth];
  if (!line.fixed && vanishes(nodes_of<T>()[depth], line.w)) {
    for (const Choice choice : line.choices)
      if (choice != inside) path_[depth] = choice, cut<T>(depth, Cell::Why::within, static_cast<int>(line.row));
    return visit_child<T>(depth, inside);
  }
  return std::any_of(line.choices.begin(), line.choices.end(),
                     [&](Choice choice) { return visit_child<T>(depth, choice); });
}

// The same node in rationals; the part shared with the last path is there already.
bool Walk::visit_exactly(std::size_t depth, std::size_t agreed) {
  agreed_ = agreed;
  std::size_t d = 0;
  while (d < depth && d < exact_path_.size() && exact_path_[d] == path_[d]) ++d;
  exact_path_.resize(d);
  for (; d < depth; ++d) {
    const Sign outcome = child<Rational>(d, path_[d]);
    exact_path_.push_back(path_[d]);
    if (outcome != Sign::zero) {
      exact_path_.pop_back();
      return false;
    }
  }
  return visit<Rational>(depth);
}

// Where all signs are certain and no entry is left; a non-solution has none.
std::optional<Support> Walk::support(Node<Filtered>& node) {
  Support result{};
  for (const Line& line : lines_) {
    const auto mark = [&](int f, std::size_t above, std::size_t below) {
      if (f < 0 || line.bit == 0) return true;
      const Sign s = exact::sign(*form_of(node, f));
      if (s == Sign::positive) result[above] |= line.bit;
      if (s == Sign::negative) result[below] |= line.bit;
      return s != Sign::unknown;
    };
    if (!mark(line.from_lower, 0, 0) || !mark(line.to_upper, 1, 1) || !mark(line.w, 2, 3)) return {};
  }
  return result;
}

bool Walk::leaf(Node<Filtered>& node) {
  if (node.left == 0)
    if (const auto known = support(node))
      if (seen_.contains(*known)) return false;
  return visit_exactly(lines_.size(), lines_.size());
}

exact::Row Walk::point(Node<Rational>& node, const exact::Row& x, const Rational& one) {
  exact::Row z(at(rows_));
  for (const Line& line : lines_) {
    const Rational* const form = form_of(node, line.z);
    Rational& value = z[at(line.row)] = form[0] * one;
    for (int k = 1; k <= node.left; ++k) value += form[k] * x[at(k)];
  }
  return z;
}

bool Walk::leaf(Node<Rational>& node) {
  const std::size_t dimension = at(node.left) + 1;
  Table G(1, exact::Row(dimension));  // homogeneous in (1, x)
  G[0][0] = 1;
  for (int f = 0; f < forms_; ++f) {
    if (node.wanted[at(f)] == 0) continue;
    const Rational* const form = form_of(node, f);
    G.emplace_back(form, form + dimension);
    if (node.wanted[at(f)] < 0)
      for (Rational& entry : G.back()) entry = -entry;
  }
  exact::Cone cone;
  if (node.left > 0)
    cone = exact::cone(G, dimension, stop_);
  else if (std::all_of(G.begin(), G.end(), [](const exact::Row& g) { return g[0] >= 0; }))
    cone.rays = {{1}};
  Piece piece;
  std::vector<exact::Row*> generators;
  for (exact::Row& ray : cone.rays) {
    if (stop_()) return true;
    if (!ray[0].is_zero()) {
      const Rational scale = ray[0];
      for (Rational& entry : ray) entry /= scale;
    }
    (ray[0].is_zero() ? piece.directions : piece.vertices).push_back(point(node, ray, ray[0]));
    generators.push_back(&ray);
  }
  if (stop_()) return true;
  if (piece.vertices.empty()) {
    cut<Rational>(lines_.size() - 1, Cell::Why::polyhedron, 0);
    return false;
  }
  for (exact::Row& line : cone.lines) {
    piece.lines.push_back(point(node, line, line[0]));
    generators.push_back(&line);
  }
  for (const Line& line : lines_) {
    if (stop_()) return true;
    const auto mark = [&](int f, std::size_t above, std::size_t below) {
      if (f < 0 || line.bit == 0) return;
      for (const exact::Row* x : generators) {
        Rational value = 0;
        for (std::size_t k = 0; k < dimension; ++k) value += form_of(node, f)[k] * (*x)[k];
        if (value > 0) piece.support[above] |= line.bit;
        if (value < 0) piece.support[below] |= line.bit;
      }
    };
    mark(line.from_lower, 0, 0);
    mark(line.to_upper, 1, 1);
    mark(line.w, 2, 3);
  }
  return seen_.insert(piece.support).second && found_(piece);
}

}  // namespace orthant::cell_walk
