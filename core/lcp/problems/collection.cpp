#include <orthant/core/lcp/problems/collection.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace orthant {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

VectorXd list(std::initializer_list<double> values) {
  VectorXd v(static_cast<Index>(values.size()));
  std::copy(values.begin(), values.end(), v.begin());
  return v;
}

MatrixXd square(std::initializer_list<double> rows) {  // row by row
  const auto n = static_cast<Index>(std::lround(std::sqrt(static_cast<double>(rows.size()))));
  return list(rows).reshaped<Eigen::RowMajor>(n, n);
}

VectorXd unit(Index n, Index i) { return VectorXd::Unit(n, i); }
VectorXd ones(Index n) { return VectorXd::Ones(n); }

MatrixXd murty(Index n) {  // 1 on the diagonal, 2 below
  MatrixXd L = MatrixXd::Identity(n, n);
  L.triangularView<Eigen::StrictlyLower>().setConstant(2);
  return L;
}

MatrixXd string_matrix(Index n) {  // tridiagonal −1, 2, −1
  MatrixXd T = 2 * MatrixXd::Identity(n, n);
  T.diagonal(1).setConstant(-1);
  T.diagonal(-1).setConstant(-1);
  return T;
}

MatrixXd wilkinson(Index n) {  // 1 on the diagonal, −1 below, last column 1
  MatrixXd W = MatrixXd::Identity(n, n);
  W.triangularView<Eigen::StrictlyLower>().setConstant(-1);
  W.col(n - 1).setOnes();
  return W;
}

class Collector {
 public:
  std::vector<Known> all;

  Known& add(std::string name, const MatrixXd& M, const VectorXd& q, const VectorXd& z,
             Answer answer = Answer::unique) {
    all.push_back({std::move(name), Lcp::standard(DenseMatrix(M), Vector(q)), answer, Vector(z), 0, false});
    return all.back();
  }
  Known& add(std::string name, const MatrixXd& M, const VectorXd& q, Answer answer) {
    return add(std::move(name), M, q, VectorXd(), answer);
  }
  Known& add(std::string name, const MatrixXd& A, const VectorXd& b, const VectorXd& lo, const VectorXd& hi,
             const VectorXd& z, Answer answer = Answer::unique) {
    Known& known = add(std::move(name), A, b, z, answer);
    known.problem.lo = lo;
    known.problem.hi = hi;
    return known;
  }
  // Rows N, T of one planar contact.
  Known& add_contact(std::string name, const MatrixXd& A, const VectorXd& b, double mu, const VectorXd& z,
                     Answer answer = Answer::unique) {
    Known& known = add(std::move(name), A, b, list({0, -kInf}), list({kInf, kInf}), z, answer);
    known.problem.friction = {{.normal = 0, .first = 1, .mu = mu}};
    return known;
  }
};

