#include "experiments/studies/verdict_storm/cone_judge.h"
#include "experiments/studies/verdict_storm/entries_as.h"

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
  for_each_entry_as<Digits>(p.A, [&](Index i, Index j, const Digits& value, const Digits& size) {
    rows[at(i)].push_back({j, value, size});
  });
  return rows;
}

/// The problem in the units of the judge: contacts by their normal rows, scales d, sums w' and their sizes.
class ConeRows {
 public:
  ConeRows(const Lcp& p, const Vector& z)
      : p_(p), z_(z), n_(p.size()), rows_(entries_of(p)), tangential_(at(n_), 0), parts_(at(n_)) {
    for (const Friction& f : p.friction) {
      parts_[at(f.normal)].push_back(&f);
      for (Index r = 0; r < f.rows; ++r) tangential_[at(f.first + r)] = 1;
    }
    set_scales();
    couple();
    sum();
  }

  bool normal(Index i) const { return tangential_[at(i)] == 0; }
  Digits error(Index i) const { return sqrt(missed(i)); }
  Digits scale(Index i) const { return beta_[at(part_[at(i)])]; }
  Digits terms(Index i) const { return norm(i, terms_); }
  Digits widest(Index i) const { return norm(i, widest_); }

 private:
  /// d: 1 / √(mean diagonal entry) of a contact's normal and first disc, of each further disc by itself.
  void set_scales() {
    std::vector<double> diagonal(at(n_), 0);
    for (Index i = 0; i < n_; ++i)
      for (const ConeEntry& e : rows_[at(i)])
        if (e.column == i) diagonal[at(i)] = std::abs(static_cast<double>(e.value));
    double largest = 0;
    for (const double a : diagonal)
      if (a < kInf) largest = std::max(largest, std::abs(a));
    d_.resize(at(n_)), head_.resize(at(n_));
    const auto unit = [&](double sum, double count) {
      const double mean = sum / count;
      return Digits(1) / sqrt(Digits(mean > 0 && mean < kInf ? mean : largest > 0 ? largest : 1.0));
    };
    for (Index i = 0; i < n_; ++i) {
      if (!normal(i)) continue;
      head_[at(i)] = i;
      double sum = diagonal[at(i)], count = 1;
      for (std::size_t k = 0; k < parts_[at(i)].size(); ++k) {
        const Friction& f = *parts_[at(i)][k];
        double own = 0;
        for (Index r = 0; r < f.rows; ++r) own += diagonal[at(f.first + r)], head_[at(f.first + r)] = i;
        if (k == 0)
          sum += own, count += static_cast<double>(f.rows);
        else
          for (Index r = 0; r < f.rows; ++r) d_[at(f.first + r)] = unit(own, static_cast<double>(f.rows));
      }
      d_[at(i)] = unit(sum, count);
      if (!parts_[at(i)].empty())
        for (Index r = 0; r < parts_[at(i)][0]->rows; ++r) d_[at(parts_[at(i)][0]->first + r)] = d_[at(i)];
    }
  }

  /// Parts of the problem that A couples, each named by its first row.
  void couple() {
    part_ = head_;
    for (bool changed = true; changed;) {
      changed = false;
      const auto join = [&](Index i, Index j) {
        const Index least = std::min(part_[at(i)], part_[at(j)]);
        changed = changed || part_[at(i)] != least || part_[at(j)] != least;
        part_[at(i)] = part_[at(j)] = least;
      };
      for (Index i = 0; i < n_; ++i) {
        join(i, head_[at(i)]);
        for (const ConeEntry& e : rows_[at(i)]) join(i, e.column);
      }
    }
  }

