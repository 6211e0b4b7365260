// DART: its Lemke (pure problems) and its copy of ODE's Dantzig solver (symmetric; boxes; friction by index).
#include "driver.h"

#include <dart/external/odelcpsolver/lcp.h>
#include <dart/lcpsolver/Lemke.hpp>

#include <limits>
#include <memory>

using namespace rival;

namespace {

Work lemke(const Problem& p, double) {
  if (p.n > 5000) throw Unsupported("dense: more than 5000 rows");
  struct State {
    Eigen::MatrixXd M;
    Eigen::VectorXd q, z;
    int error = 0;
  };
  auto s = std::make_shared<State>();
  s->M = Eigen::Map<const Eigen::MatrixXd>(p.dense(static_cast<std::size_t>(p.n), false).data(), p.n, p.n);
  s->q = Eigen::Map<const Eigen::VectorXd>(p.b.data(), p.n);
  return {
      [s] { s->z.setZero(s->q.size()); }, [s] { s->error = dart::lcpsolver::Lemke(s->M, s->q, &s->z); },
      [s] {
        return Answer{s->error == 0, 0, "error " + std::to_string(s->error), {s->z.data(), s->z.data() + s->z.size()}};
      }};
}

/// A x = b + w, lo ≤ 0 ≤ hi; rows of A padded to whole fours.
Work dantzig(const Problem& p, double) {
  if (p.n > 5000) throw Unsupported("dense: more than 5000 rows");
  if (!p.symmetric()) throw Unsupported("not symmetric");
  struct State {
    std::vector<double> A, b, lo, hi, x, w;  // as given
    std::vector<double> A_now, b_now, lo_now, hi_now;
    std::vector<int> findex, findex_now;
    bool solved = false;
  };
  auto s = std::make_shared<State>();
  const auto n = static_cast<std::size_t>(p.n), stride = n > 1 ? (n + 3) / 4 * 4 : n;
  s->A = p.dense(stride);
  for (std::size_t i = 0; i < n; ++i) {
    if (p.lo[i] > 0 || p.hi[i] < 0) throw Unsupported("a box without 0");
    s->b.push_back(-p.b[i]), s->lo.push_back(p.lo[i]), s->hi.push_back(p.hi[i]), s->findex.push_back(-1);
  }
  for (std::size_t k = 0; k < p.mu.size(); ++k) {
    const auto row = static_cast<std::size_t>(p.friction_row[k]);
    s->findex[row] = p.friction_normal[k], s->hi[row] = p.mu[k], s->lo[row] = -p.mu[k];
  }
  return {[s, n, stride] {
            s->A_now = s->A, s->b_now = s->b, s->lo_now = s->lo, s->hi_now = s->hi, s->findex_now = s->findex;
            s->A_now.resize(n * stride), s->x.assign(n, 0), s->w.assign(n, 0);
          },
          [s, n] {
            s->solved = dart::external::ode::dSolveLCP(static_cast<int>(n), s->A_now.data(), s->x.data(),
                                                       s->b_now.data(), s->w.data(), 0, s->lo_now.data(),
                                                       s->hi_now.data(), s->findex_now.data(), true);
          },
          [s] {
            return Answer{s->solved, 0, "", s->x};
          }};
}

}  // namespace

int main(int argc, char** argv) {
  return drive(argc, argv, {{"lemke", "pure", lemke}, {"ode-dantzig", "friction", dantzig}});
}
