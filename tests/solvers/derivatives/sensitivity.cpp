// Derivatives of solutions against finite differences in 256 bits.
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/core/lcp/problems/contact_piles.h>
#include <orthant/core/lcp/problems/disc_contacts.h>
#include <orthant/core/lcp/problems/obstacles.h>
#include <orthant/solvers/derivatives/sensitivity.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>
#include <Eigen/LU>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>

using namespace orthant;

namespace {

using Bits256 =
    boost::multiprecision::number<boost::multiprecision::cpp_bin_float<256, boost::multiprecision::digit_base_2>,
                                  boost::multiprecision::et_off>;
using Bits256Matrix = Eigen::Matrix<Bits256, Eigen::Dynamic, Eigen::Dynamic>;
using Bits256Vector = Eigen::Matrix<Bits256, Eigen::Dynamic, 1>;

// The data at step · change, in 256 bits.
struct Bits256Problem {
  Bits256Matrix A;
  Bits256Vector b, lo, hi, mu;
  std::vector<Friction> friction;

  Bits256Problem(const Lcp& p, const Perturbation& change, const Bits256& step, const Bits256& regularization) {
    const auto wide = [](const auto& x) { return x.template cast<Bits256>().eval(); };
    if (const auto* operator_ = std::get_if<Delassus>(&p.A)) {
      const auto* parts = change.A ? &std::get<Delassus>(*change.A) : nullptr;
      Bits256Matrix W = wide(Eigen::MatrixXd(operator_->W.view()));
      Bits256Vector inverse_mass = wide(operator_->inverse_mass);
      Bits256Vector R = Bits256Vector::Zero(p.size());
      if (operator_->regularization.size() > 0) R = wide(operator_->regularization);
      if (parts != nullptr && parts->W.rows > 0) W += step * wide(Eigen::MatrixXd(parts->W.view()));
      if (parts != nullptr && parts->inverse_mass.size() > 0) inverse_mass += step * wide(parts->inverse_mass);
      if (parts != nullptr && parts->regularization.size() > 0) R += step * wide(parts->regularization);
      A = W * inverse_mass.asDiagonal() * W.transpose();
      A.diagonal() += R;
    } else {
      DenseMatrix dense;
      to_dense(p.A, dense);
      A = wide(dense);
      if (change.A) to_dense(*change.A, dense), A += step * wide(dense);
    }
    for (Index i = 0; i < p.size(); ++i) A(i, i) += regularization;
    const auto moved = [&](const Vector& at, const Vector& by) {
      Bits256Vector x = wide(at);
      if (by.size() > 0) x += step * wide(by);
      return x;
    };
    b = moved(p.b, change.b), lo = moved(p.lo, change.lo), hi = moved(p.hi, change.hi);
    friction = p.friction;
    Vector coefficients(Eigen::VectorXd::Zero(static_cast<Index>(friction.size())));
    for (std::size_t k = 0; k < friction.size(); ++k) coefficients[static_cast<Index>(k)] = friction[k].mu;
    mu = moved(coefficients, change.mu);
  }
};

// Semismooth Newton's method on the natural map, from `start`: no pattern is given to it. False: no convergence.
bool solve_in_256_bits(const Bits256Problem& p, Bits256Vector& z, Bits256Vector& w) {
  const Index n = p.b.size();
  std::vector<int> friction_of(at(n), -1);
  for (std::size_t k = 0; k < p.friction.size(); ++k)
    for (Index i = 0; i < p.friction[k].rows; ++i) friction_of[at(p.friction[k].first + i)] = static_cast<int>(k);
  Bits256Matrix J(n, n);
  Bits256Vector F(n);
  for (int iteration = 0; iteration < 60; ++iteration) {
    w = p.A * z + p.b;
    for (Index i = 0; i < n; ++i) {
      const int k = friction_of[at(i)];
      const Bits256 d = p.A(i, i) > 0 ? p.A(i, i) : Bits256(1);
      if (k < 0) {
        const Bits256 x = z[i] - w[i] / d;
        if (x > p.lo[i] && x < p.hi[i]) {
          F[i] = w[i], J.row(i) = p.A.row(i);
        } else {
          F[i] = z[i] - (x <= p.lo[i] ? p.lo[i] : p.hi[i]);
          J.row(i).setZero(), J(i, i) = 1;
        }
        continue;
      }
      const Friction& f = p.friction[static_cast<std::size_t>(k)];
      if (f.first != i) continue;
      const Bits256 mu = p.mu[k], radius = z[f.normal] > 0 ? Bits256(mu * z[f.normal]) : Bits256(0);
      Bits256Vector x = z.segment(i, f.rows) - w.segment(i, f.rows) / d;
      const Bits256 length = x.norm();
      if (length <= radius) {
        F.segment(i, f.rows) = w.segment(i, f.rows);
        J.middleRows(i, f.rows) = p.A.middleRows(i, f.rows);
        continue;
      }
      x /= length;
      F.segment(i, f.rows) = z.segment(i, f.rows) - radius * x;
      Bits256Matrix across = -x * x.transpose();
      across.diagonal().array() += Bits256(1);
      across *= radius / length;
      Bits256Matrix move = Bits256Matrix::Zero(f.rows, n);
      for (Index r = 0; r < f.rows; ++r) move(r, i + r) = 1;
      J.middleRows(i, f.rows) = move - across * (move - p.A.middleRows(i, f.rows) / d);
      if (z[f.normal] > 0) J.middleRows(i, f.rows).col(f.normal) -= mu * x;
    }
    if (F.cwiseAbs().maxCoeff() < Bits256("1e-60")) return true;
    z -= J.partialPivLu().solve(F);
  }
  return false;
}

struct Difference256 {
  Eigen::VectorXd z, w;
  bool found = true;
};

// (z(ε) − z(−ε)) / 2ε; one-sided: (z(ε) − z(0)) / ε.
Difference256 difference_256(const Lcp& p, const Vector& z0, const Perturbation& change, bool one_sided = false,
                             double regularization = 0) {
  const Bits256 step = ldexp(Bits256(1), -80);
  Bits256Vector z[2], w[2];
  Difference256 d;
  for (int k = 0; k < 2; ++k) {
    z[k] = z0.cast<Bits256>();
    const Bits256 at = k == 1 ? step : one_sided ? Bits256(0) : Bits256(-step);
    d.found = solve_in_256_bits(Bits256Problem(p, change, at, Bits256(regularization)), z[k], w[k]) && d.found;
  }
  const Bits256 over = one_sided ? step : Bits256(2 * step);
  d.z = Bits256Vector((z[1] - z[0]) / over).cast<double>();
  d.w = Bits256Vector((w[1] - w[0]) / over).cast<double>();
  return d;
}

Vector normal_vector(Random& random, Index n) {
  Vector x(Eigen::VectorXd::Zero(n));
  for (Index i = 0; i < n; ++i) x[i] = random.normal();
  return x;
}

// Every part of the data changes at random, A on its own pattern.
Perturbation random_change(const Lcp& p, Random& random) {
  Perturbation change;
  const Index n = p.size();
  const auto redrawn = [&](RowSparse rows) {
    for (double& value : rows.value) value = random.normal();
    return rows;
  };
  if (std::holds_alternative<DenseMatrix>(p.A)) {
    Eigen::MatrixXd A(n, n);
    for (Index j = 0; j < n; ++j)
      for (Index i = 0; i < n; ++i) A(i, j) = random.normal();
    change.A = DenseMatrix(A);
  } else if (const auto* sparse = std::get_if<RowSparse>(&p.A)) {
    change.A = redrawn(*sparse);
  } else {
    const auto& parts = std::get<Delassus>(p.A);
    change.A = Delassus{redrawn(parts.W), normal_vector(random, parts.W.cols), normal_vector(random, n)};
  }
  change.b = normal_vector(random, n), change.lo = normal_vector(random, n), change.hi = normal_vector(random, n);
  for (Index i = 0; i < n; ++i)
    if (p.lo[i] == p.hi[i]) change.hi[i] = change.lo[i];
  for (const Friction& f : p.friction) change.lo[f.normal] = 0;  // z_n ≥ 0 stays
  change.mu = normal_vector(random, static_cast<Index>(p.friction.size()));
  return change;
}

// SolutionTangent against differences, adjoint against tangent.
void compare_tangents(const Lcp& p, const Solution& s, Random& random, double tolerance) {
  const Sensitivity of = sensitivity(p, s);
  REQUIRE(of.report().differentiable());
  REQUIRE(!of.report().redundant);
  const Perturbation change = random_change(p, random);
  const SolutionTangent t = of.jvp(change);
  const Difference256 d = difference_256(p, s.z, change);
  REQUIRE(d.found);
  const double size_z = 1 + d.z.lpNorm<Eigen::Infinity>(), size_w = 1 + d.w.lpNorm<Eigen::Infinity>();
  CHECK((t.z - d.z).lpNorm<Eigen::Infinity>() <= tolerance * size_z);
  CHECK((t.w - d.w).lpNorm<Eigen::Infinity>() <= tolerance * size_w * size_z);

  const Vector g = normal_vector(random, p.size()), h = normal_vector(random, p.size());
  const DataGradient back = of.vjp(g, h);
  double along = back.b.dot(change.b) + back.lo.dot(change.lo) + back.hi.dot(change.hi) + back.mu.dot(change.mu);
  const Matrix by_A = gradient_of_matrix(of, back);
  if (const auto* dense = std::get_if<DenseMatrix>(&by_A)) {
    along += dense->cwiseProduct(std::get<DenseMatrix>(*change.A)).sum();
  } else if (const auto* sparse = std::get_if<RowSparse>(&by_A)) {
    const auto& A = std::get<RowSparse>(*change.A);
    for (std::size_t k = 0; k < A.value.size(); ++k) along += sparse->value[k] * A.value[k];
  } else {
    const auto& parts = std::get<Delassus>(by_A);
    const auto& A = std::get<Delassus>(*change.A);
    for (std::size_t k = 0; k < A.W.value.size(); ++k) along += parts.W.value[k] * A.W.value[k];
    along += parts.inverse_mass.dot(A.inverse_mass) + parts.regularization.dot(A.regularization);
  }
  const double expected = g.dot(t.z) + h.dot(t.w);
  const double size = g.cwiseAbs().dot(t.z.cwiseAbs()) + h.cwiseAbs().dot(t.w.cwiseAbs());
  CHECK(std::abs(along - expected) <= tolerance * (1 + size));
}

}  // namespace

