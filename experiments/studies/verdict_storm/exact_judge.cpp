#include "experiments/studies/verdict_storm/exact_judge.h"

#include "experiments/studies/verdict_storm/cone_judge.h"
#include "experiments/studies/verdict_storm/entries_as.h"

#include <orthant/core/support/options.h>

#include <boost/multiprecision/gmp.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace orthant {
namespace {

namespace mp = boost::multiprecision;
using Rational = mp::number<mp::gmp_rational, mp::et_off>;

constexpr double kEpsilon = 0x1p-52;

/// The problem in numbers T, A as rows without its zeros; the operator is formed, with the size that its terms have.
template <class T> struct Copy {
  struct Entry {
    Index column;
    T value, size;
  };
  std::vector<std::vector<Entry>> rows;
  std::vector<T> b;

  explicit Copy(const Lcp& p) : rows(at(p.size())) {
    for (const double value : p.b) b.emplace_back(value);
    for_each_entry_as<T>(p.A, [&](Index i, Index j, const T& value, const T& size) {
      rows[at(i)].push_back({j, value, size});
    });
  }
};

double near_zero(double lo, double hi) { return lo > 0 ? lo : hi < 0 ? hi : 0; }

template <class T> T least_of(const T& a, const T& b) { return a < b ? a : b; }
template <class T> T most_of(const T& a, const T& b) { return a < b ? b : a; }
/// ‖x_T‖; of a disc to 100 digits, exact where it is a double.
Rational length(const std::vector<Rational>& x, const Friction& f) {
  if (f.rows == 1) return abs(x[at(f.first)]);
  using Float100 = mp::number<mp::gmp_float<100>, mp::et_off>;
  const Rational square = x[at(f.first)] * x[at(f.first)] + x[at(f.first + 1)] * x[at(f.first + 1)];
  const Float100 root = sqrt(Float100(square));
  const Rational rounded(static_cast<double>(root));
  return rounded * rounded == square ? rounded : Rational(root);
}

std::string row_says(Index i, const char* what, double value) {
  return "row " + std::to_string(i) + ": " + what + " = " + detail::text_of(value);
}

}  // namespace

Finding examine_solution(const Lcp& p, const Vector& z, double tolerance, Status claimed) {
  if (p.discs()) return examine_cones(p, z, tolerance, claimed);
  if (z.size() != p.size() || !z.allFinite()) return {.why = "z is not finite, or of another size"};
  if (claimed != Status::solved && claimed != Status::rounded) return {.why = "no answer is claimed"};
  const Copy<Rational> copy(p);
  const Index n = p.size();
  std::vector<const Friction*> friction(at(n), nullptr);
  for (const Friction& f : p.friction) friction[at(f.first)] = &f;
  std::vector<Rational> w(copy.b), size, data, entries(at(n));
  for (Index i = 0; i < n; ++i) {
    Rational sum = abs(copy.b[at(i)]), given = sum;
    for (const auto& [j, a, of_a] : copy.rows[at(i)]) {
      const double bound = (z[j] == p.lo[j] || z[j] == p.hi[j]) ? z[j] : near_zero(p.lo[j], p.hi[j]);
      w[at(i)] += a * Rational(z[j]);
      sum += of_a * abs(Rational(z[j]));
      given += of_a * abs(Rational(bound));
      entries[at(i)] += of_a;
    }
    size.push_back(sum), data.push_back(given);
  }
  for (bool changed = true; changed;) {  // few rows: the simplest way there is
    changed = false;
    const auto raise = [&](Index i, const Rational& by) {
      if (by > data[at(i)]) data[at(i)] = by, changed = true;
    };
    for (Index i = 0; i < n; ++i)
      for (const auto& [j, a, of_a] : copy.rows[at(i)])
        raise(i, least_of<Rational>(of_a * abs(Rational(z[j])), data[at(j)]));
    for (const Friction& f : p.friction) raise(f.first, data[at(f.normal)]);
  }
  Finding finding;
  finding.error = 0;
  for (Index i = 0; i < n; ++i) {
    double lo = p.lo[i], hi = p.hi[i];
    if (const Friction* f = friction[at(i)]) hi = f->mu * std::max(z[f->normal], 0.0), lo = -hi;
    if (z[i] < lo || z[i] > hi) {
      finding.why = row_says(i, "outside its bounds, z", z[i]);
      return finding;
    }
    const Rational& sum = w[at(i)];
    const Rational v = lo == hi     ? Rational(0)
                       : z[i] == lo ? most_of<Rational>(0, -sum)
                       : z[i] == hi ? most_of<Rational>(0, sum)
                                    : Rational(abs(sum));
    const Rational& beta = data[at(i)];
    if (beta > 0) finding.error = std::max(finding.error, static_cast<double>(v / beta));
    const Rational solved = Rational(tolerance) * least_of(size[at(i)], beta);
    const Rational rounded = Rational(20 * kEpsilon) * size[at(i)],
                   least =
                       Rational(20 * kEpsilon) * Rational(std::numeric_limits<double>::min()) * (1 + entries[at(i)]);
    if (v <= solved || (claimed == Status::rounded && (v <= rounded || v <= least))) continue;
    finding.why = row_says(i, "violation", static_cast<double>(v)) + ", " +
                  row_says(i, "limit", static_cast<double>(claimed == Status::solved ? solved : rounded));
    return finding;
  }
  finding.holds = true;
  return finding;
}

