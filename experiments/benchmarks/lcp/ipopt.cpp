// Ipopt by itself, without Orthant's polishing: ½ zᵀA z + bᵀz between bounds; symmetric A, boxes.
#include <coin/IpStdCInterface.h>

#include "driver.h"

#include <memory>

using namespace rival;

namespace {

struct State {
  Problem p;
  std::vector<double> z;
  IpoptProblem nlp = nullptr;
  int status = -1, iterations = 0;

  std::vector<double> gradient(const double* x) const {
    std::vector<double> w = p.b;
    for (std::size_t i = 0; i < w.size(); ++i)
      for (auto k = static_cast<std::size_t>(p.start[i]); k < static_cast<std::size_t>(p.start[i + 1]); ++k)
        w[i] += p.value[k] * x[p.column[k]];
    return w;
  }
};

Bool objective(Index n, Number* x, Bool, Number* value, UserDataPtr data) {
  const auto* s = static_cast<const State*>(data);
  const std::vector<double> w = s->gradient(x);
  *value = 0;
  for (int i = 0; i < n; ++i)
    *value += x[i] * (w[static_cast<std::size_t>(i)] + s->p.b[static_cast<std::size_t>(i)]) / 2;
  return TRUE;
}
Bool gradient(Index, Number* x, Bool, Number* g, UserDataPtr data) {
  const std::vector<double> w = static_cast<const State*>(data)->gradient(x);
  std::copy(w.begin(), w.end(), g);
  return TRUE;
}
Bool none(Index, Number*, Bool, Index, Number*, UserDataPtr) { return TRUE; }
Bool none(Index, Number*, Bool, Index, Index, Index*, Index*, Number*, UserDataPtr) { return TRUE; }
Bool hessian(Index n, Number*, Bool, Number factor, Index, Number*, Bool, Index, Index* row, Index* column,
             Number* value, UserDataPtr data) {
  const Problem& p = static_cast<const State*>(data)->p;
  std::size_t at = 0;
  for (int i = 0; i < n; ++i)
    for (auto k = static_cast<std::size_t>(p.start[static_cast<std::size_t>(i)]);
         k < static_cast<std::size_t>(p.start[static_cast<std::size_t>(i) + 1]); ++k)
      if (p.column[k] <= i) {
        if (value != nullptr)
          value[at] = factor * p.value[k];
        else
          row[at] = i, column[at] = p.column[k];
        ++at;
      }
  return TRUE;
}
Bool count(Index, Index iteration, Number, Number, Number, Number, Number, Number, Number, Number, Index,
           UserDataPtr data) {
  static_cast<State*>(data)->iterations = iteration;
  return TRUE;
}

Work quadratic(const Problem& p, double tolerance) {
  if (p.n > 5000 ? false : !p.symmetric()) throw Unsupported("not symmetric");
  auto s = std::make_shared<State>();
  s->p = p;
  Index lower = 0;
  for (std::size_t i = 0; i < p.b.size(); ++i)
    for (auto k = static_cast<std::size_t>(p.start[i]); k < static_cast<std::size_t>(p.start[i + 1]); ++k)
      lower += p.column[k] <= static_cast<int>(i);
  s->nlp = CreateIpoptProblem(static_cast<Index>(p.n), s->p.lo.data(), s->p.hi.data(), 0, nullptr, nullptr, 0, lower, 0,
                              objective, none, gradient, none, hessian);
  const auto option = [&](std::string name, double value) { AddIpoptNumOption(s->nlp, name.data(), value); };
  option("tol", tolerance), option("compl_inf_tol", tolerance), option("dual_inf_tol", tolerance);
  option("bound_relax_factor", 0);  // its default, 1e-8, is an error of that size in z
  for (std::string name : {"print_level", "acceptable_iter"}) AddIpoptIntOption(s->nlp, name.data(), 0);
  for (std::string name : {"sb", "hessian_constant"}) AddIpoptStrOption(s->nlp, name.data(), std::string("yes").data());
  SetIntermediateCallback(s->nlp, count);
  return {[s] { s->z.assign(s->p.b.size(), 0); },
          [s] { s->status = IpoptSolve(s->nlp, s->z.data(), nullptr, nullptr, nullptr, nullptr, nullptr, s.get()); },
          [s] {
            return Answer{s->status == 0, s->iterations, "status " + std::to_string(s->status), s->z};
          }};
}

}  // namespace

int main(int argc, char** argv) { return drive(argc, argv, {{"quadratic", "boxes", quadratic}}); }
