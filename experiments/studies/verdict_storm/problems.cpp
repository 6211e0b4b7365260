#include "experiments/studies/verdict_storm/problems.h"

#include <orthant/core/lcp/problems/families.h>

#include <Eigen/Core>

#include <array>
#include <cmath>

namespace orthant {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Index rows(Random& random, int most = 40) {
  const double u = random.uniform();
  return 1 + static_cast<Index>(u * u * most);
}

MatrixXd normals(Index n, Index m, Random& random) {
  MatrixXd A(n, m);
  for (double& value : A.reshaped()) value = random.normal();
  return A;
}

MatrixXd integers(Index n, Index m, int most, Random& random) {
  MatrixXd A(n, m);
  for (double& value : A.reshaped()) value = random.integer(-most, most);
  return A;
}

StormProblem plain(const MatrixXd& A, const VectorXd& b, std::optional<Answer> answer = {}) {
  return {{}, Lcp::standard(DenseMatrix(A), Vector(b)), answer};
}

StormProblem small_integers(Random& random) {
  const auto yes = [&] { return random.integer(0, 1) == 1; };
  const Kinds kinds{.free = yes(), .box = yes(), .friction = yes()};
  return {{}, random_integer_problem(rows(random), kinds, random), {}};
}

StormProblem degenerate(Random& random) {  // rank deficient, ties
  const auto n = static_cast<int>(rows(random));
  Known known = planted_problem(n, random.integer(0, n), random.integer(0, n), random);
  return {{}, std::move(known.problem), known.answer};
}

StormProblem definite(Random& random) { return {{}, random_spd_problem(rows(random), random), Answer::unique}; }

StormProblem unsymmetric(Random& random) {
  const Index n = rows(random);
  return plain(normals(n, n, random), normals(n, 1, random));
}

StormProblem contacts(Random& random) {
  const int contacts = random.integer(1, 20);
  return {{}, random_contact_problem(contacts, random.integer(1, 2 * contacts), random.uniform(0, 3), random), {}};
}

StormProblem pyramids(Random& random) {
  return {
      {},
      stewart_trinkle_problem(random.integer(1, 10), random.uniform(0, 2), std::pow(10, random.integer(0, 12)), random),
      {}};
}

/// Aᵀu ≤ 0, bᵀu < 0 for a planted u ≥ 0, in small integers: no solution, and the proof is exact.
StormProblem infeasible(Random& random) {
  const Index n = rows(random);
  MatrixXd A = integers(n, n, 3, random);
  VectorXd b = integers(n, 1, 3, random), u = VectorXd::Zero(n);
  const Index row = random.integer(0, static_cast<int>(n) - 1);
  for (double& value : u) value = random.integer(0, 3) == 0 ? 1 : 0;
  u[row] = 1;
  for (Index j = 0; j < n; ++j)
    if (const double over = u.dot(A.col(j)); over > 0) A(row, j) -= over;
  if (const double over = u.dot(b); over >= 0) b[row] -= over + 1;
  return plain(A, b, Answer::infeasible);
}

/// Infeasible or not by one unit of the last places: the line that no rounding may move.
StormProblem on_the_edge(Random& random) {
  StormProblem p = infeasible(random);
  p.answer.reset();
  for (double& value : p.problem.b)
    if (random.integer(0, 3) == 0) value += random.integer(-2, 2) * std::pow(2.0, -random.integer(20, 52));
  return p;
}

/// Rows and columns in units 2^±30 apart.
StormProblem scaled(Random& random) {
  StormProblem p = random.integer(0, 1) == 0 ? degenerate(random) : unsymmetric(random);
  auto& A = std::get<DenseMatrix>(p.problem.A);
  const int most = random.integer(1, 30);
  for (Index i = 0; i < p.problem.size(); ++i) {
    const double row = std::ldexp(1.0, random.integer(-most, most)),
                 column = std::ldexp(1.0, random.integer(-most, most));
    A.row(i) *= row;
    p.problem.b[i] *= row;
    A.col(i) *= column;
  }
  return p;
}

StormProblem zeros(Random& random) {
  const Index n = rows(random);
  MatrixXd A = integers(n, n, 2, random);
  VectorXd b = integers(n, 1, 2, random);
  const double share = random.uniform();
  for (double& value : A.reshaped())
    if (random.uniform() < share) value = 0;
  for (double& value : b)
    if (random.uniform() < share) value = random.integer(0, 1) == 0 ? 0.0 : -0.0;
  for (Index i = 0; i < n; ++i) {
    if (random.integer(0, 4) == 0) A.row(i).setZero();
    if (random.integer(0, 4) == 0) A.col(i).setZero();
  }
  return plain(A, b);
}

/// Denormals, the largest double, and all between.
StormProblem extremes(Random& random) {
  constexpr std::array kNumbers{0.0,   0x1p-1074, 0x1p-1022, 1e-300, 1e-200, 1e-160, 1e-100,
                                1e-20, 1e-10,     1e-5,      1.0,    2.0,    1e5,    1e10,
                                1e20,  1e100,     1e150,     1e160,  1e200,  1e300,  0x1.fffffffffffffp+1023};
  const Index n = rows(random, 12);
  const int first = random.integer(0, static_cast<int>(kNumbers.size()) - 1);
  const int last = random.integer(first, static_cast<int>(kNumbers.size()) - 1);
  const auto draw = [&] {
    return (random.integer(0, 1) == 0 ? -1 : 1) * kNumbers[static_cast<std::size_t>(random.integer(first, last))];
  };
  MatrixXd A(n, n);
  VectorXd b(n);
  for (double& value : A.reshaped()) value = draw();
  for (double& value : b) value = draw();
  if (random.integer(0, 1) == 0) A.diagonal() = A.diagonal().cwiseAbs();
  StormProblem p = plain(A, b);
  if (random.integer(0, 2) == 0)
    for (Index i = 0; i < n; ++i) {
      const double one = draw(), other = draw();
      p.problem.lo[i] = random.integer(0, 3) == 0 ? -kInf : std::min(one, other);
      p.problem.hi[i] = random.integer(0, 3) == 0 ? kInf : std::max(one, other);
    }
  return p;
}

/// One power of ten over the whole problem, or over b alone.
StormProblem units(Random& random) {
  StormProblem p = random.integer(0, 1) == 0 ? degenerate(random) : infeasible(random);
  const double unit = std::ldexp(1.0, random.integer(-600, 600));
  p.problem.b *= unit;
  if (random.integer(0, 1) == 0) std::get<DenseMatrix>(p.problem.A) *= unit;
  return p;
}

StormProblem boxes(Random& random) {
  const Index n = rows(random);
  MatrixXd A = normals(n, n, random);
  if (random.integer(0, 1) == 0) A = (A.transpose() * A).eval();
  StormProblem p = plain(A, normals(n, 1, random));
  for (Index i = 0; i < n; ++i) {
    const double middle = random.normal() * std::pow(10, random.integer(-3, 3));
    const double width = random.integer(0, 3) == 0 ? 0 : std::pow(10, random.integer(-12, 6));
    switch (random.integer(0, 4)) {
      case 0:
        p.problem.lo[i] = -kInf;
        break;
      case 1:
        p.problem.lo[i] = -kInf, p.problem.hi[i] = middle;
        break;
      case 2:
        p.problem.lo[i] = middle;
        break;
      default:
        p.problem.lo[i] = middle, p.problem.hi[i] = middle + width;
    }
  }
  return p;
}

StormProblem exponential(Random& random) {  // 2^n pivots
  return {{}, murty_problem(rows(random, 16), random.integer(0, 1) == 1), Answer::unique};
}

StormProblem z_matrices(Random& random) {  // off-diagonal ≤ 0: solvable when feasible
  const Index n = rows(random);
  MatrixXd A = -integers(n, n, 3, random).cwiseAbs();
  for (Index i = 0; i < n; ++i) A(i, i) = random.integer(-1, static_cast<int>(3 * n));
  return plain(A, integers(n, 1, 5, random));
}

StormProblem almost_singular(Random& random) {
  const Index n = rows(random);
  const MatrixXd B = normals(random.integer(1, static_cast<int>(n)), n, random);
  MatrixXd A = B.transpose() * B;
  const double noise = std::pow(10, -random.integer(8, 17));
  A += noise * normals(n, n, random);
  return plain(A, random.integer(0, 1) == 0 ? VectorXd(A * normals(n, 1, random)) : VectorXd(normals(n, 1, random)));
}

StormProblem copies(Random& random) {  // the same rows and columns several times, b all but equal: redundant contacts
  const Index n = rows(random), different = 1 + n / 3;
  const MatrixXd B = normals(different, different, random), A = B.transpose() * B;
  const VectorXd b = normals(different, 1, random);
  MatrixXd C(n, n);
  VectorXd c(n);
  const double off = random.integer(0, 1) * std::pow(10, -random.integer(1, 16));
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j) C(i, j) = A(i % different, j % different);
    c[i] = b[i % different] + off * random.normal();
  }
  return plain(C, c);
}

