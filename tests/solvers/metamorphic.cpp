// What must not depend on how a problem is put: the order of its rows, their units, their sign, the storage, a second
// copy beside it, the start, what was solved before. Every registered solver; the answer in the new words must be the
// old answer.
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <functional>
#include <map>

using namespace orthant;

namespace {

Lcp dense(const Lcp& p) {
  Lcp q = p;
  DenseMatrix A;
  to_dense(p.A, A);
  q.A = A;
  return q;
}

struct Retold {
  Lcp problem;
  std::function<Vector(const Vector&)> back;  // its z in the words of the first problem
};

/// Player 1's strategies of a game, whose rows may change places only among themselves; 0: no game.
Index players_cut(const Lcp& p) {
  const auto* A = std::get_if<DenseMatrix>(&p.A);
  if (A == nullptr || p.size() < 2 || (A->diagonal().array() != 0).any()) return 0;
  Index m = 0;
  while (m < p.size() && (*A)(0, m) == 0) ++m;
  return m;
}

Retold permuted(const Lcp& given, Random& random) {
  const Lcp p = dense(given);
  const Index n = p.size(), cut = players_cut(p);
  std::vector<Index> order;  // row i of the result is row order[i] of p
  for (Index i = 0; i < n; ++i) {
    const Index first = i < cut ? 0 : cut;
    order.insert(order.begin() + first + random.integer(0, static_cast<int>(i - first)), i);
  }
  std::vector<Index> place(at(n));
  for (Index i = 0; i < n; ++i) place[at(order[at(i)])] = i;
  Lcp q = p;
  q.A = DenseMatrix(Eigen::MatrixXd(std::get<DenseMatrix>(p.A)(order, order)));
  q.b = p.b(order), q.lo = p.lo(order), q.hi = p.hi(order);
  for (Friction& f : q.friction) f.first = place[at(f.first)], f.normal = place[at(f.normal)];
  return {q, [place](const Vector& z) { return Vector(z(place)); }};
}

/// diag(2^k) A diag(2^l): z is divided by 2^l. A contact's rows have one unit, or μ would have another.
Retold scaled(const Lcp& given, Random& random) {
  Lcp p = dense(given);
  auto& A = std::get<DenseMatrix>(p.A);
  const Index n = p.size();
  Vector row(Eigen::VectorXd::Zero(n)), col = row;
  for (double& d : row) d = std::ldexp(1.0, random.integer(-40, 40));
  for (double& d : col) d = std::ldexp(1.0, random.integer(-40, 40));
  for (const Friction& f : p.friction) row[f.first] = row[f.normal], col[f.first] = col[f.normal];
  A = Eigen::MatrixXd(row.asDiagonal() * A * col.asDiagonal());
  p.b.array() *= row.array(), p.lo.array() /= col.array(), p.hi.array() /= col.array();
  return {p, [col](const Vector& z) { return Vector(z.cwiseProduct(col)); }};
}

Retold twice(const Lcp& given, Random&) {
  const Lcp p = dense(given);
  const Index n = p.size();
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(2 * n, 2 * n);
  A.topLeftCorner(n, n) = A.bottomRightCorner(n, n) = std::get<DenseMatrix>(p.A);
  Lcp q = p;
  q.A = DenseMatrix(A);
  q.b = Eigen::VectorXd(p.b.replicate(2, 1)), q.lo = Eigen::VectorXd(p.lo.replicate(2, 1));
  q.hi = Eigen::VectorXd(p.hi.replicate(2, 1));
  for (const Friction& f : p.friction) q.friction.push_back({f.normal + n, f.first + n, f.rows, f.mu});
  return {q, [n](const Vector& z) { return Vector(2 * z.tail(n) - z.head(n)); }};  // what both say, where both agree
}

/// z and w change sign: [lo, hi] becomes [−hi, −lo]. Normals of contacts keep theirs, tangents turn.
Retold mirrored(const Lcp& given, Random&) {
  Lcp p = dense(given);
  Vector sign(Eigen::VectorXd::Constant(p.size(), -1));
  for (const Friction& f : p.friction) sign[f.normal] = 1;
  auto& A = std::get<DenseMatrix>(p.A);
  A = Eigen::MatrixXd(sign.asDiagonal() * A * sign.asDiagonal());
  p.b.array() *= sign.array();
  for (Index i = 0; i < p.size(); ++i)
    if (sign[i] < 0) p.lo[i] = -given.hi[i], p.hi[i] = -given.lo[i];
  return {p, [sign](const Vector& z) { return Vector(z.cwiseProduct(sign)); }};
}

Retold restored(const Lcp& p, Random&) {
  return {std::holds_alternative<DenseMatrix>(p.A) ? as_sparse(p) : dense(p), [](const Vector& z) { return z; }};
}

/// Every kind of row but friction, A symmetric positive definite.
Lcp mixed_problem(Index n, Random& random) {
  Lcp p = random_spd_problem(n, random);
  for (Index i = 0; i < n; ++i) {
    const int kind = random.integer(0, 4);
    if (kind == 1) p.lo[i] = -kInf;
    if (kind == 2) p.lo[i] = -0.1, p.hi[i] = 0.2;
    if (kind == 3) p.lo[i] = -kInf, p.hi[i] = 0.1;
  }
  return p;
}

/// Nearly singular, condition about 1e10: one step of refinement is not enough.
Lcp ill_conditioned(Index n, Random& random) {
  const Eigen::MatrixXd B = Eigen::MatrixXd::NullaryExpr(n / 2, n, [&] { return random.normal(); });
  const Eigen::MatrixXd A = B.transpose() * B + 1e-9 * Eigen::MatrixXd::Identity(n, n);
  return Lcp::standard(DenseMatrix(A), Vector(A * Eigen::VectorXd::NullaryExpr(n, [&] { return -random.uniform(); })));
}

/// A zero-sum game, of one equilibrium with probability 1: costs A > 0 and c − A.
Lcp game(Index m, Index k, Random& random) {
  Eigen::MatrixXd M = Eigen::MatrixXd::Zero(m + k, m + k);
  for (Index i = 0; i < m; ++i)
    for (Index j = 0; j < k; ++j) {
      M(i, m + j) = random.uniform(1, 2);
      M(m + j, i) = 3 - M(i, m + j);
    }
  return Lcp::standard(DenseMatrix(M), Vector(-Eigen::VectorXd::Ones(m + k)));
}

/// BᵀB + I and a skew part: a P-matrix that is not symmetric.
Lcp skewed(Index n, Random& random) {
  Lcp p = random_spd_problem(n, random);
  auto& A = std::get<DenseMatrix>(p.A);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < i; ++j) {
      const double s = random.normal();
      A(i, j) += s, A(j, i) -= s;
    }
  return p;
}

