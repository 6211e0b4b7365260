// Siconos Numerics: its dense LCP solvers, with their default options besides tolerance and iteration limits.
#include "driver.h"

#include <LCP_Solvers.h>
#include <LinearComplementarityProblem.h>
#include <NonSmoothDrivers.h>
#include <NumericsMatrix.h>
#include <SolverOptions.h>
#include <lcp_cst.h>

#include <memory>

using namespace rival;

namespace {

struct Siconos {
  std::vector<double> A, q, z, w;
  NumericsMatrix* M;
  LinearComplementarityProblem problem;
  SolverOptions* options;
  int info = 0;

  Siconos(const Problem& p, int id, double tolerance, int iterations)
      : A(p.dense(static_cast<std::size_t>(p.n), false)), q(p.b), z(q.size()), w(q.size()) {
    const int n = static_cast<int>(p.n);
    M = NM_create_from_data(NM_DENSE, n, n, A.data());
    problem = {n, M, q.data()};
    options = solver_options_create(id);
    options->dparam[SICONOS_DPARAM_TOL] = tolerance;
    options->iparam[SICONOS_IPARAM_MAX_ITER] = iterations;
  }
};

Method method(const char* name, int id, int iterations_a_row, int least) {
  return {name, "pure", [=](const Problem& p, double tolerance) -> Work {
            if (p.n > 5000) throw Unsupported("dense: more than 5000 rows");
            const int iterations = std::max(least, iterations_a_row * static_cast<int>(p.n));
            auto s = std::make_shared<Siconos>(p, id, tolerance, iterations);
            return {[s] {
                      std::fill(s->z.begin(), s->z.end(), 0.0);
                      std::fill(s->w.begin(), s->w.end(), 0.0);
                    },
                    [s] { s->info = linearComplementarity_driver(&s->problem, s->z.data(), s->w.data(), s->options); },
                    [s] {
                      return Answer{s->info == 0, s->options->iparam[SICONOS_IPARAM_ITER_DONE],
                                    "info " + std::to_string(s->info), s->z};
                    }};
          }};
}

}  // namespace

int main(int argc, char** argv) {
  return drive(
      argc, argv,
      {method("lemke", SICONOS_LCP_LEMKE, 100, 10000), method("newton-fb", SICONOS_LCP_NEWTON_FB_FBLSA, 0, 1000),
       method("newton-min", SICONOS_LCP_NEWTON_MIN_FBLSA, 0, 1000), method("pgs", SICONOS_LCP_PGS, 0, 100000),
       method("murty", SICONOS_LCP_MURTY, 100, 10000),
       method("avi-cao-ferris", SICONOS_LCP_AVI_CAOFERRIS, 100, 10000)});
}