TEST_CASE("sensitivity: boxes and free rows, dense and sparse, symmetric or not, as differences in 256 bits") {
  Random random(41);
  for (int trial = 0; trial < 40; ++trial) {
    INFO("trial ", trial);
    const Index n = random.integer(1, 14);
    Lcp p = random_spd_problem(static_cast<int>(n), random);
    DenseMatrix& A = std::get<DenseMatrix>(p.A);
    if (trial % 4 >= 2)  // a skew part: a P-matrix still
      for (Index j = 0; j < n; ++j)
        for (Index i = 0; i < j; ++i) {
          const double skew = random.normal();
          A(i, j) += skew, A(j, i) -= skew;
        }
    for (Index i = 0; i < n; ++i) {
      const int kind = random.integer(0, 4);
      if (kind == 1) p.hi[i] = random.uniform(0.0, 0.5);
      if (kind == 2) p.lo[i] = -kInf;
      if (kind == 3) p.lo[i] = -0.3, p.hi[i] = 0.1;
      if (kind == 4 && trial % 5 == 0) p.lo[i] = p.hi[i] = 0.2;
    }
    if (trial % 2 == 1) {
      const Eigen::SparseMatrix<double, Eigen::RowMajor> rows = A.sparseView();
      p.A = RowSparse::from(rows);
    }
    Solution s;
    REQUIRE(has_answer(make_solver("auto")->solve(p, s).status));
    compare_tangents(p, s, random, 1e-9);
  }
}