namespace {

/// û: u, or what u is nearest to (judge/exact_proof.h).
class ProofExam {
 public:
  ProofExam(const Lcp& p, const Vector& u) : p_(p), copy_(p), friction_(at(p.size()), 0), u_(at(p.size())) {
    for (Index i = 0; i < p.size(); ++i)
      if (u_[at(i)] = Rational(u[i]); u[i] != 0) support_.push_back(at(i));
    std::stable_sort(support_.begin(), support_.end(),
                     [&](auto i, auto j) { return std::abs(u[Index(i)]) > std::abs(u[Index(j)]); });
    for (const Friction& f : p.friction)
      for (Index r = 0; r < f.rows; ++r) friction_[at(f.first + r)] = 1;
  }

  /// Empty when it proves.
  std::string run(bool all) {
    x_ = u_, equations_.clear();
    for (int round = 0; round < 8; ++round) {
      sums();
      double worst = 0;
      for (Index j = 0; j < p_.size(); ++j)
        if (wrong(j)) worst = std::max(worst, static_cast<double>(abs(c_[at(j)]) / terms_[at(j)]));
      if (worst == 0) {
        const Rational value = most();
        if (value < 0) return {};
        return "the largest u'w is " + detail::text_of(static_cast<double>(value)) + ", not below 0";
      }
      if (!add_equations(all && round == 0) || !eliminate()) return "g misses its sign by " + detail::text_of(worst);
    }
    return "g misses its sign";
  }
  double margin() const {
    Rational terms(0);
    for (const auto i : support_) terms += abs(x_[i] * copy_.b[i]);
    return terms == 0 ? kInf : static_cast<double>(-most() / terms);
  }
  /// The largest change of an entry of u over the largest entry.
  double change() const {
    Rational largest(0), off(0);
    for (const auto i : support_)
      largest = most_of<Rational>(largest, abs(u_[i])), off = most_of<Rational>(off, abs(x_[i] - u_[i]));
    return largest == 0 ? 0 : static_cast<double>(off / largest);
  }

 private:
  bool near_zero(Index j) const { return abs(c_[at(j)]) <= Rational(0x1p-30) * terms_[at(j)]; }
  bool wrong(Index j) const {
    return friction_[at(j)] == 0 && ((p_.hi[j] == kInf && c_[at(j)] > 0) || (p_.lo[j] == -kInf && c_[at(j)] < 0));
  }

  void sums() {
    g_.assign(x_.size(), Rational(0)), terms_ = g_;
    for (const auto i : support_)
      for (const auto& [j, a, of_a] : copy_.rows[i]) {
        g_[at(j)] += x_[i] * a;
        terms_[at(j)] += abs(x_[i]) * of_a;
      }
    c_ = g_;
    for (const Friction& f : p_.friction) {
      c_[at(f.normal)] += Rational(f.mu) * length(g_, f);
      for (Index r = 0; r < f.rows; ++r) terms_[at(f.normal)] += Rational(f.mu) * terms_[at(f.first + r)];
    }
  }

  Rational most() const {
    Rational value(0);
    for (const auto i : support_) value += x_[i] * copy_.b[i];
    for (Index j = 0; j < p_.size(); ++j) {
      const double bound = c_[at(j)] > 0 ? p_.hi[j] : p_.lo[j];
      if (friction_[at(j)] == 0 && c_[at(j)] != 0) value += c_[at(j)] * Rational(bound);
    }
    return value;
  }

