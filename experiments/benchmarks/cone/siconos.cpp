// Siconos Numerics: its solvers of local 3-D contact problems, with their default options besides tolerance and
// iteration limits.
#include "driver.h"

#include <FrictionContactProblem.h>
#include <Friction_cst.h>
#include <NonSmoothDrivers.h>
#include <NumericsMatrix.h>
#include <SolverOptions.h>
#include <fc3d_Solvers.h>

#include <memory>

using namespace rival;

namespace {

struct Siconos {
  std::vector<double> q, mu, r, u;
  NumericsMatrix* W;
  FrictionContactProblem problem;
  SolverOptions* options;
  int info = 0;

  Siconos(const Problem& p, int id, double tolerance, int iterations) : q(p.b), mu(p.mu), r(q.size()), u(q.size()) {
    const int n = static_cast<int>(p.n);
    W = NM_create(NM_SPARSE, n, n);
    NM_triplet_alloc(W, static_cast<int>(p.value.size()));
    for (int i = 0; i < n; ++i)
      for (auto k = p.start[static_cast<std::size_t>(i)]; k < p.start[static_cast<std::size_t>(i) + 1]; ++k)
        NM_entry(W, i, p.column[static_cast<std::size_t>(k)], p.value[static_cast<std::size_t>(k)]);
    problem = {3, n / 3, W, q.data(), mu.data()};
    options = solver_options_create(id);
    options->dparam[SICONOS_DPARAM_TOL] = tolerance;
    options->iparam[SICONOS_IPARAM_MAX_ITER] = iterations;
  }
};

/// Contact by contact: normal, two friction rows.
bool ordered(const Problem& p) {
  if (p.n != 3 * static_cast<std::int64_t>(p.mu.size())) return false;
  for (std::size_t k = 0; k < p.mu.size(); ++k)
    if (p.friction_row[k] != static_cast<int>(3 * k + 1) || p.friction_normal[k] != static_cast<int>(3 * k) ||
        p.friction_rows[k] != 2)
      return false;
  return true;
}

Method method(const char* name, int id, int iterations) {
  return {name, "discs", [=](const Problem& p, double tolerance) -> Work {
            if (!ordered(p)) throw Unsupported("not three rows a contact");
            auto s = std::make_shared<Siconos>(p, id, tolerance, iterations);
            return {[s] {
                      std::fill(s->r.begin(), s->r.end(), 0.0);
                      std::fill(s->u.begin(), s->u.end(), 0.0);
                    },
                    [s] { s->info = fc3d_driver(&s->problem, s->r.data(), s->u.data(), s->options); },
                    [s] {
                      return Answer{s->info == 0, s->options->iparam[SICONOS_IPARAM_ITER_DONE],
                                    "info " + std::to_string(s->info), s->r};
                    }};
          }};
}

}  // namespace

int main(int argc, char** argv) {
  return drive(argc, argv,
               {method("nsgs", SICONOS_FRICTION_3D_NSGS, 20000), method("nsn-ac", SICONOS_FRICTION_3D_NSN_AC, 1000),
                method("nsn-fb", SICONOS_FRICTION_3D_NSN_FB, 1000), method("nsn-nm", SICONOS_FRICTION_3D_NSN_NM, 1000),
                method("admm", SICONOS_FRICTION_3D_ADMM, 20000), method("prox", SICONOS_FRICTION_3D_PROX, 1000),
                method("vi-eg", SICONOS_FRICTION_3D_VI_EG, 20000)});
}