TEST_CASE("sensitivity: friction discs that stick, slide on the cone and are open, rolling too") {
  Random random(42);
  int sliding = 0, sticking = 0, open = 0;
  for (int trial = 0; trial < 24; ++trial) {
    INFO("trial ", trial);
    DiscContacts kind;
    kind.contacts = random.integer(1, 4), kind.freedoms = 30;
    kind.rolling = trial % 3 == 2, kind.unsymmetric = trial % 4 == 3;
    const Known known = disc_contacts(kind, random);
    Solution s;
    if (!has_answer(make_solver("auto")->solve(known.problem, s).status)) continue;
    for (const Friction& f : known.problem.friction) {
      const double slip = s.w.segment(f.first, f.rows).norm();
      ++(s.z[f.normal] == 0 ? open : slip > 1e-8 ? sliding : sticking);
    }
    compare_tangents(known.problem, s, random, 1e-8);
  }
  CHECK((sliding > 10 && sticking > 10 && open > 10));
}

TEST_CASE("sensitivity: planar friction, dense and as an operator that is not formed, by its parts W, 1/m, R") {
  Random random(43);
  for (int trial = 0; trial < 24; ++trial) {
    INFO("trial ", trial);
    const Index contacts = random.integer(1, 5), n = 2 * contacts, freedoms = n + 3;
    Eigen::MatrixXd W(n, freedoms);
    for (Index j = 0; j < freedoms; ++j)
      for (Index i = 0; i < n; ++i) W(i, j) = random.integer(0, 2) == 0 ? 0.0 : random.normal();
    Delassus parts;
    parts.W = RowSparse::from(Eigen::SparseMatrix<double, Eigen::RowMajor>(W.sparseView()));
    parts.inverse_mass = Eigen::VectorXd::Constant(freedoms, 1.0);
    for (Index j = 0; j < freedoms; ++j) parts.inverse_mass[j] = random.uniform(0.1, 2.0);
    parts.regularization = Eigen::VectorXd::Constant(n, 0.05);
    Lcp p = Lcp::standard(parts, normal_vector(random, n));
    for (Index k = 0; k < contacts; ++k) {
      p.friction.push_back({2 * k, 2 * k + 1, 1, random.uniform(0.1, 0.6)});
      p.lo[2 * k + 1] = -kInf;
    }
    if (trial % 2 == 0) {
      DenseMatrix dense;
      to_dense(p.A, dense);
      p.A = dense;
    }
    Solution s;
    if (!has_answer(make_solver("auto")->solve(p, s).status)) continue;
    compare_tangents(p, s, random, 1e-8);
  }
}