  // Over all rows; of column j, with the friction that pushes it.
  std::vector<Rational> column(Index j) const {
    std::vector<Rational> result(x_.size(), Rational(0));
    for (const auto i : support_)
      for (const auto& [k, a, of_a] : copy_.rows[i])
        if (k == j) result[i] += a;
    return result;
  }

  bool add_equations(bool all) {
    const std::size_t before = equations_.size();
    for (Index j = 0; j < p_.size(); ++j) {
      if (friction_[at(j)] != 0 || terms_[at(j)] == 0) continue;
      const bool open = p_.hi[j] == kInf || p_.lo[j] == -kInf;
      if (wrong(j) && !near_zero(j)) return false;
      if (!wrong(j) && !(all && open && near_zero(j))) continue;
      std::vector<Rational> equation = column(j);
      for (const Friction& f : p_.friction) {
        if (f.normal != j || f.mu == 0) continue;
        bool still = true;
        for (Index t = f.first; t < f.first + f.rows; ++t)
          still = still && abs(g_[at(t)]) <= Rational(0x1p-30) * terms_[at(t)];
        for (Index t = f.first; still && t < f.first + f.rows; ++t) equations_.push_back(column(t));
        if (still) continue;
        if (f.rows > 1) return false;
        const Rational push(g_[at(f.first)] > 0 ? f.mu : -f.mu);
        const std::vector<Rational> along = column(f.first);
        for (std::size_t i = 0; i < along.size(); ++i) equation[i] += push * along[i];
      }
      equations_.push_back(std::move(equation));
    }
    return equations_.size() > before;
  }

  bool eliminate() {
    auto rows = equations_;
    std::vector<std::size_t> pivots;
    for (const auto c : support_) {
      const auto found = std::find_if(rows.begin() + static_cast<std::ptrdiff_t>(pivots.size()), rows.end(),
                                      [c](const auto& row) { return row[c] != 0; });
      if (found == rows.end()) continue;
      auto& pivot = rows[pivots.size()];
      std::swap(pivot, *found);
      const Rational unit = pivot[c];
      for (const auto k : support_) pivot[k] /= unit;
      for (auto& row : rows) {
        if (&row == &pivot || row[c] == 0) continue;
        const Rational factor = row[c];
        for (const auto k : support_) row[k] -= factor * pivot[k];
      }
      pivots.push_back(c);
    }
    if (pivots.size() == support_.size()) return false;
    x_ = u_;
    for (const auto c : pivots) x_[c] = 0;
    std::vector<Rational> solved;
    for (std::size_t r = 0; r < pivots.size(); ++r) {
      solved.emplace_back(0);
      for (const auto k : support_) solved.back() -= rows[r][k] * x_[k];
    }
    for (std::size_t r = 0; r < pivots.size(); ++r) {
      x_[pivots[r]] = solved[r];
      const auto i = static_cast<Index>(pivots[r]);
      if ((solved[r] < 0 && p_.lo[i] > -kInf) || (solved[r] > 0 && p_.hi[i] < kInf)) return false;
    }
    return true;
  }

  const Lcp& p_;
  const Copy<Rational> copy_;
  std::vector<char> friction_;
  std::vector<Rational> u_, x_, g_, c_, terms_;
  std::vector<std::size_t> support_;
  std::vector<std::vector<Rational>> equations_;
};

}  // namespace

Finding examine_proof(const Lcp& p, const Vector& u) {
  Finding finding;
  const auto refuse = [&](std::string why) {
    finding.why = std::move(why);
    return finding;
  };
  if (u.size() != p.size() || !u.allFinite()) return refuse("u is not finite, or of another size");
  std::vector<char> friction(at(p.size()));
  for (const Friction& f : p.friction)
    for (Index r = 0; r < f.rows; ++r) friction[at(f.first + r)] = 1;
  for (Index i = 0; i < p.size(); ++i) {
    if (u[i] == 0) continue;
    const bool below = p.lo[i] > -kInf, above = p.hi[i] < kInf;
    if (friction[at(i)] != 0 || (below && above)) return refuse(row_says(i, "w has either sign, but u", u[i]));
    if ((below && u[i] < 0) || (above && u[i] > 0)) return refuse(row_says(i, "wrong sign of u", u[i]));
  }
  ProofExam exam(p, u);
  for (const bool all : {true, false}) {
    finding.why = exam.run(all);
    finding.holds = finding.why.empty();
    finding.error = exam.change();
    if (!finding.holds) continue;
    finding.margin = exam.margin();
    break;
  }
  return finding;
}

}  // namespace orthant