StormProblem saddle(Random& random) {  // free multipliers with a zero block, some equations twice
  const Index n = 2 + rows(random, 37), m = random.integer(1, static_cast<int>(n) / 2), x = n - m;
  MatrixXd G = integers(m, x, 2, random);
  if (m > 1 && random.integer(0, 1) == 0) G.row(1) = G.row(0);
  const MatrixXd B = normals(x, x, random);
  MatrixXd A = MatrixXd::Zero(n, n);
  A.topLeftCorner(x, x) = B.transpose() * B;
  A.topRightCorner(x, m) = -G.transpose();
  A.bottomLeftCorner(m, x) = G;
  StormProblem p = plain(A, integers(n, 1, 3, random));
  for (Index i = x; i < n; ++i) p.problem.lo[i] = -kInf;
  return p;
}

StormProblem family(Random& random) {  // what the solvers are compared on, where small enough
  static const std::vector<const Family*> kSmall = [] {
    std::vector<const Family*> all;
    for (const Family& f : families())
      if (f.sizes.front() <= 40) all.push_back(&f);
    return all;
  }();
  const auto pick = [&](std::size_t size) {
    return static_cast<std::size_t>(random.integer(0, static_cast<int>(size) - 1));
  };
  const Family& f = *kSmall[pick(kSmall.size())];
  Known known = f.make(f.sizes.front(), f.hardness[pick(f.hardness.size())],
                       static_cast<std::uint64_t>(random.integer(0, 1 << 30)));
  return {{}, std::move(known.problem), known.answer};
}

