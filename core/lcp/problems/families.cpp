#include <orthant/core/lcp/problems/american_put.h>
#include <orthant/core/lcp/problems/contact_piles.h>
#include <orthant/core/lcp/problems/families.h>
#include <orthant/core/lcp/problems/obstacles.h>
#include <orthant/core/lcp/pure_form.h>

#include <Eigen/QR>

#include <cmath>

namespace orthant {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

Known known(Lcp problem, Answer answer, Vector z = {}, bool unique_w = false) {
  return {"", std::move(problem), answer, std::move(z), 0, unique_w};
}

MatrixXd normal_matrix(Index rows, Index columns, Random& random) {
  MatrixXd B(rows, columns);
  for (double& value : B.reshaped()) value = random.normal();
  return B;
}

// q of a planted answer: z positive, w positive or, in a share of the rows, both zero.
Vector planted(const MatrixXd& M, double degenerate, Random& random) {
  VectorXd z = VectorXd::Zero(M.rows()), w = z;
  for (Index i = 0; i < M.rows(); ++i) {
    const bool strict = random.uniform() >= degenerate, inside = random.uniform() < 0.5;
    if (strict) (inside ? z : w)[i] = random.uniform(0.1, 1);
  }
  return w - M * z;
}

MatrixXd with_condition(Index n, double condition,
                        Random& random) {  // SPD, eigenvalues log-uniform in [1/condition, 1]
  const MatrixXd Q = Eigen::HouseholderQR<MatrixXd>(normal_matrix(n, n, random)).householderQ();
  VectorXd eigenvalues(n);
  for (Index i = 0; i < n; ++i) {
    const double share = n > 1 ? static_cast<double>(i) / static_cast<double>(n - 1) : 0;
    eigenvalues[i] = std::pow(condition, -share);
  }
  const MatrixXd M = Q * eigenvalues.asDiagonal() * Q.transpose();
  return 0.5 * (M + M.transpose());
}

Known spd(Index n, double condition, std::uint64_t seed) {
  Random random(seed);
  const MatrixXd M = with_condition(n, condition, random);
  return known(Lcp::standard(DenseMatrix(M), planted(M, 0, random)), Answer::unique);
}

Known semidefinite(Index n, double degenerate, std::uint64_t seed) {
  Random random(seed);
  const auto strict = static_cast<Index>(std::lround((1 - degenerate) * static_cast<double>(n)));
  return planted_problem(n, n / 2, strict, random);
}

Known redundant_contacts(Index n, double ratio, std::uint64_t seed) {  // twice as many contacts as freedoms
  Random random(seed);
  const Index freedoms = std::max<Index>(n / 2, 1);
  const MatrixXd W = normal_matrix(n, freedoms, random);
  VectorXd inverse_mass(freedoms), v(freedoms);
  for (double& value : inverse_mass) value = std::pow(ratio, -random.uniform());
  for (double& value : v) value = random.normal();
  Lcp p = Lcp::standard(Delassus{RowSparse::from(W.sparseView()), Vector(inverse_mass), {}}, Vector(W * v));
  return known(std::move(p), Answer::one_of, {}, true);
}

Known positive_definite(Index n, double skew, std::uint64_t seed) {  // nonsymmetric
  Random random(seed);
  const MatrixXd B = normal_matrix(n, n, random), S = normal_matrix(n, n, random);
  const MatrixXd M = B * B.transpose() / static_cast<double>(n) + MatrixXd::Identity(n, n) + skew * (S - S.transpose());
  return known(Lcp::standard(DenseMatrix(M), planted(M, 0, random)), Answer::unique);
}

Known p_matrix(Index n, double, std::uint64_t seed) {  // unit lower triangle times a diagonal, and Murty's kind within
  Random random(seed);
  MatrixXd M = MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; ++i) {
    M(i, i) = random.uniform(0.5, 2);
    for (Index j = 0; j < i; ++j)
      if (random.uniform() < 4.0 / static_cast<double>(n)) M(i, j) = random.uniform(-3, 3);
  }
  return known(Lcp::standard(DenseMatrix(M), planted(M, 0, random)), Answer::unique);
}