namespace {

// A positive definite and w = A z + b in small multiples of 1/8: exact in double, so that rows with z = w = 0 are.
Lcp exact_problem(const Eigen::VectorXd& z, const Eigen::VectorXd& w, Random& random, bool skew) {
  const Index n = z.size();
  Eigen::MatrixXd B(n, n);
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) B(i, j) = random.integer(-4, 4) / 8.0;
  Eigen::MatrixXd A = B * B.transpose() + Eigen::MatrixXd::Identity(n, n);
  if (skew) A += (B - B.transpose()) / 8;
  return Lcp::standard(DenseMatrix(A), Vector(w - A * z));
}

Solution exact_answer(const Lcp& p, const Eigen::VectorXd& z) {
  Solution s;
  s.z = z;
  return make_solver("auto")->solve(p, s, Start::warm);
}

void compare_directional(const Lcp& p, const Solution& s, std::size_t weak, Random& random, int directions) {
  const Sensitivity of = sensitivity(p, s);
  CHECK(of.report().weakly_active.size() == weak);
  for (int k = 0; k < directions; ++k) {
    INFO("direction ", k);
    Perturbation change = random_change(p, random);
    const Difference256 d = difference_256(p, s.z, change, true);
    if (!d.found) continue;  // Newton's method may cycle
    const SolutionTangent t = of.directional(change);
    CHECK((t.z - d.z).lpNorm<Eigen::Infinity>() <= 1e-8 * (1 + d.z.lpNorm<Eigen::Infinity>()));
    CHECK((t.w - d.w).lpNorm<Eigen::Infinity>() <= 1e-8 * (1 + d.w.lpNorm<Eigen::Infinity>()));
  }
}

}  // namespace

