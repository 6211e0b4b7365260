#include <orthant/solvers/pivoting/dantzig.h>

#include <orthant/solvers/pivoting/principal_pivoting.h>

#include <vector>

namespace orthant {

namespace {

std::size_t u(int i) { return static_cast<std::size_t>(i); }

// What ends a step of the drive of row r.
template <class T> struct Block {
  enum class Kind { none, right, bound, pair } kind = Kind::none;
  T length = 0;
  int row = -1;  // of a pair
  T value = 0;   // at which its basic variable ends
};

}  // namespace

struct Dantzig::Work {
  detail::PrincipalPivoting pivoting;
  Vector direction;
  std::vector<char> put_off;
  int precision = 0;

  template <class T> using Tableau = detail::PrincipalTableau<T>;

  template <class T> static Block<T> ratio_test(const Tableau<T>& t, int r, T sense, bool least_index) {
    using Kind = typename Block<T>::Kind;
    const auto abs = [](T x) { return detail::magnitude(x); };
    T largest = 0;
    for (int i = 0; i < t.size(); ++i) largest = std::max(largest, abs(t.at(i, r)));
    const T tiny = largest * detail::Roundings<T>::pivot;
    Block<T> best;
    T blur = 0, entry = 0;  // of the best: how far its length is known, and its entry of the tableau
    const auto offer = [&](Kind kind, T distance, T noise, T rate, int row, T value) {
      const T length = std::max(distance, T(0)) / rate, unsure = noise / rate;
      if (best.kind != Kind::none && length - unsure > best.length + blur) return;
      const bool tie = best.kind != Kind::none && length + unsure >= best.length - blur;
      if (tie && (best.kind != Kind::pair || (kind == Kind::pair && (least_index || rate <= entry)))) return;
      best = {kind, length, row, value}, blur = unsure, entry = rate;
    };
    const bool driven_w = t.in[u(r)];
    if (driven_w) {
      offer(Kind::right, abs(t.w[u(r)]), T(0), T(1), r, T(0));
    } else {
      const T to_bound = sense > 0 ? t.high[u(r)] - t.z[u(r)] : t.z[u(r)] - t.low[u(r)];
      if (t.at(r, r) > tiny) offer(Kind::right, abs(t.w[u(r)]), t.noise(r), t.at(r, r), r, T(0));
      if (to_bound < T(kInf)) offer(Kind::bound, to_bound, T(0), T(1), r, T(0));
    }
    for (int i = 0; i < t.size(); ++i) {
      const T rate = t.at(i, r) * sense, size = abs(rate);
      if (!(size > tiny) || (i == r && !driven_w)) continue;
      if (t.in[u(i)]) {
        const T z = t.z[u(i)], bound = rate < 0 ? t.low[u(i)] : t.high[u(i)];
        if (abs(bound) < T(kInf))
          offer(Kind::pair, rate < 0 ? z - bound : bound - z, detail::Roundings<T>::snap * std::max(abs(bound), abs(z)),
                size, i, bound);
        continue;
      }
      if (t.low[u(i)] == t.high[u(i)]) continue;
      const T w = t.w[u(i)];
      const bool wrong = t.wrong(i);
      if (t.loose(i)) {  // it must not pass 0
        if (!wrong || w * rate < 0) offer(Kind::pair, wrong ? abs(w) : T(0), t.noise(i), size, i, T(0));
      } else if (!wrong && (t.z[u(i)] == t.low[u(i)]) == (rate < 0)) {
        offer(Kind::pair, rate < 0 ? w : -w, t.noise(i), size, i, T(0));
      }
    }
    return best;
  }

