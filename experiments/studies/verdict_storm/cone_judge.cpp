#include "experiments/studies/verdict_storm/cone_judge.h"

#include <orthant/core/support/options.h>

#include <boost/multiprecision/gmp.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace orthant {
namespace {

namespace mp = boost::multiprecision;
using Digits = mp::number<mp::gmp_float<60>, mp::et_off>;

constexpr double kConeEpsilon = 0x1p-52;

struct ConeEntry {
  Index column;
  Digits value, size;
};

std::vector<std::vector<ConeEntry>> entries_of(const Lcp& p) {
  std::vector<std::vector<ConeEntry>> rows(at(p.size()));
  const auto put = [&](Index i, Index j, double a) {
    if (a != 0) rows[at(i)].push_back({j, Digits(a), abs(Digits(a))});
  };
  if (const auto* dense = std::get_if<DenseMatrix>(&p.A)) {
    for (Index i = 0; i < p.size(); ++i)
      for (Index j = 0; j < p.size(); ++j) put(i, j, (*dense)(i, j));
  } else if (const auto* sparse = std::get_if<RowSparse>(&p.A)) {
    for (Index i = 0; i < p.size(); ++i)
      for (int k = sparse->start[at(i)]; k < sparse->start[at(i) + 1]; ++k)
        put(i, sparse->column[at(k)], sparse->value[at(k)]);
  } else {
    const auto& [W, inverse_mass, regularization] = std::get<Delassus>(p.A);
    std::vector<std::vector<Digits>> factor(at(W.rows), std::vector<Digits>(at(W.cols), Digits(0)));
    for (Index i = 0; i < W.rows; ++i)
      for (int k = W.start[at(i)]; k < W.start[at(i) + 1]; ++k)
        factor[at(i)][at(W.column[at(k)])] += Digits(W.value[at(k)]);
    for (Index i = 0; i < W.rows; ++i)
      for (Index j = 0; j < W.rows; ++j) {
        Digits sum(i == j && regularization.size() != 0 ? regularization[i] : 0.0), size = sum;
        for (Index k = 0; k < W.cols; ++k) {
          if (factor[at(i)][at(k)] == 0 || factor[at(j)][at(k)] == 0) continue;
          const Digits term = factor[at(i)][at(k)] * factor[at(j)][at(k)] * Digits(inverse_mass[k]);
          sum += term, size += abs(term);
        }
        if (size != 0) rows[at(i)].push_back({j, sum, size});
      }
  }
  return rows;
}

struct ConeContact {
  Index normal;
  std::vector<const Friction*> parts;
};

}  // namespace