/// A list of problems, one after the other.
void add_standard(Collector& c) {
  // 2ⁿ pivots for Lemke's method (Murty 1978, Fathi 1979); the transpose takes 2.
  const Index n = 8;
  c.add("murty", murty(n), -ones(n), unit(n, 0));
  c.add("murty_transposed", murty(n).transpose(), -ones(n), unit(n, n - 1));
  c.add("fathi", murty(n) * murty(n).transpose(), -ones(n), unit(n, 0));
  // All ratios tie: a rule without anticycling goes round for ever; Newton-min does so too (Ben Gharbia & Gilbert
  // 2012).
  c.add("circulant", square({1, 2, 0, 0, 1, 2, 2, 0, 1}), -ones(3), ones(3) / 3);
  // Singular blocks; a segment of solutions, then an unbounded one, whose last ratio test ties with z₀.
  c.add("rank_one", square({1, 1, 1, 1}), -ones(2), list({0.5, 0.5}), Answer::one_of).unique_w = true;
  c.add("unbounded_segment", square({1, -1, -1, 1}), list({1, -1}), list({0, 1}), Answer::one_of).unique_w = true;
  c.add("infeasible_psd", square({1, -1, -1, 1}), -ones(2), Answer::infeasible);
  // An isolated solution that a perturbation of q removes (Pang).
  const MatrixXd pang = square({0, -1, -1, 1, 0, 0, -1, 0, 0});
  c.add("pang", pang, list({0, -1, 1}), list({1, 0, 0}));
  c.add("pang_perturbed", pang, list({-1e-4, -1, 1}), Answer::infeasible);
  // Cottle, Pang & Stone, example 4.4.7; the transpose, a classic misreading, has other answers.
  c.add("cps_4_4_7", square({0, -1, 2, 2, 0, -2, -1, 1, 0}), list({-3, 6, -1}), list({0, 1, 3}));
  // A quadratic program's optimality conditions: zero on the diagonal, degenerate (w = 0).
  const MatrixXd qp = square({11, 0, 10, -1, 0, 11, 10, -1, 10, 10, 21, -1, 1, 1, 1, 0});
  c.add("qp", qp, list({50, 50, 10, -6}), list({2, 2, 2, 92}));
  // Four solutions although q > 0; a solvable problem on which Lemke's method ends on a ray.
  c.add("four_corners", -MatrixXd::Identity(2, 2), ones(2), list({0, 0}), Answer::one_of);
  c.add("ray_though_solvable", square({0, 1, 1, -1}), list({-1, -2}), list({3, 1}));
  // Bimatrix games [0 A; Bᵀ 0] (z is an equilibrium up to scale): three equilibria, and rock-paper-scissors.
  c.add("bimatrix", square({0, 0, 10, 20, 0, 0, 30, 15, 10, 30, 0, 0, 20, 15, 0, 0}), -ones(4), list({0.1, 0, 0.1, 0}),
        Answer::one_of);
  MatrixXd game = MatrixXd::Zero(6, 6);
  game.topRightCorner(3, 3) = square({2, 3, 1, 1, 2, 3, 3, 1, 2});
  game.bottomLeftCorner(3, 3) = game.topRightCorner(3, 3);  // costs A and B = Aᵀ
  c.add("rock_paper_scissors", game, -ones(6), ones(6) / 6);
  // Hilbert's matrix times the least common multiple of 1 … 2n − 1: integers. Condition 1e7 and 1e10.
  for (const auto& [size, multiple] : {std::pair<Index, double>{6, 27720}, {8, 360360}}) {
    MatrixXd H(size, size);
    VectorXd z(size);
    for (Index i = 0; i < size; ++i) {
      z[i] = static_cast<double>(i % 2);
      for (Index j = 0; j < size; ++j) H(i, j) = multiple / static_cast<double>(i + j + 1);
    }
    c.add("hilbert_" + std::to_string(size), H, ones(size) - z - H * z, z).accuracy = size == 6 ? 1e-8 : 1e-5;
  }
  // Elimination with partial pivoting loses 2ⁿ⁻¹ here, though the condition is about 27. z in 1/1024: q is exact.
  Random random(30);
  for (const Index size : {30, 54, 60}) {
    VectorXd z(size);
    for (double& value : z) value = random.integer(1, 1023) / 1024.0;
    c.add("wilkinson_" + std::to_string(size), wilkinson(size), -wilkinson(size) * z, z).accuracy = 1e-13;
  }
  // Powers of 2 that spread the rows and columns over 2^±40: same active set, the same bits of z after unscaling.
  for (const auto& [name, M, q, z] :
       {std::tuple<const char*, MatrixXd, VectorXd, VectorXd>{"circulant_scaled", square({1, 2, 0, 0, 1, 2, 2, 0, 1}),
                                                              -ones(3), ones(3) / 3},
        {"qp_scaled", qp, list({50, 50, 10, -6}), list({2, 2, 2, 92})}}) {
    VectorXd row(q.size()), col(q.size());
    for (double& d : row) d = std::ldexp(1.0, random.integer(-40, 40));
    for (double& d : col) d = std::ldexp(1.0, random.integer(-40, 40));
    c.add(name, row.asDiagonal() * M * col.asDiagonal(), row.cwiseProduct(q), z.cwiseQuotient(col));
  }
  // K-matrices: z_i = i (n + 1 − i) / 2; a string pressed on an obstacle, in contact for 1/4 ≤ x ≤ 3/4, where 1/4 is a
  // node, so that the discrete answer is exact: z = u + δ, u = −δ + 4 (x − 1/4)², δ = 1/4.
  VectorXd parabola(50);
  for (Index i = 0; i < 50; ++i) parabola[i] = static_cast<double>((i + 1) * (50 - i)) / 2;
  c.add("k_matrix", string_matrix(50), -ones(50), parabola).accuracy = 1e-13;
  VectorXd load = VectorXd::Constant(15, 8), gap(15);
  for (Index i = 0; i < 15; ++i) {
    const double x = static_cast<double>(i + 1) / 16, lift = std::max({0.25 - x, x - 0.75, 0.0});
    gap[i] = 4 * lift * lift;
  }
  load[0] -= 64;  // the ends: u = 0, so z = δ there, times 1/h² = 256
  load[14] -= 64;
  c.add("string_on_obstacle", 256 * string_matrix(15), load, gap);
  // One contact, w = A λ + b: every case of signs (Painlevé).
  const auto scalar = [&](const char* name, double A, double b, std::initializer_list<double> z, Answer answer) {
    c.add(name, square({A}), list({b}), list(z), answer);
  };
  scalar("scalar_+-", 2, -1, {0.5}, Answer::unique);
  scalar("scalar_++", 2, 1, {0}, Answer::unique);
  scalar("scalar_-+", -2, 1, {0}, Answer::one_of);
  scalar("scalar_--", -1, -1, {}, Answer::infeasible);
  scalar("scalar_00", 0, 0, {0}, Answer::one_of);
  scalar("scalar_0-", 0, -1, {}, Answer::infeasible);
  scalar("scalar_tiny--", -1e-12, -1e-12, {}, Answer::infeasible);  // z = 0 has an absolute residual of 1e-12 only
  scalar("scalar_tiny+-", 1e-12, -1e-12, {1}, Answer::unique);
  // Feasible, but no solution: w₁ = −z₁ + z₂ − 1 needs z₂ ≥ 1, where w₂ = z₂ + 1 > 0.
  c.add("feasible_without_solution", square({-1, 1, 0, 1}), list({-1, 1}), Answer::none);
  // z = 0 solves, b = 0.
  c.add("homogeneous", square({2, 1, 1, 2}), VectorXd::Zero(2), VectorXd::Zero(2));
}