struct NamedProblem {
  std::string name;
  Lcp problem;
};

/// Problems with one solution, most of a size that the oracle takes too.
std::vector<NamedProblem> problems() {
  Random random(54);
  std::vector<NamedProblem> all;
  for (const Known& k : known_problems())
    if (k.answer == Answer::unique && k.name.find("scaled") == std::string::npos && k.problem.size() <= 6)
      all.push_back({k.name, k.problem});
  for (int k = 0; k < 12; ++k) {
    all.push_back({"definite", random_spd_problem(random.integer(2, 10), random)});
    all.push_back({"skewed", skewed(k == 0 ? 20 : random.integer(2, 8), random)});
    all.push_back({"mixed", mixed_problem(k == 0 ? 20 : random.integer(2, 8), random)});
    all.push_back({"ill", ill_conditioned(random.integer(2, 10), random)});
    all.push_back({"contacts", random_contact_problem(random.integer(1, 2), 7, 0.3, random)});
    all.push_back({"game", game(random.integer(1, 4), random.integer(1, 4), random)});
  }
  return all;
}

double distance(const Vector& a, const Vector& b) {
  const double size = b.lpNorm<Eigen::Infinity>();
  return (a - b).lpNorm<Eigen::Infinity>() / (size > 0 ? size : 1);
}

/// How far answers may differ, relative to ‖z‖∞; 0: not a bit. A problem of condition 1e10 may cost the others 1e9 of
/// it.
struct Promises {
  double permuted = 1e-5, scaled = 1e-2, twice = 1e-5, mirrored = 1e-5, restored = 1e-5, warm = 1e-5;
  bool stays_solved = false;  // what is solved in the first words is so in the second
  bool uses_start = false;
};
const Promises& promises_of(std::string_view solver) {
  // z = lo + y and z = y − μ z_n round once more in Lemke's and the oracle's pure form. First-order methods, and any
  // newcomer, stop when the judge is content, which is sooner where the units are far apart.
  constexpr double once = 1e-15, few = 2e-14, lu = 1e-13;
  static const std::map<std::string_view, Promises> table = {
      {"dantzig", {0, 0, 0, 0, 0, 0, true, false}},
      {"murty", {0, 0, 0, 0, 0, 0, true, false}},
      {"lemke", {once, 0, 0, once, 0, 0, true, false}},
      {"enumerate", {once, once, once, once, once, 0, true, false}},
      {"lemke-howson", {few, 0, 0, 0, 0, 0, false, false}},
      {"path", {few, few, few, few, few, few, true, true}},
      {"block-pivot", {lu, lu, lu, lu, lu, lu, true, true}},
      {"newton-min", {lu, lu, lu, lu, lu, lu, true, true}},
      {"newton-fb", {lu, lu, lu, lu, lu, lu, true, true}},
      {"pgs", {1e-6, 1e-2, lu, lu, lu, 1e-6, true, true}},
  };
  static const Promises newcomer;
  const auto found = table.find(solver);
  return found != table.end() ? found->second : newcomer;
}

