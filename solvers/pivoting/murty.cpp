#include <orthant/solvers/pivoting/murty.h>

namespace orthant {

std::string Murty::why_not(const Lcp& problem) const {
  if (!problem.friction.empty()) return "friction rows: the method needs bounds that do not depend on z";
  return detail::too_large(problem);
}

template <class T> Claim Murty::method(detail::PrincipalTableau<T>& t) {
  const auto u = [](int i) { return static_cast<std::size_t>(i); };
  // Basic variable i goes to `value`, carried there by the nonbasic one of its pair.
  const auto move = [&](int i, T value) {
    const T pivot = t.at(i, i);
    if (!(pivot > 0)) return false;
    t.move(i, (value - (t.in[u(i)] ? t.z : t.w)[u(i)]) / pivot);
    t.pivot(i, value);
    return true;
  };
  if (!t.release_free([this] { return budget().exhausted(); })) return Claim::stalled;
  t.iterations = 0;
  for (;;) {
    int i = 0;
    T bound = 0;  // where a basic z_i goes
    for (; i < t.size(); ++i) {
      if (!t.in[u(i)]) {
        if (t.wrong(i)) break;
        continue;
      }
      bound = t.z[u(i)] < t.low[u(i)] ? t.low[u(i)] : t.high[u(i)];
      if (t.outside(i)) break;
    }
    log(t.iterations, i);
    if (i == t.size()) return Claim::candidate;
    if (t.iterations >= options_.max_pivots) return Claim::iteration_limit;
    if (budget().exhausted()) return Claim::time_limit;
    if (!move(i, t.in[u(i)] ? bound : T(0))) return Claim::stalled;
  }
}

Claim Murty::attempt(int precision, Solution& s) {
  return pivoting_.attempt(precision, s.z, s.iterations, [this](auto& t) { return method(t); });
}

Claim Murty::run(const Lcp& problem, Solution& s, Start) {
  if (problem.size() == 0) return Claim::candidate;
  pivoting_.form(problem);
  return attempt(0, s);
}

bool Murty::run_again(const Lcp& problem, Solution& s, int precision, Claim& claim) {
  if (problem.size() == 0 || claim == Claim::iteration_limit || precision > (problem.size() <= 100 ? 2 : 1))
    return false;
  claim = attempt(precision, s);
  return true;
}

}  // namespace orthant