TEST_CASE("directional: rows with z = w = 0 choose, as one-sided differences in 256 bits") {
  Random random(44);
  for (int trial = 0; trial < 30; ++trial) {
    INFO("trial ", trial);
    const Index n = random.integer(2, 10);
    Eigen::VectorXd z = Eigen::VectorXd::Zero(n), w = z;
    std::size_t weak = 0;
    for (Index i = 0; i < n; ++i) {
      const int kind = i == 0 ? 0 : random.integer(0, 2);
      if (kind == 0) ++weak;
      if (kind == 1) z[i] = random.integer(1, 8) / 4.0;
      if (kind == 2) w[i] = random.integer(1, 8) / 4.0;
    }
    const Lcp p = exact_problem(z, w, random, trial % 2 == 1);
    compare_directional(p, exact_answer(p, z), weak, random, 4);
  }
}

TEST_CASE("directional: friction on its bound without slip, discs on their edge, contacts without force or slip") {
  Random random(45);
  for (int trial = 0; trial < 30; ++trial) {
    INFO("trial ", trial);
    const bool discs = trial % 2 == 1;
    const Index contacts = random.integer(1, 3), rows = discs ? 3 : 2, n = rows * contacts;
    Eigen::VectorXd z = Eigen::VectorXd::Zero(n), w = z;
    std::size_t weak = 0;
    std::vector<Friction> friction;
    for (Index k = 0; k < contacts; ++k) {
      const Index i = rows * k;
      friction.push_back({i, i + 1, rows - 1, 0.5});
      const int kind = k == 0 ? random.integer(0, 1) : random.integer(0, 5);
      if (kind == 0) {  // on the edge: 10 · 0.5 = |(3, 4)|
        z[i] = 10;
        if (discs) z[i + 1] = 3, z[i + 2] = -4;
        if (!discs) z[i + 1] = random.integer(0, 1) == 0 ? 5 : -5;
        weak += discs ? 2 : 1;
      } else if (kind == 1) {  // neither force nor velocity
        weak += static_cast<std::size_t>(rows);
      } else if (kind == 2) {  // no force, slips
        w[i + 1] = 0.75;
        weak += 1;
      } else if (kind == 3) {  // slides
        z[i] = 10;
        if (discs) z[i + 1] = -3, z[i + 2] = 4, w[i + 1] = 0.75, w[i + 2] = -1;
        if (!discs) z[i + 1] = -5, w[i + 1] = 0.5;
      } else if (kind == 4) {  // sticks
        z[i] = 2, z[i + 1] = 0.25;
      } else {  // open
        w[i] = 1, w[i + 1] = 0.5;
      }
    }
    Lcp p = exact_problem(z, w, random, false);
    p.friction = friction;
    for (const Friction& f : friction) p.lo.segment(f.first, f.rows).setConstant(-kInf);
    Solution s = exact_answer(p, z);
    REQUIRE(has_answer(s.status));
    if ((s.z - z).norm() > 1e-12) continue;  // another solution
    compare_directional(p, s, weak, random, 4);
  }
}