struct Retelling {
  const char* name;
  Retold (*retell)(const Lcp&, Random&);
  double Promises::*allowed;
};
constexpr Retelling kRetellings[] = {{"permuted", permuted, &Promises::permuted},
                                     {"scaled", scaled, &Promises::scaled},
                                     {"twice", twice, &Promises::twice},
                                     {"mirrored", mirrored, &Promises::mirrored},
                                     {"restored", restored, &Promises::restored}};

/// Where a solved problem need not stay solved, and why.
bool excused(std::string_view solver, std::string_view how, std::string_view told) {
  if (how == "scaled") {
    // The judge weighs a row by its own terms: what is rounding in one unit is not in another. A row with b = 0 that
    // others exceed 2⁻⁸⁰ times makes every z unknowable.
    if (told == "ill" || told == "game" || told == "kkt" || told == "kkt_active") return true;
    // A friction row's distance from μ z_n has the unit of z, and weighs as much as one of w where |A| is small.
    if (told.starts_with("contact")) return solver == "enumerate" || solver == "newton-min" || solver == "newton-fb";
  }
  // Two games in one are no bimatrix game, and no theorem promises anything; turned, one loses its class for path.
  if (told == "game" || told == "rock_paper_scissors") return how == "twice" || (how == "mirrored" && solver == "path");
  return false;
}

/// Not for this solver: 2ⁿ choices, or a factor of 1 − 1e-10 a sweep.
bool too_slow(std::string_view solver, std::string_view told, const Lcp& p) {
  return (solver == "enumerate" && p.size() > 12) || (solver == "pgs" && told == "ill");
}

/// From any start: the rest are singular in places, and say so.
bool definite(std::string_view told) { return told == "definite" || told == "skewed" || told == "mixed"; }

}  // namespace

TEST_CASE("order, units, sign, a copy, storage: the answer is the same in every solver's words") {
  const auto all = problems();
  for (const SolverEntry& entry : solvers()) {
    const auto solver = entry.make("");
    solver->set_time_limit(5);
    const Promises& promised = promises_of(entry.name);
    Random random(55);
    Solution s, t;
    for (const auto& [told, p] : all) {
      const bool solved = !too_slow(entry.name, told, p) && solver->solve(p, s).status == Status::solved;
      for (const auto& [how, retell, allowed] : kRetellings) {
        const Retold other = retell(p, random);
        if (!solved || too_slow(entry.name, told, other.problem) || excused(entry.name, how, told)) continue;
        solver->solve(other.problem, t);
        INFO(entry.name, " on ", told, ", ", std::string(how), ": ", name(t.status));
        if (promised.stays_solved && solver->why_not(other.problem).empty()) CHECK(t.status == Status::solved);
        if (t.status != Status::solved) continue;
        CHECK(distance(other.back(t.z), s.z) <= promised.*allowed * (told == "ill" ? 1e9 : 1));
        if (promised.*allowed <= 1e-9)  // not a first-order method: the active rows are the same
          CHECK(((other.back(t.z).array() == p.lo.array()) == (s.z.array() == p.lo.array())).all());
      }
    }
  }
}

TEST_CASE("warm starts: any guess leads to the cold answer, the answer itself back to it at no cost") {
  const auto all = problems();
  for (const SolverEntry& entry : solvers()) {
    const auto solver = entry.make("");
    solver->set_time_limit(5);
    const Promises& promised = promises_of(entry.name);
    Random random(56);
    Solution s, t;
    for (const auto& [told, p] : all) {
      if (too_slow(entry.name, told, p) || solver->solve(p, s).status != Status::solved) continue;
      INFO(entry.name, " on ", told, ", cold ", s.iterations, " iterations");
      const double allowed = promised.warm * (told == "ill" ? 1e9 : 1);
      for (const bool near : {true, false}) {
        t.z = s.z;
        if (!near)
          for (double& z : t.z) z += random.normal();
        solver->solve(p, t, Start::warm);
        INFO(std::string(near ? "from the answer: " : "from elsewhere: "), name(t.status), ", ", t.iterations,
             " iterations");
        if (near || (promised.stays_solved && definite(told))) CHECK(t.status == Status::solved);
        if (t.status == Status::solved) CHECK(distance(t.z, s.z) <= allowed);
        if (near && promised.uses_start) CHECK(t.iterations <= 3);
      }
    }
  }
}

TEST_CASE("a used solver gives the bits of a fresh one") {
  const auto all = problems();
  for (const SolverEntry& entry : solvers()) {
    const auto used = entry.make("");
    for (const auto& [told, p] : all) {
      if (too_slow(entry.name, told, p)) continue;
      Solution s, t;
      used->solve(p, s);
      entry.make("")->solve(p, t);
      INFO(entry.name, " on ", told);
      CHECK(s.status == t.status);
      CHECK(s.iterations == t.iterations);
      CHECK(s.z == t.z);
    }
  }
}
