// Proofs of infeasibility over friction cones: found wherever one is planted with room, none where there is a point.
#include <orthant/core/lcp/judge/certify.h>
#include <orthant/core/lcp/problems/collection.h>
#include <orthant/solvers/proof/cone_proof.h>
#include <orthant/solvers/registry.h>

#include <doctest/doctest.h>

#include "tests/support/sanitized.h"

#include <cmath>

using namespace orthant;

namespace {

struct ConeProblem {
  Lcp problem;
  DenseMatrix& A() { return std::get<DenseMatrix>(problem.A); }
};

/// Contacts with discs, some with a rolling disc or an interval besides; then rows of every other kind but boxes.
ConeProblem random_cones(int contacts, bool others, Random& random) {
  ConeProblem p;
  Index n = 0;
  for (int c = 0; c < contacts; ++c) {
    p.problem.friction.push_back({.normal = n, .first = n + 1, .rows = 2, .mu = random.uniform(0.1, 1)});
    const int more = others ? random.integer(0, 2) : 0;
    if (more > 0)
      p.problem.friction.push_back({.normal = n, .first = n + 3, .rows = more, .mu = random.uniform(0.1, 1)});
    n += 3 + more;
  }
  const Index first = n;
  if (others) n += 5;
  p.problem.lo = Eigen::VectorXd::Constant(n, -kInf), p.problem.hi = Eigen::VectorXd::Constant(n, kInf);
  for (const Friction& f : p.problem.friction) p.problem.lo[f.normal] = 0;
  if (others) {
    p.problem.lo[first] = 0;                                 // [0, ∞)
    p.problem.lo[first + 1] = -2;                            // [−2, ∞)
    p.problem.hi[first + 2] = 3;                             // (−∞, 3]
    p.problem.lo[first + 3] = p.problem.hi[first + 3] = -1;  // fixed; the last is free
  }
  Eigen::MatrixXd A(n, n);
  for (double& value : A.reshaped()) value = random.integer(-8, 8);
  if (others) A(n - 1, n - 1) = 9;  // 0: all g of the free row may have one sign
  p.problem.A = DenseMatrix(A), p.problem.b = Eigen::VectorXd::Zero(n);
  return p;
}

/// The supremum over the cones of uᵀA z, and the row of u = 1 made such that it is finite, by `room` in each condition.
ConeProblem with_proof(int contacts, bool others, double room, Random& random) {
  ConeProblem p = random_cones(contacts, others, random);
  Lcp& q = p.problem;
  const Index n = q.size();
  Eigen::VectorXd u = Eigen::VectorXd::Zero(n);
  std::vector<char> friction(at(n), 0);
  for (const Friction& f : q.friction)
    for (Index t = f.first; t < f.first + f.rows; ++t) friction[at(t)] = 1;
  for (Index i = 0; i < n; ++i)
    if (friction[at(i)] == 0 && q.lo[i] != q.hi[i])
      u[i] = q.hi[i] < kInf ? -random.integer(0, 1) : q.lo[i] == -kInf ? random.integer(-1, 1) : random.integer(0, 1);
  const Index row = 0;  // a normal
  u[row] = 1;
  Eigen::VectorXd push = Eigen::VectorXd::Zero(n);
  const Eigen::VectorXd g = p.A().transpose() * u;
  for (const Friction& f : q.friction) push[f.normal] += f.mu * g.segment(f.first, f.rows).norm();
  double most = 0;
  for (Index j = 0; j < n; ++j) {
    if (friction[at(j)] != 0) continue;
    const bool below = q.lo[j] != -kInf, above = q.hi[j] != kInf;
    const double c = below && above ? g[j] : below ? -room - (push[j] > 0 ? 1 : 0) : above ? room : 0;
    p.A()(row, j) += c - g[j] - push[j];
    if (below || above) most += c * (below ? q.lo[j] : q.hi[j]);
  }
  for (double& value : q.b) value = random.integer(-5, 5);
  q.b[row] -= u.dot(q.b) + most + (room > 0 ? room : 1);
  return p;
}

ConeProof::End ends(const Lcp& p, const std::function<bool(const Vector&)>& proves) {
  return ConeProof().search(p, {}, proves);
}

}  // namespace

TEST_CASE("a proof over cones is found wherever one is planted with room, in rows of every kind, in any units") {
  Random random(3);
  for (int trial = 0; trial < share_of(60); ++trial) {
    CAPTURE(trial);
    Lcp p = with_proof(1 + trial % 7, trial % 2 == 1, 0.5, random).problem;
    if (trial % 3 == 0) p.b *= 0x1p40, p.lo *= 0x1p40, p.hi *= 0x1p40;
    if (trial % 5 == 0) p = as_sparse(p);
    Judge judge;
    CHECK(ends(p, [&](const Vector& u) { return judge.proves_infeasible(p, u); }) == ConeProof::End::proved);
  }
}

TEST_CASE("no proof over cones is sought in vain: a point with room in every condition ends the search") {
  Random random(4);
  for (int trial = 0; trial < share_of(60); ++trial) {
    CAPTURE(trial);
    Lcp p = random_cones(1 + trial % 7, trial % 2 == 1, random).problem;
    Vector z(Eigen::VectorXd::Ones(p.size())), w;
    for (Index i = 0; i < p.size(); ++i) z[i] = std::min(std::max(1.0, p.lo[i]), p.hi[i]);
    for (const Friction& f : p.friction)
      for (Index t = f.first; t < f.first + f.rows; ++t) z[t] = f.mu * random.uniform(-0.5, 0.5);
    p.b = -std::get<DenseMatrix>(p.A) * z;
    for (Index i = 0; i < p.size(); ++i) p.b[i] += p.hi[i] < kInf ? -1 : p.lo[i] > -kInf ? 1 : 0;
    int asked = 0;
    CHECK(ends(p, [&](const Vector&) { return ++asked < 0; }) == ConeProof::End::none);
    CHECK(asked == 0);
  }
}

TEST_CASE("boxes, problems without a demand and a time that is over leave a proof over cones open") {
  Random random(5);
  Lcp p = with_proof(3, true, 0.5, random).problem;
  const auto never = [](const Vector&) { return false; };
  Budget over;
  over.start(0, nullptr);
  CHECK(ConeProof().search(p, over, never) == ConeProof::End::open);
  p.lo[p.size() - 1] = -1, p.hi[p.size() - 1] = 1;
  CHECK(ends(p, never) == ConeProof::End::open);
  Lcp equations = Lcp::standard(DenseMatrix(Eigen::MatrixXd::Identity(2, 2)), Vector{1, 1});
  equations.lo.setConstant(-kInf);
  CHECK(ends(equations, never) == ConeProof::End::open);
}

TEST_CASE("auto and interior-point prove contact problems with discs infeasible") {
  Random random(6);
  for (const char* spec : {"auto", "interior-point"}) {
    const auto solver = make_solver(spec);
    for (int trial = 0; trial < share_of(20); ++trial) {
      CAPTURE(spec);
      CAPTURE(trial);
      const Lcp p = with_proof(2 + trial % 5, false, 0.25, random).problem;
      Solution s;
      CHECK(solver->solve(p, s).status == Status::infeasible);
      CHECK(Judge().proves_infeasible(p, s.certificate));
      solver->set_proof_search(false);
      CHECK(solver->solve(p, s).status != Status::infeasible);
      solver->set_proof_search(true);
    }
  }
}