namespace {

// A plate on feet × feet feet (planar: feet), more than hold it; rows N T₁ T₂ (planar: N T). Entries are exact in
// double, and b = W v exactly: the rows stay dependent in 256 bits. v: linear velocity along x and down, turn.
struct FeetPlate {
  Eigen::MatrixXd W;
  Lcp problem;
};
FeetPlate feet_plate(int feet, bool spatial, double mu, double vx, double turn) {
  const double height = 0.5;
  std::vector<std::array<double, 2>> at;
  for (int i = 0; i < feet; ++i)
    for (int j = 0; j < (spatial ? feet : 1); ++j) at.push_back({i - 0.75, spatial ? j - 1.25 : 0.0});
  const Index rows = spatial ? 3 : 2, freedoms = spatial ? 6 : 3, contacts = static_cast<Index>(at.size());
  FeetPlate result;
  result.W.setZero(rows * contacts, freedoms);
  for (Index k = 0; k < contacts; ++k) {
    const auto [x, y] = at[static_cast<std::size_t>(k)];
    if (spatial) {
      result.W.row(3 * k) << 0, 0, 1, y, -x, 0;
      result.W.row(3 * k + 1) << 1, 0, 0, 0, -height, -y;
      result.W.row(3 * k + 2) << 0, 1, 0, height, 0, x;
    } else {
      result.W.row(2 * k) << 0, 1, x;
      result.W.row(2 * k + 1) << 1, 0, height;
    }
  }
  Vector v(Eigen::VectorXd::Zero(freedoms));
  v[0] = vx, v[spatial ? 2 : 1] = -1.0, v[freedoms - 1] = spatial ? turn : 0;
  Delassus A{RowSparse::from(Eigen::SparseMatrix<double, Eigen::RowMajor>(result.W.sparseView())),
             Eigen::VectorXd::Constant(freedoms, 0.7),
             {}};
  for (Index j = freedoms / 2 + 1; j < freedoms; ++j) A.inverse_mass[j] = 1.9;
  result.problem = Lcp::standard(A, Vector(result.W * v));
  for (Index k = 0; k < contacts; ++k) {
    result.problem.friction.push_back({rows * k, rows * k + 1, rows - 1, mu});
    result.problem.lo.segment(rows * k + 1, rows - 1).setConstant(-kInf);
  }
  return result;
}

}  // namespace

TEST_CASE("sensitivity: redundant contacts give the derivative of the motion, whichever forces were found") {
  Random random(46);
  int redundant = 0;
  for (const bool spatial : {false, true})
    for (const double vx : {0.0, 0.125, 4.0})  // sticks, sticks, slides
      for (const double turn : {0.0, 0.5}) {
        if (spatial && vx > 1) continue;  // the motion depends on how the feet share the load
        INFO("spatial ", spatial, ", vx ", vx, ", turn ", turn);
        const FeetPlate table = feet_plate(3, spatial, 0.5, vx, turn);
        Lcp p = table.problem;
        const Delassus parts = std::get<Delassus>(p.A);
        const Index freedoms = parts.W.cols;
        Solution s;
        REQUIRE(has_answer(make_solver("auto")->solve(p, s).status));
        // What keeps the redundancy: masses, and velocities, b = W v.
        Perturbation change;
        Delassus masses;
        masses.inverse_mass = normal_vector(random, freedoms).cwiseProduct(parts.inverse_mass);
        Eigen::VectorXd v(freedoms);
        for (Index j = 0; j < freedoms; ++j) v[j] = random.integer(-8, 8) / 8.0;
        change.A = masses, change.b = table.W * v;
        const Difference256 d = difference_256(p, s.z, change, false, 1e-45);
        REQUIRE(d.found);
        const Eigen::VectorXd motion = table.W.transpose() * d.z;
        for (const bool formed : {false, true}) {
          INFO("formed ", formed);
          Perturbation now = change;
          if (formed) {
            DenseMatrix dense;
            to_dense(Delassus{parts.W, masses.inverse_mass, {}}, dense), now.A = dense;
            to_dense(parts, dense), p.A = dense;
          }
          const Sensitivity of = sensitivity(p, s);
          if (of.report().redundant) ++redundant;
          const SolutionTangent t = of.directional(now);
          CHECK(t.consistent);
          CHECK((t.w - d.w).lpNorm<Eigen::Infinity>() <= 1e-7 * (1 + d.w.lpNorm<Eigen::Infinity>()));
          const Eigen::VectorXd moved = table.W.transpose() * t.z;
          const SolutionTangent held = of.jvp(now);
          const Vector h = normal_vector(random, p.size()), none(Eigen::VectorXd::Zero(p.size()));
          const DataGradient back = of.vjp(none, h);
          CHECK(back.consistent);
          double along = back.b.dot(now.b);
          const Matrix by_A = gradient_of_matrix(of, back);
          if (formed)
            along += std::get<DenseMatrix>(by_A).cwiseProduct(std::get<DenseMatrix>(*now.A)).sum();
          else
            along += std::get<Delassus>(by_A).inverse_mass.dot(masses.inverse_mass);
          CHECK(std::abs(along - h.dot(held.w)) <= 1e-8 * (1 + h.cwiseAbs().dot(held.w.cwiseAbs())));
          CHECK((moved - motion).lpNorm<Eigen::Infinity>() <= 1e-7 * (1 + motion.lpNorm<Eigen::Infinity>()));
        }
      }
  CHECK(redundant >= 8);
  MESSAGE(redundant << " of 20 with a singular block");
}

