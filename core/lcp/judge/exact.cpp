#include <orthant/core/lcp/judge/exact.h>

#include <algorithm>
#include <utility>

namespace orthant::exact {

namespace {

struct Ray {
  Row x;
  std::vector<char> zero;  // per row of G so far: G x = 0 there
};

Rational dot(const Row& a, const Row& b) {
  Rational sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    if (!a[i].is_zero() && !b[i].is_zero()) sum += a[i] * b[i];
  return sum;
}

// Keeps the numbers short: a ray's length has no meaning.
void shorten(Row& x) {
  Rational largest = 0;
  for (const Rational& entry : x) largest = std::max(largest, Rational(abs(entry)));
  if (largest.is_zero()) return;
  for (Rational& entry : x) entry /= largest;
}

// One more inequality g x ≥ 0: rays beyond it go, and each edge it cuts leaves a ray in it. False: stopped.
bool cut(std::vector<Ray>& rays, const Row& g, std::size_t dimension, const std::function<bool()>& stop) {
  std::vector<Rational> value;
  std::vector<Ray> kept;
  for (Ray& ray : rays) {
    value.push_back(dot(g, ray.x));
    ray.zero.push_back(value.back().is_zero());
  }
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (stop && stop()) return false;
    for (std::size_t j = 0; j < rays.size(); ++j) {
      if (!(value[i] > 0 && value[j] < 0)) continue;
      std::vector<char> common(rays[i].zero);
      std::size_t count = 0;
      for (std::size_t k = 0; k < common.size(); ++k)
        if ((common[k] = static_cast<char>(common[k] != 0 && rays[j].zero[k] != 0)) != 0) ++count;
      if (count + 2 < dimension) continue;
      bool edge = true;  // no third ray lies in all the faces that these two share
      for (std::size_t r = 0; edge && r < rays.size(); ++r) {
        if (r == i || r == j) continue;
        bool shares = true;
        for (std::size_t k = 0; shares && k < common.size(); ++k) shares = common[k] == 0 || rays[r].zero[k] != 0;
        edge = !shares;
      }
      if (!edge) continue;
      Ray between{rays[i].x, common};
      for (std::size_t k = 0; k < between.x.size(); ++k)
        between.x[k] = value[i] * rays[j].x[k] - value[j] * rays[i].x[k];
      between.zero.back() = 1;
      shorten(between.x);
      kept.push_back(std::move(between));
    }
  }
  for (std::size_t i = 0; i < rays.size(); ++i)
    if (value[i] >= 0) kept.push_back(std::move(rays[i]));
  rays = std::move(kept);
  return true;
}

}  // namespace

double nearest(const Rational& x) {
  const auto d = x.convert_to<double>();  // cut off, not rounded
  if (!std::isfinite(d)) return d;
  const double next = std::nextafter(d, x.sign() < 0 ? -kInf : kInf);
  if (!std::isfinite(next)) return d;
  const Rational below = abs(x - Rational(d)), above = abs(Rational(next) - x);
  return above < below ? next : d;
}

Table table(const Matrix& A) {
  const Index n = order(A);
  Table rows(at(n), Row(at(n)));
  if (for_each_entry(A, [&rows](Index i, Index j, double a) { rows[at(i)][at(j)] = a; })) return rows;
  const auto& [W, inverse_mass, regularization] = std::get<Delassus>(A);
  Table full(at(W.rows), Row(at(W.cols)));
  for (Index i = 0; i < W.rows; ++i) W.for_each_in_row(i, [&](Index k, double w) { full[at(i)][at(k)] += w; });
  for (Index i = 0; i < n; ++i) {
    for (Index k = 0; k < W.cols; ++k) {
      const Rational& left = full[at(i)][at(k)];
      if (left.is_zero()) continue;
      const Rational share = left * inverse_mass[k];
      for (Index j = 0; j < n; ++j)
        if (!full[at(j)][at(k)].is_zero()) rows[at(i)][at(j)] += share * full[at(j)][at(k)];
    }
    if (regularization.size() != 0) rows[at(i)][at(i)] += regularization[i];
  }
  return rows;
}

std::vector<std::size_t> reduce(Table& rows, std::size_t columns) {
  std::vector<std::size_t> pivots;
  for (std::size_t c = 0; c < columns && pivots.size() < rows.size(); ++c) {
    const std::size_t k = pivots.size();
    std::size_t r = k;
    while (r < rows.size() && rows[r][c].is_zero()) ++r;
    if (r == rows.size()) continue;
    std::swap(rows[k], rows[r]);
    const Rational pivot = rows[k][c];
    for (Rational& entry : rows[k]) entry /= pivot;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (i == k || rows[i][c].is_zero()) continue;
      const Rational factor = rows[i][c];
      for (std::size_t j = c; j < rows[i].size(); ++j) subtract_product(rows[i][j], factor, rows[k][j]);
    }
    pivots.push_back(c);
  }
  return pivots;
}

Cone cone(const Table& G, std::size_t dimension, const std::function<bool()>& stop) {
  Cone result;
  Table reduced = G;
  const auto columns = reduce(reduced, dimension);
  const std::size_t rank = columns.size();
  for (std::size_t c = 0, k = 0; c < dimension; ++c) {
    if (k < rank && columns[k] == c) {
      ++k;
      continue;
    }
    Row line(dimension);
    line[c] = 1;
    for (std::size_t i = 0; i < rank; ++i) line[columns[i]] = -reduced[i][c];
    result.lines.push_back(std::move(line));
  }
  if (rank == 0) return result;

  // Without the lines' coordinates the cone is pointed. `rank` independent inequalities make a simplicial cone, whose
  // rays are the columns of the inverse; the others cut it, one by one.
  Table transposed(rank, Row(G.size()));
  for (std::size_t i = 0; i < G.size(); ++i)
    for (std::size_t k = 0; k < rank; ++k) transposed[k][i] = G[i][columns[k]];
  const auto restricted = [&](std::size_t i) {
    Row g(rank);
    for (std::size_t k = 0; k < rank; ++k) g[k] = G[i][columns[k]];
    return g;
  };
  const auto first = reduce(transposed, G.size());
  Table inverse;
  for (std::size_t k = 0; k < rank; ++k) {
    inverse.push_back(restricted(first[k]));
    inverse.back().resize(2 * rank);
    inverse.back()[rank + k] = 1;
  }
  reduce(inverse, rank);
  std::vector<Ray> rays(rank);
  for (std::size_t k = 0; k < rank; ++k) {
    for (std::size_t i = 0; i < rank; ++i) rays[k].x.push_back(inverse[i][rank + k]);
    rays[k].zero.assign(rank, 1);
    rays[k].zero[k] = 0;
  }
  for (std::size_t i = 0; i < G.size(); ++i)
    if (std::find(first.begin(), first.end(), i) == first.end() && !cut(rays, restricted(i), rank, stop)) return {};
  for (const Ray& ray : rays) {
    Row x(dimension);
    for (std::size_t k = 0; k < rank; ++k) x[columns[k]] = ray.x[k];
    result.rays.push_back(std::move(x));
  }
  return result;
}

}  // namespace orthant::exact