Known murty(Index n, double, std::uint64_t) {
  Vector z(VectorXd::Unit(n, 0));
  return known(murty_problem(n), Answer::unique, z);
}

Known fathi(Index n, double, std::uint64_t) {
  const MatrixXd L = std::get<DenseMatrix>(murty_problem(n).A);
  return known(Lcp::standard(DenseMatrix(L * L.transpose()), Vector(-VectorXd::Ones(n))), Answer::unique,
               Vector(VectorXd::Unit(n, 0)));
}

Known circulant(Index n, double, std::uint64_t) {  // all ratios tie; n odd: P
  n |= 1;
  MatrixXd M = MatrixXd::Identity(n, n);
  for (Index i = 0; i < n; ++i) M(i, (i + 1) % n) += 2;
  return known(Lcp::standard(DenseMatrix(M), Vector(-VectorXd::Ones(n))), Answer::unique,
               Vector(VectorXd::Constant(n, 1.0 / 3)));
}

Known degenerate(Index n, double share, std::uint64_t seed) {  // z_i = w_i = 0 in a share of the rows
  Random random(seed);
  const MatrixXd M = with_condition(n, 100, random);
  return known(Lcp::standard(DenseMatrix(M), planted(M, share, random)), Answer::unique);
}

Known scaled(Index n, double spread, std::uint64_t seed) {  // D₁ M D₂ of an SPD problem, powers of 10 up to ± spread
  Random random(seed);
  MatrixXd M = with_condition(n, 100, random);
  Vector q = planted(M, 0, random);
  VectorXd rows(n), columns(n);
  for (Index i = 0; i < n; ++i) rows[i] = std::exp2(random.integer(-1, 1) * std::round(spread * std::log2(10.0)));
  for (Index i = 0; i < n; ++i) columns[i] = std::exp2(random.integer(-1, 1) * std::round(spread * std::log2(10.0)));
  M = rows.asDiagonal() * M * columns.asDiagonal();
  q = rows.cwiseProduct(q);
  return known(Lcp::standard(DenseMatrix(M), q), Answer::unique);
}

Known infeasible(Index n, double, std::uint64_t seed) {  // integers: u = 1 in half of the rows has Mᵀu = 0, qᵀu = −1
  Random random(seed);
  MatrixXd F(n, std::max<Index>(n / 2, 1));
  VectorXd q(n);
  for (double& value : F.reshaped()) value = random.integer(-2, 2);
  for (double& value : q) value = random.integer(-3, 3);
  const Index half = (n + 1) / 2;
  F.row(0) = -F.middleRows(1, half - 1).colwise().sum();
  q[0] = -1 - q.segment(1, half - 1).sum();
  return known(Lcp::standard(DenseMatrix(F * F.transpose()), Vector(q)), Answer::infeasible);
}

Known stewart_trinkle(Index n, double ratio, std::uint64_t seed) {
  Random random(seed);
  return known(stewart_trinkle_problem(std::max<Index>(n / 4, 1), n < 400 ? 0.5 : 0.8, ratio, random), Answer::one_of);
}

