// Bullet, double precision: Dantzig and projected Gauss-Seidel (boxes, friction by index), Lemke (pure problems).
#include "driver.h"

#include <BulletDynamics/MLCPSolvers/btDantzigSolver.h>
#include <BulletDynamics/MLCPSolvers/btLemkeAlgorithm.h>
#include <BulletDynamics/MLCPSolvers/btSolveProjectedGaussSeidel.h>

#include <memory>

using namespace rival;

namespace {

struct State {
  btMatrixXu A;
  btVectorXu b, x, lo, hi;
  btAlignedObjectArray<int> dependency;
  bool solved = false;
  int info = 0, steps = 0;

  explicit State(const Problem& p) {
    const int n = static_cast<int>(p.n);
    A.resize(n, n), b.resize(n), x.resize(n), lo.resize(n), hi.resize(n), dependency.resize(n, -1);
    const std::vector<double> dense = p.dense();
    for (int i = 0; i < n; ++i) {
      const auto k = static_cast<std::size_t>(i);
      for (int j = 0; j < n; ++j) A.setElem(i, j, dense[k * static_cast<std::size_t>(n) + static_cast<std::size_t>(j)]);
      b[i] = -p.b[k], lo[i] = std::max(p.lo[k], -1e30), hi[i] = std::min(p.hi[k], 1e30);
    }
    for (std::size_t k = 0; k < p.mu.size(); ++k) {
      const int row = p.friction_row[k];
      dependency[row] = p.friction_normal[k], hi[row] = p.mu[k], lo[row] = -p.mu[k];
    }
  }
  Answer answer() const {
    Answer a{solved, steps, "", {}};
    for (int i = 0; i < b.rows(); ++i) a.z.push_back(x[i]);
    return a;
  }
};

std::shared_ptr<State> state(const Problem& p) {
  if (p.n > 2000) throw Unsupported("dense: more than 2000 rows");
  return std::make_shared<State>(p);
}

Work dantzig(const Problem& p, double) {
  if (!p.symmetric()) throw Unsupported("not symmetric");
  for (std::size_t i = 0; i < p.b.size(); ++i)
    if (p.lo[i] > 0 || p.hi[i] < 0) throw Unsupported("a box without 0");
  auto s = state(p);
  for (int i = 0; i < s->b.rows(); ++i) {  // beyond 1e30 is infinite to it
    if (s->lo[i] <= -1e30) s->lo[i] = -BT_INFINITY;
    if (s->hi[i] >= 1e30) s->hi[i] = BT_INFINITY;
  }
  auto solver = std::make_shared<btDantzigSolver>();
  return {[s] { s->x.setZero(); },
          [s, solver] { s->solved = solver->solveMLCP(s->A, s->b, s->x, s->lo, s->hi, s->dependency, 0); },
          [s] { return s->answer(); }};
}

Work pgs(const Problem& p, double tolerance) {
  for (std::int64_t i = 0; i < p.n; ++i) {
    double diagonal = 0;
    for (auto k = p.start[static_cast<std::size_t>(i)]; k < p.start[static_cast<std::size_t>(i) + 1]; ++k)
      if (p.column[static_cast<std::size_t>(k)] == i) diagonal = p.value[static_cast<std::size_t>(k)];
    if (!(diagonal > 0)) throw Unsupported("a diagonal entry that is not positive");
  }
  auto s = state(p);
  auto solver = std::make_shared<btSolveProjectedGaussSeidel>();
  const double step = 1e-2 * tolerance;  // of a sweep: slow convergence makes it far smaller than the residual
  solver->m_leastSquaresResidualThreshold = step * step;
  return {[s] { s->x.setZero(); },
          [s, solver] { s->solved = solver->solveMLCP(s->A, s->b, s->x, s->lo, s->hi, s->dependency, 100000); },
          [s, solver] {
            s->solved = s->solved && solver->m_leastSquaresResidual <= solver->m_leastSquaresResidualThreshold;
            return s->answer();
          }};
}

Work lemke(const Problem& p, double) {
  auto s = state(p);
  for (int i = 0; i < s->b.rows(); ++i) s->b[i] = -s->b[i];  // here M z + q
  return {{},
          [s] {
            btLemkeAlgorithm solver(s->A, s->b);
            s->x = solver.solve(static_cast<unsigned>(std::max(10000, 100 * s->b.rows())));
            s->info = solver.getInfo(), s->steps = solver.getSteps();
          },
          [s] {  // it returns w and z in one vector of 2 n
            const int n = s->b.rows();
            Answer a{s->info == 0, s->steps, "info " + std::to_string(s->info), {}};
            for (int i = 0; i < n; ++i) a.z.push_back(s->x.rows() == 2 * n ? s->x[n + i] : NAN);
            return a;
          }};
}

}  // namespace

int main(int argc, char** argv) {
  return drive(argc, argv, {{"dantzig", "friction", dantzig}, {"pgs", "friction", pgs}, {"lemke", "pure", lemke}});
}