StormProblem named(Random& random) {  // the known problems, b in another unit
  static const std::vector<Known> kKnown = known_problems();
  const Known& known = kKnown[static_cast<std::size_t>(random.integer(0, static_cast<int>(kKnown.size()) - 1))];
  StormProblem p{{}, known.problem, known.answer};
  if (random.integer(0, 1) == 0) return p;
  p.answer.reset();
  for (double& value : p.problem.b) value += random.integer(0, 3) == 0 ? random.integer(-1, 1) : 0;
  return p;
}

/// Two rows that contradict each other over one z_j, and another z that they do not hold and that may run away.
StormProblem runaways(Random& random) {
  const Index n = rows(random, 12) + 3;
  MatrixXd A = integers(n, n, 2, random);
  VectorXd b = integers(n, 1, 2, random) * std::pow(10.0, random.integer(0, 5));
  const auto shifted = [&, by = random.integer(0, 1000)](Index i) { return (i + by) % n; };
  const Index least = shifted(0), most = shifted(1), j = shifted(random.integer(0, 2));
  A.row(least).setZero(), A.row(most).setZero();
  A(least, j) = random.integer(1, 20), b[least] = -std::pow(10.0, -random.integer(0, 6));
  A(most, j) = -std::ldexp(1.0, random.integer(-3, 3)), b[most] = 0;
  return plain(A, b, Answer::infeasible);
}

/// One or more rows with a b far above the others': a large excuse there excuses nothing elsewhere.
StormProblem loud(Random& random) {
  StormProblem p = random.integer(0, 2) == 0   ? boxes(random)
                   : random.integer(0, 1) == 0 ? contacts(random)
                                               : definite(random);
  p.answer.reset();
  const double loud = std::pow(10, random.integer(6, 15));
  for (double& value : p.problem.b)
    if (random.integer(0, 3) == 0) value *= loud;
  return p;
}

struct Kind {
  std::string_view name;
  StormProblem (*make)(Random&);
};
constexpr Kind kKinds[] = {{"small-integers", small_integers},
                           {"degenerate", degenerate},
                           {"definite", definite},
                           {"unsymmetric", unsymmetric},
                           {"contacts", contacts},
                           {"pyramids", pyramids},
                           {"infeasible", infeasible},
                           {"on-the-edge", on_the_edge},
                           {"scaled", scaled},
                           {"zeros", zeros},
                           {"extremes", extremes},
                           {"units", units},
                           {"boxes", boxes},
                           {"exponential", exponential},
                           {"z-matrices", z_matrices},
                           {"almost-singular", almost_singular},
                           {"copies", copies},
                           {"saddle", saddle},
                           {"family", family},
                           {"runaways", runaways},
                           {"loud", loud},
                           {"named", named}};
constexpr auto kNames = [] {
  std::array<std::string_view, std::size(kKinds)> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kKinds[i].name;
  return names;
}();

}  // namespace

StormProblem storm_problem(std::uint64_t seed, std::uint64_t k) {
  Random random(seed * 0x9e3779b97f4a7c15u + k);
  const Kind& kind = kKinds[k % std::size(kKinds)];
  StormProblem p = kind.make(random);
  p.kind = kind.name;
  if (std::holds_alternative<DenseMatrix>(p.problem.A) && random.integer(0, 2) == 0) p.problem = as_sparse(p.problem);
  return p;
}

std::span<const std::string_view> storm_kinds() { return kNames; }

}  // namespace orthant