void add_mixed(Collector& c) {
  // A linear system as free rows; then equality-constrained least distance: multipliers with a zero block.
  c.add("linear_system", square({2, 1, 1, 3}), list({-4, -7}), VectorXd::Constant(2, -kInf),
        VectorXd::Constant(2, kInf), list({1, 2}));
  const MatrixXd kkt = square({1, 0, -1, 0, 1, -1, 1, 1, 0});  // min ½|x − p|², x₁ + x₂ = 2
  const VectorXd free_last = list({0, 0, -kInf}), inf3 = VectorXd::Constant(3, kInf);
  c.add("kkt", kkt, list({0, 0, -2}), free_last, inf3, list({1, 1, 1}));
  c.add("kkt_active", kkt, list({-4, 0, -2}), free_last, inf3, list({2, 0, -2}));
  c.add("kkt_infeasible", kkt, list({0, 0, 2}), free_last, inf3, VectorXd(), Answer::infeasible);
  // The same equation twice: singular, consistent, the two multipliers share 1; and twice with contradiction.
  const MatrixXd twice = square({1, 0, -1, -1, 0, 1, -1, -1, 1, 1, 0, 0, 1, 1, 0, 0});
  const VectorXd free_two = list({0, 0, -kInf, -kInf}), inf4 = VectorXd::Constant(4, kInf);
  c.add("kkt_redundant", twice, list({0, 0, -2, -2}), free_two, inf4, list({1, 1, 0.5, 0.5}), Answer::one_of).unique_w =
      true;
  c.add("kkt_contradiction", twice, list({0, 0, -2, -3}), free_two, inf4, VectorXd(), Answer::infeasible);
  // Boxes: one row at hi, one inside; all fixed; a bound on one side only, from below and from above; b = 0.
  const MatrixXd spd = square({2, -1, -1, 2});
  c.add("box", spd, list({-5, 0}), list({-1, -1}), list({1, 1}), list({1, 0.5}));
  c.add("box_fixed", spd, list({-5, 3}), list({2, -1}), list({2, -1}), list({2, -1}));
  c.add("box_far_from_zero", spd, VectorXd::Zero(2), list({4, -kInf}), list({9, 1}), list({4, 1}));
  c.add("one_sided", spd, list({1, -4}), list({1, -kInf}), list({kInf, 1}), list({1, 1}));
  c.add("box_indefinite", square({-1}), list({0.5}), list({0}), list({1}), list({0}), Answer::one_of);
  c.add("upper_infeasible", square({0}), list({1}), list({-kInf}), list({3}), VectorXd(), Answer::infeasible);
}