Known stack(Index n, double ratio, std::uint64_t) {  // coupled friction rows
  return known(box_column(std::max<Index>(n / 4, 1), {.mass_ratio = ratio, .slope = 0.2}), Answer::one_of);
}
Known glocker_stack(Index n, double ratio, std::uint64_t) {  // the same written as a pure LCP
  Pyramid pyramid;
  return known(pyramid.pure(box_column(std::max<Index>(n / 6, 1), {.mass_ratio = ratio, .slope = 0.2})),
               Answer::one_of);
}
Known spatial_stack(Index n, double ratio, std::uint64_t) {
  return known(box_column(std::max<Index>(n / 12, 1), {.mass_ratio = ratio, .slope = 0.2, .spatial = true}),
               Answer::one_of);
}
Known smooth_stack(Index n, double ratio, std::uint64_t) {
  return known(box_column(std::max<Index>(n / 2, 1), {.mu = 0, .mass_ratio = ratio}), Answer::one_of, {}, true);
}
Known table(Index n, double ratio, std::uint64_t) {
  return known(loaded_table(std::max<Index>((n - 8) / 2, 2), {.mass_ratio = ratio, .slope = 0.3}), Answer::one_of);
}
Known spatial_table(Index n, double ratio, std::uint64_t) {
  const auto legs = static_cast<Index>(std::sqrt(static_cast<double>(std::max<Index>(n - 24, 12)) / 3));
  return known(loaded_table(legs, {.mass_ratio = ratio, .slope = 0.3, .spatial = true}), Answer::one_of);
}
Known wall(Index n, double ratio, std::uint64_t) {
  const auto courses = static_cast<Index>(std::sqrt(static_cast<double>(n) / 4));
  return known(brick_wall(std::max<Index>(courses, 1), {.mass_ratio = ratio, .slope = 0.1}), Answer::one_of);
}

Index side(Index n) { return std::max<Index>(static_cast<Index>(std::lround(std::sqrt(static_cast<double>(n)))), 2); }
Known string(Index n, double, std::uint64_t) { return known(string_on_obstacle(n + 1), Answer::unique); }
Known ball(Index n, double, std::uint64_t) { return known(ball_obstacle(side(n) + 1).problem, Answer::unique); }
Known beam(Index n, double, std::uint64_t) { return known(beam_on_obstacle(n / 2), Answer::unique); }
Known journal(Index n, double, std::uint64_t) { return known(journal_bearing(side(n), side(n)), Answer::unique); }
Known put(Index n, double, std::uint64_t) {  // the first step from the kink
  AmericanPut option;
  option.nodes = n;
  return known(american_put_step(option, option.payoff(), 0.005, 1), Answer::unique);
}

Known sparse(Index n, double, std::uint64_t seed) {
  Random random(seed);
  return known(random_sparse_problem(n, random), Answer::unique);
}

Known bimatrix(Index n, double, std::uint64_t seed) {  // positive costs
  Random random(seed);
  const Index rows = std::max<Index>(n / 2, 1), columns = rows;
  MatrixXd M = MatrixXd::Zero(rows + columns, rows + columns);
  for (double& value : M.topRightCorner(rows, columns).reshaped()) value = random.integer(1, 99);
  for (double& value : M.bottomLeftCorner(columns, rows).reshaped()) value = random.integer(1, 99);
  return known(Lcp::standard(DenseMatrix(M), Vector(-VectorXd::Ones(rows + columns))), Answer::one_of);
}

constexpr auto kUnique = Answer::unique, kOneOf = Answer::one_of;

}  // namespace