  /// w', the sum of its terms' sizes, that of the data brought in by bounds, and that at the largest z' of the part.
  void sum() {
    std::vector<Digits> most(at(n_), Digits(0)), data(at(n_));
    for (Index i = 0; i < n_; ++i) {
      Digits& of_part = most[at(part_[at(i)])];
      of_part = std::max(of_part, Digits(abs(Digits(z_[i])) / d_[at(i)]));
    }
    w_.resize(at(n_)), terms_.resize(at(n_)), widest_.resize(at(n_));
    for (Index i = 0; i < n_; ++i) {
      Digits sum(p_.b[i]), size = abs(sum), given = size, wide = size;
      for (const ConeEntry& e : rows_[at(i)]) {
        const Index j = e.column;
        const double lo = p_.lo[j], hi = p_.hi[j];
        const double bound = (z_[j] == lo || z_[j] == hi) ? z_[j] : lo > 0 ? lo : hi < 0 ? hi : 0;
        sum += e.value * Digits(z_[j]), size += e.size * abs(Digits(z_[j]));
        given += e.size * Digits(std::abs(bound)), wide += e.size * most[at(part_[at(j)])] * d_[at(j)];
      }
      w_[at(i)] = sum * d_[at(i)], terms_[at(i)] = size * d_[at(i)];
      data[at(i)] = given * d_[at(i)], widest_[at(i)] = wide * d_[at(i)];
    }
    beta_.assign(at(n_), Digits(0));
    for (Index i = 0; i < n_; ++i)
      if (normal(i)) beta_[at(part_[at(i)])] = std::max(beta_[at(part_[at(i)])], norm(i, data));
  }

  Digits norm(Index normal, const std::vector<Digits>& of) const {
    Digits sum = of[at(normal)] * of[at(normal)];
    for (const Friction* f : parts_[at(normal)])
      for (Index r = f->first; r < f->first + f->rows; ++r) sum += of[at(r)] * of[at(r)];
    return Digits(sqrt(sum));
  }

  /// ‖z' − nearest point of the cone to z' − û'‖² of the contact with normal row i.
  Digits missed(Index i) const {
    // x = z' − û'; the nearest point's normal part a: φ'(a) = a − x_n − Σ μ (‖x_T‖ − μ a)₊ = 0.
    struct Slope {
      Digits mu, length;
    };
    std::vector<Slope> slopes;
    Digits x = Digits(z_[i]) / d_[at(i)] - w_[at(i)];
    for (const Friction* f : parts_[at(i)]) {
      const Digits mu = Digits(f->mu) * d_[at(i)] / d_[at(f->first)];
      Digits slip(0), length(0);
      for (Index r = f->first; r < f->first + f->rows; ++r) {
        const Digits t = Digits(z_[r]) / d_[at(r)] - w_[at(r)];
        slip += w_[at(r)] * w_[at(r)], length += t * t;
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
    if (p_.lo[i] > -kInf) a = std::max(a, Digits(p_.lo[i]) / d_[at(i)]);
    if (p_.hi[i] < kInf) a = std::min(a, Digits(p_.hi[i]) / d_[at(i)]);
    Digits sum = (Digits(z_[i]) / d_[at(i)] - a) * (Digits(z_[i]) / d_[at(i)] - a);
    for (std::size_t k = 0; k < slopes.size(); ++k) {
      const Friction& f = *parts_[at(i)][k];
      const Digits radius = slopes[k].mu * std::max(a, Digits(0));
      const Digits share = slopes[k].length > radius ? Digits(radius / slopes[k].length) : Digits(1);
      for (Index r = f.first; r < f.first + f.rows; ++r) {
        const Digits off = Digits(z_[r]) / d_[at(r)] - share * (Digits(z_[r]) / d_[at(r)] - w_[at(r)]);
        sum += off * off;
      }
    }
    return sum;
  }

  const Lcp& p_;
  const Vector& z_;
  Index n_;
  std::vector<std::vector<ConeEntry>> rows_;
  std::vector<char> tangential_;
  std::vector<std::vector<const Friction*>> parts_;  // of a normal row
  std::vector<Index> head_, part_;                   // the normal of each row's contact
  std::vector<Digits> d_, w_, terms_, widest_, beta_;
};

}  // namespace

Finding examine_cones(const Lcp& p, const Vector& z, double tolerance, Status claimed) {
  if (z.size() != p.size() || !z.allFinite()) return {.why = "z is not finite, or of another size"};
  if (claimed != Status::solved && claimed != Status::rounded) return {.why = "no answer is claimed"};
  const ConeRows rows(p, z);
  Finding finding;
  finding.error = 0;
  for (Index i = 0; i < p.size(); ++i) {
    if (!rows.normal(i)) continue;
    const Digits e = rows.error(i), scale = rows.scale(i), own = std::min(scale, rows.terms(i));
    const Digits noise = Digits(kConeEpsilon) * rows.widest(i);
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