TEST_CASE("sensitivity: a sparse obstacle problem of 2000 rows, by its rows and by a difference of solves") {
  const Lcp p = string_on_obstacle(2001);
  Solution s, moved;
  REQUIRE(has_answer(make_solver("auto")->solve(p, s).status));
  const Sensitivity of = sensitivity(p, s);
  Perturbation change;
  change.b = p.b;
  const SolutionTangent t = of.directional(change);
  double out = 0;  // the rows of the tangent's own problem
  for (Index i = 0; i < p.size(); ++i)
    if (of.report().margin[i] > of.report().threshold)
      out = std::max(out, std::min(std::abs(t.z[i]), std::abs(t.w[i])));
  CHECK(out <= 1e-9 * t.w.lpNorm<Eigen::Infinity>());
  Lcp stronger = p;
  stronger.b *= 1 + 1e-6;  // scaled data: the same contact set, the tangent is exact but for rounding
  REQUIRE(has_answer(make_solver("auto")->solve(stronger, moved).status));
  CHECK(((moved.z - s.z) / 1e-6 - t.z).lpNorm<Eigen::Infinity>() <= 1e-5 * (1 + t.z.lpNorm<Eigen::Infinity>()));
}

TEST_CASE("sensitivity: the report names what is near, unsolved and misfitting input is refused") {
  Lcp p = Lcp::standard(DenseMatrix(Eigen::Matrix2d{{2, 0}, {0, 1}}), Vector{-2, 1e-3});
  Solution s;
  REQUIRE(make_solver("lemke")->solve(p, s).status == Status::solved);
  Sensitivity of = sensitivity(p, s);
  CHECK(of.report().nearest == 1);
  CHECK(of.report().margin[1] == 1e-3);
  CHECK(of.report().differentiable());
  p.b[1] = 0;
  REQUIRE(make_solver("lemke")->solve(p, s).status == Status::solved);
  of = sensitivity(p, s);
  REQUIRE(of.report().weakly_active.size() == 1);
  CHECK(of.report().weakly_active[0].row == 1);
  CHECK(words_of(of.report()).find("row 1 is weakly active") != std::string::npos);
  Perturbation change;
  change.b = {0, -1};
  CHECK(of.jvp(change).z[1] == 0);
  CHECK(of.directional(change).z[1] == 1);
  change.b = {0, 1};
  CHECK(of.directional(change).z[1] == 0);
  change.b = {1};
  CHECK_THROWS_AS(of.jvp(change), std::invalid_argument);
  CHECK_THROWS_AS(of.vjp(Vector{1}), std::invalid_argument);
  s.status = Status::stalled;
  CHECK_THROWS_AS(sensitivity(p, s), std::invalid_argument);
}

TEST_CASE("sensitivity: redundant rows that a change parts have no derivative, and that is said") {
  Lcp p = Lcp::standard(DenseMatrix(Eigen::Matrix2d{{1, 1}, {1, 1}}), Vector{-2, -2});
  Solution s;
  s.status = Status::solved, s.z = {1, 1}, s.w = {0, 0}, s.residual = 0, s.rounding = 1e-16;
  const Sensitivity of = sensitivity(p, s);
  CHECK(of.report().redundant);
  Perturbation change;
  change.b = {1, 1};
  CHECK(of.jvp(change).consistent);
  CHECK(of.jvp(change).w.norm() <= 1e-14);
  CHECK(of.vjp(Vector{1, 1}).consistent);         // z_1 + z_2 is unique
  CHECK_FALSE(of.vjp(Vector{1, -1}).consistent);  // z_1 − z_2 is not
  change.b = {1, -1};
  CHECK_FALSE(of.jvp(change).consistent);
}