/// One table, so that its columns can be compared.
const std::vector<Family>& families() {
  static const std::vector<Family> all{
      {"spd",
       "random eigenvectors, eigenvalues spread evenly over the condition",
       "SPD",
       kUnique,
       "condition",
       {1e2, 1e4, 1e8, 1e12},
       {20, 80, 300, 1000},
       spd},
      {"psd",
       "rank n/2 and a skew part, answer planted, a share of rows degenerate",
       "PSD",
       kOneOf,
       "degenerate share",
       {0, 0.1, 0.5},
       {20, 80, 300, 1000},
       semidefinite},
      {"delassus",
       "twice as many contacts as freedoms, frictionless, as an operator",
       "PSD",
       kOneOf,
       "mass ratio",
       {1, 1e6, 1e10},
       {20, 80, 300, 1000},
       redundant_contacts},
      {"nonsymmetric",
       "positive definite with a skew part",
       "PD",
       kUnique,
       "skew part",
       {0.1, 10},
       {20, 80, 300, 1000},
       positive_definite},
      {"triangular",
       "sparse triangle with signs of all kinds, not definite",
       "P",
       kUnique,
       "",
       {0},
       {20, 80, 300},
       p_matrix},
      {"murty", "Lemke's 2^n pivots", "P", kUnique, "", {0}, {8, 12, 40}, murty},
      {"fathi", "Lemke's 2^n pivots, ill conditioned", "SPD", kUnique, "", {0}, {8, 12, 40}, fathi},
      {"circulant",
       "all ratios tie: pivoting may cycle, sweeps diverge",
       "P",
       kUnique,
       "",
       {0},
       {3, 21, 81},
       circulant},
      {"degenerate",
       "z and w both zero in a share of the rows",
       "SPD",
       kUnique,
       "degenerate share",
       {0.3, 0.9},
       {20, 80, 300},
       degenerate},
      {"scaled", "rows and columns in units 10^±k", "P", kUnique, "k", {4, 8}, {20, 80, 300}, scaled},
      {"infeasible", "no z gives w ≥ 0", "PSD", Answer::infeasible, "", {0}, {20, 80, 300}, infeasible},
      {"friction",
       "random friction in Stewart and Trinkle's form",
       "copositive",
       kOneOf,
       "mass ratio",
       {1, 1e6, 1e10},
       {20, 80, 240, 400},
       stewart_trinkle},
      {"column",
       "column of boxes on a slope, planar friction rows",
       "PSD, friction",
       kOneOf,
       "mass ratio",
       {1, 1e4, 1e10},
       {20, 80, 320},
       stack},
      {"glocker",
       "column of boxes in Glocker's pure form",
       "copositive or not",
       kOneOf,
       "mass ratio",
       {1, 1e4, 1e10},
       {18, 78, 318},
       glocker_stack},
      {"column3d",
       "column of boxes with pyramids of friction",
       "PSD, friction",
       kOneOf,
       "mass ratio",
       {1, 1e4, 1e10},
       {24, 84, 240},
       spatial_stack},
      {"tower",
       "column of boxes, frictionless, redundant corners",
       "PSD",
       kOneOf,
       "mass ratio",
       {1, 1e4, 1e10},
       {20, 80, 320},
       smooth_stack},
      {"table",
       "hyperstatic table that slides, planar",
       "PSD, friction",
       kOneOf,
       "mass ratio",
       {1, 1e4, 1e10},
       {24, 80, 320},
       table},
      {"table3d",
       "hyperstatic table that slides, with pyramids of friction",
       "PSD, friction",
       kOneOf,
       "mass ratio",
       {1, 1e4, 1e10},
       {36, 72, 324},
       spatial_table},
      {"wall", "brick wall on a slope", "PSD, friction", kOneOf, "mass ratio", {1, 1e4}, {36, 144, 400}, wall},
      {"string", "string on an obstacle", "K", kUnique, "", {0}, {63, 255, 4095, 65535}, string},
      {"beam",
       "beam on an obstacle, cubic elements",
       "SPD, ill conditioned",
       kUnique,
       "",
       {0},
       {32, 512, 8192, 65536},
       beam},
      {"ball", "membrane over a ball", "K", kUnique, "", {0}, {225, 961, 16129, 65025, 261121}, ball},
      {"journal", "journal bearing, stretched grid", "K", kUnique, "", {0}, {225, 961, 16384, 65536, 262144}, journal},
      {"american", "first time step of an American put", "K, nonsymmetric", kUnique, "", {0}, {199, 1999, 19999}, put},
      {"sparse",
       "tridiagonal and random entries, factors fill in",
       "P, sparse, nonsymmetric",
       kUnique,
       "",
       {0},
       {40, 1600, 10000, 100000, 1000000},
       sparse},
      {"bimatrix", "equilibria of random games", "copositive", kOneOf, "", {0}, {10, 40, 100}, bimatrix},
  };
  return all;
}

const Family* find_family(std::string_view name) {
  for (const Family& family : families())
    if (family.name == name) return &family;
  return nullptr;
}

}  // namespace orthant
