#include "experiments/studies/verdict_storm/disc_problems.h"

#include <orthant/core/lcp/problems/disc_contacts.h>

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace orthant {
namespace {

using DiscMatrix = Eigen::MatrixXd;
using DiscVector = Eigen::VectorXd;

Index contacts_of(Random& random, int most = 60) {  // mostly few
  const double u = random.uniform();
  return 1 + static_cast<Index>(u * u * u * most);
}
double some_mu(Random& random) { return random.integer(0, 5) == 0 ? random.uniform(0, 3) : random.uniform(0.05, 1); }

StormProblem planted(DiscContacts kind, Random& random) {
  Known known = disc_contacts(kind, random);
  return {{}, std::move(known.problem), known.answer};
}

StormProblem full_rank(Random& random) {
  const Index n = contacts_of(random);
  return planted({.contacts = n, .freedoms = 4 * n, .mu = some_mu(random)}, random);
}
StormProblem redundant(Random& random) {
  const Index n = contacts_of(random);
  return planted({.contacts = n, .freedoms = 1 + random.integer(0, static_cast<int>(3 * n)), .mu = some_mu(random)},
                 random);
}
StormProblem degenerate_discs(Random& random) {
  const Index n = contacts_of(random);
  return planted({.contacts = n, .freedoms = 2 * n, .mu = some_mu(random), .degenerate = true}, random);
}
StormProblem jammed(Random& random) {
  const Index n = contacts_of(random);
  return planted({.contacts = n,
                  .freedoms = 1 + random.integer(0, static_cast<int>(3 * n)),
                  .mu = some_mu(random),
                  .degenerate = random.integer(0, 1) == 1,
                  .jammed = true},
                 random);
}
StormProblem badly_scaled(Random& random) {
  const Index n = contacts_of(random);
  return planted(
      {.contacts = n, .freedoms = 4 * n, .mu = some_mu(random), .spread = std::pow(10, random.integer(2, 12))}, random);
}
StormProblem unsymmetric_discs(Random& random) {
  const Index n = contacts_of(random);
  return planted(
      {.contacts = n, .freedoms = (1 + random.integer(0, 3)) * n, .mu = some_mu(random), .unsymmetric = true}, random);
}
StormProblem rolling(Random& random) {
  const Index n = contacts_of(random, 30);
  return planted({.contacts = n,
                  .freedoms = random.integer(3, 6) * n,
                  .mu = some_mu(random),
                  .rolling = true,
                  .degenerate = random.integer(0, 2) == 0},
                 random);
}

/// b that no solution was planted for.
StormProblem unknown(Random& random) {
  StormProblem p = random.integer(0, 1) == 0 ? redundant(random) : unsymmetric_discs(random);
  for (double& value : p.problem.b) value = random.normal();
  p.answer.reset();
  return p;
}

/// w_n of one contact is −1 at most, whatever z: its row is −μ‖g_T‖ − δ, g_T a multiple of (3, 4), in small integers.
StormProblem infeasible_discs(Random& random) {
  const Index n = contacts_of(random, 12);
  DiscMatrix B(3 * n, 3 * n);
  for (double& value : B.reshaped()) value = random.integer(-3, 3);
  DiscMatrix A = B * B.transpose();
  StormProblem p{{}, {}, Answer::infeasible};
  Lcp& q = p.problem;
  q.b = DiscVector(3 * n), q.lo = DiscVector::Constant(3 * n, -kInf), q.hi = DiscVector::Constant(3 * n, kInf);
  for (double& value : q.b) value = random.integer(-3, 3);
  const Index row = 3 * random.integer(0, static_cast<int>(n) - 1);
  q.b[row] = -random.integer(1, 3);
  for (Index k = 0; k < n; ++k) {
    const double mu = 0.25 * random.integer(0, 6);
    q.friction.push_back({.normal = 3 * k, .first = 3 * k + 1, .rows = 2, .mu = mu});
    q.lo[3 * k] = 0;
    const double size = 4 * random.integer(0, 2), turn = random.integer(0, 1);
    A(row, 3 * k + 1) = (turn == 0 ? 3 : -4) * size, A(row, 3 * k + 2) = (turn == 0 ? 4 : 3) * size;
    A(row, 3 * k) = -mu * 5 * size - random.integer(0, 1);
  }
  q.A = DenseMatrix(A);
  return p;
}

StormProblem on_the_edge_discs(Random& random) {
  StormProblem p = infeasible_discs(random);
  p.answer.reset();
  for (double& value : std::get<DenseMatrix>(p.problem.A).reshaped())
    if (random.integer(0, 5) == 0) value += random.integer(-2, 2) * std::pow(2.0, -random.integer(20, 52));
  return p;
}

/// Some discs become intervals, rows of their own, free rows, boxes.
StormProblem mixed(Random& random) {
  StormProblem p = random.integer(0, 1) == 0 ? full_rank(random) : rolling(random);
  p.answer.reset();
  Lcp& q = p.problem;
  std::vector<Friction> friction;
  for (Friction f : q.friction) {
    switch (random.integer(0, 5)) {
      case 0:  // two intervals
        f.rows = 1;
        friction.push_back(f), ++f.first, friction.push_back(f);
        break;
      case 1:  // one interval, a free row
        f.rows = 1;
        friction.push_back(f);
        break;
      case 2:  // a box and a fixed row
        q.lo[f.first] = -random.uniform(), q.hi[f.first] = random.uniform();
        q.lo[f.first + 1] = q.hi[f.first + 1] = 0;
        break;
      default:
        friction.push_back(f);
    }
    if (random.integer(0, 9) == 0) q.hi[f.normal] = random.uniform(0, 3);
  }
  q.friction = friction;
  return p;
}

/// Bodies of six velocities, each contact between two of them.
StormProblem operators(Random& random) {
  const Index n = contacts_of(random), bodies = 1 + random.integer(0, static_cast<int>(n)), m = 6 * bodies;
  Delassus A;
  A.W.rows = 3 * n, A.W.cols = m;
  A.inverse_mass = DiscVector(m);
  const double spread = random.integer(0, 2) == 0 ? 1e6 : 10;
  for (double& value : A.inverse_mass) value = std::exp(-random.uniform(0, std::log(spread)));
  StormProblem p;
  Lcp& q = p.problem;
  q.b = DiscVector(3 * n), q.lo = DiscVector::Constant(3 * n, -kInf), q.hi = DiscVector::Constant(3 * n, kInf);
  for (double& value : q.b) value = random.normal();
  for (Index k = 0; k < n; ++k) {
    q.friction.push_back({.normal = 3 * k, .first = 3 * k + 1, .rows = 2, .mu = some_mu(random)});
    q.lo[3 * k] = 0;
    int a = random.integer(0, static_cast<int>(bodies) - 1), b = random.integer(0, static_cast<int>(bodies));
    if (a == b) b = static_cast<int>(bodies);
    if (a > b) std::swap(a, b);
    for (int r = 0; r < 3; ++r) {
      for (const int body : {a, b}) {
        if (body == static_cast<int>(bodies)) continue;  // the ground
        for (int c = 0; c < 6; ++c) A.W.column.push_back(6 * body + c), A.W.value.push_back(random.normal());
      }
      A.W.start.push_back(static_cast<int>(A.W.value.size()));
    }
  }
  if (random.integer(0, 1) == 0) {
    A.regularization = DiscVector(3 * n);
    for (double& value : A.regularization) value = random.integer(0, 1) * std::pow(10, -random.integer(1, 12));
  }
  q.A = std::move(A);
  return p;
}

StormProblem twice(Random& random) {
  for (;;) {
    StormProblem p = full_rank(random);
    if (p.problem.size() > 90) continue;
    StormProblem q{{}, restate(p.problem, random).problem, {}};
    return q;
  }
}

StormProblem disc_units(Random& random) {
  StormProblem p = random.integer(0, 1) == 0 ? redundant(random) : infeasible_discs(random);
  const double of_z = std::ldexp(1.0, random.integer(-300, 300)), of_w = std::ldexp(1.0, random.integer(-300, 300));
  auto& A = std::get<DenseMatrix>(p.problem.A);
  A = (A * of_w).eval(), A = (A / of_z).eval();
  p.problem.b *= of_w;
  if (p.answer != Answer::infeasible) p.answer.reset();
  return p;
}

StormProblem slippery(Random& random) {
  StormProblem p = redundant(random);
  for (Friction& f : p.problem.friction)
    if (random.integer(0, 1) == 0) f.mu = random.integer(0, 1) == 0 ? 0 : std::pow(10, random.integer(1, 6));
  p.answer.reset();
  return p;
}

struct DiscKind {
  std::string_view name;
  StormProblem (*make)(Random&);
};
constexpr DiscKind kDiscKinds[] = {{"discs", full_rank},
                                   {"discs-redundant", redundant},
                                   {"discs-degenerate", degenerate_discs},
                                   {"discs-jammed", jammed},
                                   {"discs-scaled", badly_scaled},
                                   {"discs-unsymmetric", unsymmetric_discs},
                                   {"discs-rolling", rolling},
                                   {"discs-unknown", unknown},
                                   {"discs-infeasible", infeasible_discs},
                                   {"discs-on-the-edge", on_the_edge_discs},
                                   {"discs-mixed", mixed},
                                   {"discs-operators", operators},
                                   {"discs-twice", twice},
                                   {"discs-units", disc_units},
                                   {"discs-slippery", slippery}};
constexpr auto kDiscNames = [] {
  std::array<std::string_view, std::size(kDiscKinds)> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kDiscKinds[i].name;
  return names;
}();

}  // namespace

bool can_be_restated(const Lcp& p) {
  if (!std::holds_alternative<DenseMatrix>(p.A) || p.size() != 3 * static_cast<Index>(p.friction.size())) return false;
  for (Index k = 0; 3 * k < p.size(); ++k) {
    const Friction& f = p.friction[at(k)];
    if (f.normal != 3 * k || f.first != 3 * k + 1 || f.rows != 2 || p.lo[3 * k] != 0 || p.hi[3 * k] != kInf)
      return false;
  }
  return true;
}

Restatement restate(const Lcp& p, Random& random) {
  const Index n = p.size(), contacts = n / 3;
  std::vector<Index> order(at(contacts) + 1);
  std::iota(order.begin(), order.end(), Index{0});
  order.back() = random.integer(0, static_cast<int>(contacts) - 1);  // the one that comes twice
  const Index twin = order.back();
  for (std::size_t k = order.size(); k-- > 1;) std::swap(order[k], order[at(random.integer(0, static_cast<int>(k)))]);
  const Index rows = n + 3;
  DiscMatrix T = DiscMatrix::Zero(rows, n);  // w of the new problem: T w
  Restatement restated{{}, DiscMatrix::Zero(rows, n)};
  Lcp& q = restated.problem;
  q.lo = DiscVector::Constant(rows, -kInf), q.hi = DiscVector::Constant(rows, kInf);
  for (Index k = 0; k <= contacts; ++k) {
    const Index from = order[at(k)];
    const double t = random.uniform(-3, 3), c = (1 - t * t) / (1 + t * t), s = 2 * t / (1 + t * t),
                 unit = std::exp2(random.integer(-12, 12));
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    turn.bottomRightCorner(2, 2) << c, -s, s, c;
    T.block(3 * k, 3 * from, 3, 3) = unit * turn;
    restated.of_z.block(3 * k, 3 * from, 3, 3) = (from == twin ? 0.5 : 1) / unit * turn;
    q.lo[3 * k] = 0;
    q.friction.push_back({.normal = 3 * k, .first = 3 * k + 1, .rows = 2, .mu = p.friction[at(from)].mu});
  }
  q.A = DenseMatrix(T * std::get<DenseMatrix>(p.A) * T.transpose());
  q.b = T * p.b;
  return restated;
}

StormProblem disc_problem(std::uint64_t seed, std::uint64_t k) {
  Random random(seed * 0x9e3779b97f4a7c15u + k);
  const DiscKind& kind = kDiscKinds[k % std::size(kDiscKinds)];
  StormProblem p = kind.make(random);
  p.kind = kind.name;
  if (std::holds_alternative<DenseMatrix>(p.problem.A) && random.integer(0, 2) == 0) p.problem = as_sparse(p.problem);
  return p;
}

std::span<const std::string_view> disc_kinds() { return kDiscNames; }

}  // namespace orthant