void add_friction(Collector& c) {
  const MatrixXd straight = square({2, 0, 0, 1}), coupled = square({2, 1, 1, 2});
  c.add_contact("contact_open", coupled, list({1, -1}), 0.5, list({0, 0}));
  c.add_contact("contact_stick", straight, list({-2, -0.25}), 0.5, list({1, 0.25}));
  c.add_contact("contact_slide", straight, list({-2, -2}), 0.5, list({1, 0.5}));
  c.add_contact("contact_slide_back", straight, list({-2, 2}), 0.5, list({1, -0.5}));
  c.add_contact("contact_slide_coupled", coupled, list({-2.5, -4}), 0.5, list({1, 0.5}));
  c.add_contact("contact_frictionless", coupled, list({-2, -9}), 0, list({1, 0}));
  c.add_contact("contact_edge_of_cone", straight, list({-2, -0.5}), 0.5, list({1, 0.5}));  // degenerate: w_t = 0 too
  c.add_contact("contact_at_rest", coupled, list({0, 0}), 0.5, list({0, 0}));
  c.add_contact("contact_infeasible", square({0, 0, 0, 1}), list({-1, 0}), 0.5, VectorXd(), Answer::infeasible);
  // Painlevé: sliding backwards sees 2 − 3 μ < 0. No sliding solution for b_N < 0, but sticking is one; three solutions
  // for b_N > 0: open (0, 0), sliding (1, −1), sticking (25, −17).
  const MatrixXd painleve = square({2, 3, 3, 5});
  c.add_contact("contact_painleve", painleve, list({-1, 10}), 1, list({35, -23}));
  c.add_contact("contact_painleve_three", painleve, list({1, 10}), 1, list({0, 0}), Answer::one_of);
  // The same contact written twice: the sum of the impulses is unique.
  MatrixXd W(4, 2);
  W << 1, 0, 0, 1, 1, 0, 0, 1;
  Known& twin = c.add("contact_twice", W * W.transpose(), list({-2, -4, -2, -4}), list({0, -kInf, 0, -kInf}),
                      VectorXd::Constant(4, kInf), list({1, 0.5, 1, 0.5}), Answer::one_of);
  twin.problem.friction = {{.normal = 0, .first = 1, .mu = 0.5}, {.normal = 2, .first = 3, .mu = 0.5}};
  twin.unique_w = true;
}

}  // namespace

std::vector<Known> known_problems() {
  Collector collector;
  add_standard(collector);
  add_mixed(collector);
  add_friction(collector);
  Random random(24);
  for (const Index strict : {12, 9, 5}) {
    collector.all.push_back(planted_problem(12, 8, strict, random));
    collector.all.back().name = "planted_" + std::to_string(strict) + "_of_12";
  }
  return std::move(collector.all);
}

Lcp murty_problem(Index n, bool transposed) {
  const MatrixXd M = murty(n);
  return Lcp::standard(DenseMatrix(transposed ? MatrixXd(M.transpose()) : M), Vector(-ones(n)));
}

Lcp as_sparse(const Lcp& problem) {
  Lcp result = problem;
  DenseMatrix dense;
  to_dense(problem.A, dense);
  result.A = RowSparse::from(Eigen::MatrixXd(dense).sparseView());
  return result;
}

Lcp random_integer_problem(Index n, Kinds kinds, Random& random) {
  MatrixXd A(n, n);
  VectorXd b(n);
  for (double& value : A.reshaped()) value = random.integer(-2, 2);
  for (double& value : b) value = random.integer(-2, 2);
  Lcp p = Lcp::standard(DenseMatrix(A), Vector(b));
  for (Index i = 0; i < n; ++i) {
    const int draw = random.integer(0, 3);
    if (draw == 1 && kinds.free) {
      p.lo[i] = -kInf;
    } else if (draw == 2 && kinds.box) {
      p.lo[i] = random.integer(-2, 1);
      p.hi[i] = random.integer(0, 3) == 0 ? kInf : p.lo[i] + random.integer(0, 2);
      if (random.integer(0, 4) == 0) p.lo[i] = -kInf;
    } else if (draw == 3 && kinds.friction && i > 0 && p.lo[i - 1] >= 0) {
      p.lo[i] = -kInf;
      p.friction.push_back({.normal = i - 1, .first = i, .mu = random.integer(0, 4) * 0.25});
    }
  }
  return p;
}