  // Moves row r's driving variable until the row is right. False: it does not come to that, and `end` says why.
  template <class T> bool drive(Dantzig& solver, Tableau<T>& t, int r, int limit, Claim& end) {
    using Kind = typename Block<T>::Kind;
    int idle = 0;  // steps of length 0
    while (t.wrong(r)) {
      const T sense = t.w[u(r)] < 0 ? T(1) : T(-1);
      const Block<T> block = ratio_test(t, r, sense, idle > t.size());
      end = Claim::ray;
      if (block.kind == Kind::none) return false;
      idle = block.length > 0 ? 0 : idle + 1;
      const bool moves_z = !t.in[u(r)];
      t.move(r, sense * block.length);
      if (block.kind == Kind::bound) {
        t.z[u(r)] = sense > 0 ? t.high[u(r)] : t.low[u(r)];
        return true;
      }
      if (block.kind == Kind::right) {
        if (moves_z)
          t.pivot(r, T(0));
        else
          t.w[u(r)] = 0;
      } else {
        const int i = block.row;
        const T own = t.at(i, i), cross = t.at(i, r) * t.at(r, i);
        T largest = 0;
        for (int k = 0; k < t.size(); ++k) largest = std::max(largest, detail::magnitude(t.at(i, k)));
        end = Claim::stalled;
        if (own > largest * detail::Roundings<T>::pivot)
          t.pivot(i, block.value);
        else if (i != r && cross < 0)
          t.exchange(i, r, block.value);
        else
          return false;
      }
      solver.log(t.iterations, static_cast<double>(detail::magnitude(t.w[u(r)])), static_cast<double>(block.length));
      end = Claim::iteration_limit;
      if (t.iterations >= limit) return false;
      end = Claim::time_limit;
      if (solver.budget().exhausted()) return false;
    }
    return true;
  }

  template <class T> Claim method(Dantzig& solver, Tableau<T>& t, int limit, Solution& s) {
    put_off.assign(u(t.size()), 0);
    for (int drives = 0;; ++drives) {  // one that ends on a bound makes no pivot
      if (drives > limit) return Claim::iteration_limit;
      if (solver.budget().exhausted()) return Claim::time_limit;
      int r = -1, waiting = -1;
      bool free = false;  // free rows first: what they make basic never leaves
      for (int i = 0; i < t.size(); ++i) {
        if (!t.wrong(i)) continue;
        if (put_off[u(i)]) {
          waiting = i;
        } else if (r < 0 || (!free && t.free(i))) {
          r = i, free = t.free(i);
        }
      }
      if (r < 0 && waiting < 0) return Claim::candidate;
      if (r < 0) {
        ray(t, waiting, s);
        return Claim::ray;
      }
      Claim end = Claim::candidate;
      if (drive(solver, t, r, limit, end))
        put_off.assign(u(t.size()), 0);
      else if (end == Claim::ray)
        put_off[u(r)] = 1;
      else
        return end;
    }
  }

  template <class T> void ray(const Tableau<T>& t, int r, Solution& s) {
    direction.resize(t.size());
    direction.setZero();
    const double sense = t.w[u(r)] < 0 ? 1 : -1;
    if (!t.in[u(r)]) direction[r] = sense;
    for (int i = 0; i < t.size(); ++i)
      if (t.in[u(i)]) direction[i] = sense * static_cast<double>(t.at(i, r));
    pivoting.certificate(direction, s.ray);
  }

  Claim attempt(Dantzig& solver, Solution& s) {
    return pivoting.attempt(precision, s.z, s.iterations, [&](auto& t) {
      const int limit = solver.options_.max_pivots > 0 ? solver.options_.max_pivots : 20000 + 100 * t.size();
      return method(solver, t, limit, s);
    });
  }
};

Dantzig::Dantzig(const Options& options) : options_(options), work_(std::make_unique<Work>()) {}
Dantzig::~Dantzig() = default;

std::string Dantzig::why_not(const Lcp& problem) const { return detail::too_large(problem); }

Claim Dantzig::run(const Lcp& problem, Solution& s, Start) {
  if (problem.size() == 0) return Claim::candidate;
  work_->precision = 0;
  work_->pivoting.form(problem);
  return work_->attempt(*this, s);
}

bool Dantzig::run_again(const Lcp& problem, Solution& s, int, Claim& claim) {
  if (!options_.rescue || problem.size() == 0 || claim == Claim::iteration_limit) return false;
  if (++work_->precision > (problem.size() <= 100 ? 2 : 1)) return false;
  claim = work_->attempt(*this, s);
  return true;
}

}  // namespace orthant