Finding examine_cones(const Lcp& p, const Vector& z, double tolerance, Status claimed) {
  if (z.size() != p.size() || !z.allFinite()) return {.why = "z is not finite, or of another size"};
  if (claimed != Status::solved && claimed != Status::rounded) return {.why = "no answer is claimed"};
  const Index n = p.size();
  const auto rows = entries_of(p);
  std::vector<char> tangential(at(n), 0);
  std::vector<std::vector<const Friction*>> parts(at(n));
  for (const Friction& f : p.friction) {
    parts[at(f.normal)].push_back(&f);
    for (Index r = 0; r < f.rows; ++r) tangential[at(f.first + r)] = 1;
  }
  std::vector<double> diagonal(at(n), 0);
  for (Index i = 0; i < n; ++i)
    for (const ConeEntry& e : rows[at(i)])
      if (e.column == i) diagonal[at(i)] = std::abs(static_cast<double>(e.value));
  double largest = 0;
  for (const double a : diagonal)
    if (a < kInf) largest = std::max(largest, std::abs(a));
  std::vector<Digits> d(at(n));
  std::vector<Index> head(at(n));  // the normal of each row's contact
  const auto unit = [&](double sum, double count) {
    const double mean = sum / count;
    return Digits(1) / sqrt(Digits(mean > 0 && mean < kInf ? mean : largest > 0 ? largest : 1.0));
  };
  for (Index i = 0; i < n; ++i) {
    if (tangential[at(i)] != 0) continue;
    head[at(i)] = i;
    double sum = diagonal[at(i)], count = 1;
    for (std::size_t k = 0; k < parts[at(i)].size(); ++k) {
      const Friction& f = *parts[at(i)][k];
      double own = 0;
      for (Index r = 0; r < f.rows; ++r) own += diagonal[at(f.first + r)], head[at(f.first + r)] = i;
      if (k == 0)
        sum += own, count += static_cast<double>(f.rows);
      else
        for (Index r = 0; r < f.rows; ++r) d[at(f.first + r)] = unit(own, static_cast<double>(f.rows));
    }
    d[at(i)] = unit(sum, count);
    if (!parts[at(i)].empty())
      for (Index r = 0; r < parts[at(i)][0]->rows; ++r) d[at(parts[at(i)][0]->first + r)] = d[at(i)];
  }
  // w', the terms it is the sum of, data brought in by bounds; parts of contacts that A couples.
  std::vector<Digits> w(at(n)), terms(at(n)), data(at(n)), widest(at(n));
  std::vector<Index> part(head);
  for (bool changed = true; changed;) {
    changed = false;
    const auto join = [&](Index i, Index j) {
      const Index least = std::min(part[at(i)], part[at(j)]);
      changed = changed || part[at(i)] != least || part[at(j)] != least;
      part[at(i)] = part[at(j)] = least;
    };
    for (Index i = 0; i < n; ++i) {
      join(i, head[at(i)]);
      for (const ConeEntry& e : rows[at(i)]) join(i, e.column);
    }
  }
  std::vector<Digits> most(at(n), Digits(0));
  for (Index i = 0; i < n; ++i) {
    Digits& of_part = most[at(part[at(i)])];
    of_part = std::max(of_part, Digits(abs(Digits(z[i])) / d[at(i)]));
  }
  for (Index i = 0; i < n; ++i) {
    Digits sum(p.b[i]), size = abs(sum), given = size, wide = size;
    for (const ConeEntry& e : rows[at(i)]) {
      const Index j = e.column;
      const double lo = p.lo[j], hi = p.hi[j];
      const double bound = (z[j] == lo || z[j] == hi) ? z[j] : lo > 0 ? lo : hi < 0 ? hi : 0;
      sum += e.value * Digits(z[j]), size += e.size * abs(Digits(z[j]));
      given += e.size * Digits(std::abs(bound)), wide += e.size * most[at(part[at(j)])] * d[at(j)];
    }
    w[at(i)] = sum * d[at(i)], terms[at(i)] = size * d[at(i)];
    data[at(i)] = given * d[at(i)], widest[at(i)] = wide * d[at(i)];
  }
  const auto norm = [&](Index normal, const std::vector<Digits>& of) {
    Digits sum = of[at(normal)] * of[at(normal)];
    for (const Friction* f : parts[at(normal)])
      for (Index r = f->first; r < f->first + f->rows; ++r) sum += of[at(r)] * of[at(r)];
    return Digits(sqrt(sum));
  };
  std::vector<Digits> beta(at(n), Digits(0));
  for (Index i = 0; i < n; ++i)
    if (tangential[at(i)] == 0) beta[at(part[at(i)])] = std::max(beta[at(part[at(i)])], norm(i, data));
  Finding finding;
  finding.error = 0;
  for (Index i = 0; i < n; ++i) {
    if (tangential[at(i)] != 0) continue;
    // x = z' − û'; the nearest point's normal part a: φ'(a) = a − x_n − Σ μ (‖x_T‖ − μ a)₊ = 0.
    struct Slope {
      Digits mu, length;
    };
    std::vector<Slope> slopes;
    Digits x = Digits(z[i]) / d[at(i)] - w[at(i)];
    for (const Friction* f : parts[at(i)]) {
      const Digits mu = Digits(f->mu) * d[at(i)] / d[at(f->first)];
      Digits slip(0), length(0);
      for (Index r = f->first; r < f->first + f->rows; ++r) {
        const Digits t = Digits(z[r]) / d[at(r)] - w[at(r)];
        slip += w[at(r)] * w[at(r)], length += t * t;
      }
      x -= mu * sqrt(slip);
      slopes.push_back({mu, sqrt(length)});
    }
    std::vector<std::size_t> order(slopes.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t k, std::size_t l) {
      return slopes[k].length * slopes[l].mu > slopes[l].length * slopes[k].mu;
    });
    Digits top = x, below(1), a = x;
    for (const std::size_t k : order) {  // the next kink is at length / μ
      if (!(slopes[k].length > slopes[k].mu * std::max(a, Digits(0)))) break;
      top += slopes[k].mu * slopes[k].length, below += slopes[k].mu * slopes[k].mu;
      a = top / below;
    }
    if (p.lo[i] > -kInf) a = std::max(a, Digits(p.lo[i]) / d[at(i)]);
    if (p.hi[i] < kInf) a = std::min(a, Digits(p.hi[i]) / d[at(i)]);
    Digits missed = (Digits(z[i]) / d[at(i)] - a) * (Digits(z[i]) / d[at(i)] - a);
    for (std::size_t k = 0; k < slopes.size(); ++k) {
      const Friction& f = *parts[at(i)][k];
      const Digits radius = slopes[k].mu * std::max(a, Digits(0));
      const Digits share = slopes[k].length > radius ? Digits(radius / slopes[k].length) : Digits(1);
      for (Index r = f.first; r < f.first + f.rows; ++r) {
        const Digits off = Digits(z[r]) / d[at(r)] - share * (Digits(z[r]) / d[at(r)] - w[at(r)]);
        missed += off * off;
      }
    }
    const Digits e = sqrt(missed), &scale = beta[at(part[at(i)])], own = std::min(scale, norm(i, terms));
    const Digits noise = Digits(kConeEpsilon) * norm(i, widest);
    if (own > 0) finding.error = std::max(finding.error, static_cast<double>(e / own));
    const auto says = [&](const char* what) {
      finding.why = "contact of row " + std::to_string(i) + ": " + what + ", e " +
                    detail::text_of(static_cast<double>(e)) + ", allowed " +
                    detail::text_of(tolerance * static_cast<double>(own)) + ", noise " +
                    detail::text_of(static_cast<double>(noise));
      return finding;
    };
    // A millionth more than the judge allows, as it works in long double.
    if (noise > Digits(1e-6 * (1 + 1e-6)) * scale) return says("a runaway");
    if (e <= Digits(tolerance * (1 + 1e-6)) * own + Digits(1e-3) * noise) continue;
    if (claimed == Status::rounded && e <= Digits(20 * (1 + 1e-6)) * noise) continue;
    return says("violated");
  }
  finding.holds = true;
  return finding;
}

}  // namespace orthant