Known planted_problem(Index n, Index rank, Index strict, Random& random) {
  MatrixXd B(rank, n), S = MatrixXd::Zero(n, n);
  for (double& value : B.reshaped()) value = random.integer(-2, 2);
  for (Index i = 0; i < n; ++i)
    for (Index j = 0; j < i; ++j) {
      S(i, j) = random.integer(-2, 2);
      S(j, i) = -S(i, j);
    }
  VectorXd z = VectorXd::Zero(n), w = VectorXd::Zero(n);
  for (Index i = 0; i < strict; ++i) (random.integer(0, 1) == 0 ? z : w)[i] = random.integer(1, 9);
  const MatrixXd M = B.transpose() * B + S;
  Known known{"planted", Lcp::standard(DenseMatrix(M), Vector(w - M * z)), Answer::one_of, Vector(z), 0, true};
  return known;
}

Lcp random_spd_problem(Index n, Random& random) {
  MatrixXd B(n, n);
  VectorXd q(n);
  for (double& value : B.reshaped()) value = random.normal();
  for (double& value : q) value = random.normal();
  return Lcp::standard(DenseMatrix(B.transpose() * B + MatrixXd::Identity(n, n)), Vector(q));
}

Lcp random_sparse_problem(Index n, Random& random) {
  const auto rows = static_cast<int>(n);
  std::vector<Eigen::Triplet<double>> entries;
  Vector q;
  q.resize(n);
  for (int i = 0; i < rows; ++i) {
    if (i > 0) entries.emplace_back(i, i - 1, -1);
    entries.emplace_back(i, i, 4);
    if (i + 1 < rows) entries.emplace_back(i, i + 1, -1);
    for (int more = random.integer(1, 2); more > 0; --more) {
      const int j = random.integer(0, rows - 1);
      if (std::abs(j - i) > 1) entries.emplace_back(i, j, random.uniform(-1, 1));
    }
    q[i] = random.normal();
  }
  Eigen::SparseMatrix<double, Eigen::RowMajor> M(n, n);
  M.setFromTriplets(entries.begin(), entries.end());
  return Lcp::standard(RowSparse::from(M), q);
}

Lcp random_contact_problem(Index contacts, Index dof, double mu, Random& random) {
  const Index n = 2 * contacts;
  MatrixXd W(n, dof);
  for (double& value : W.reshaped()) value = random.normal();
  Lcp p;
  Delassus A;
  A.W = RowSparse::from(W.sparseView());
  A.inverse_mass.resize(dof);
  for (Index k = 0; k < dof; ++k) A.inverse_mass[k] = 1 / random.uniform(0.5, 2);
  p.A = std::move(A);
  p.b.resize(n);
  for (Index i = 0; i < n; ++i) p.b[i] = i % 2 == 0 ? -std::abs(random.normal()) : random.normal();
  p.lo.resize(n);
  p.lo.setZero();
  p.hi.resize(n);
  p.hi.setConstant(kInf);
  for (Index i = 0; i < contacts; ++i) {
    p.lo[2 * i + 1] = -kInf;
    p.friction.push_back({.normal = 2 * i, .first = 2 * i + 1, .mu = mu});
  }
  return p;
}

Lcp stewart_trinkle_problem(Index contacts, double mu, double mass_ratio, Random& random) {
  const Index c = contacts, n = 4 * c;
  MatrixXd J(3 * c, c);
  for (double& value : J.topRows(2 * c).reshaped()) value = random.normal();
  J.bottomRows(c) = -J.middleRows(c, c);
  VectorXd inverse_mass(c), v(c);
  for (double& value : inverse_mass) value = std::pow(mass_ratio, -random.uniform());
  for (double& value : v) value = random.normal();
  MatrixXd M = MatrixXd::Zero(n, n);
  M.topLeftCorner(3 * c, 3 * c).noalias() = J * inverse_mass.asDiagonal() * J.transpose();
  for (Index i = 0; i < c; ++i) {
    M(c + i, 3 * c + i) = M(2 * c + i, 3 * c + i) = 1;
    M(3 * c + i, c + i) = M(3 * c + i, 2 * c + i) = -1;
    M(3 * c + i, i) = mu;
  }
  VectorXd q = VectorXd::Zero(n);
  q.head(3 * c).noalias() = J * v;
  return Lcp::standard(DenseMatrix(M), Vector(q));
}

}  // namespace orthant
