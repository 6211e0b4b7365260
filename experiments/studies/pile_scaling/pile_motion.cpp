#include "experiments/studies/pile_scaling/pile_motion.h"

#include <chrono>
#include <sstream>

namespace orthant {

std::string with(const std::string& spec, double tolerance, int threads) {
  std::ostringstream full;
  full << spec << (spec.find(':') == std::string::npos ? ':' : ',') << "tolerance=" << tolerance;
  if (threads > 1) full << ",threads=" << threads;
  return full.str();
}

std::uint64_t hash_of(const Eigen::VectorXd& x, std::uint64_t hash) {
  return fnv1a({reinterpret_cast<const char*>(x.data()), static_cast<std::size_t>(x.size()) * sizeof(double)}, hash);
}

double wall_time() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

std::vector<std::unique_ptr<Solver>> solvers_of(const Settling& way) {
  std::vector<std::unique_ptr<Solver>> solvers;
  for (const int threads : way.threads) {
    solvers.push_back(make_solver(with(way.by, way.tolerance, threads)));
    solvers.back()->set_time_limit(way.time_limit);
  }
  return solvers;
}

Bodies bodies_of(const std::string& name, const Pour& pouring) {
  Bodies bodies{name, name == "discs" ? Kind::discs : name == "well" ? Kind::well : Kind::pour, pouring};
  for (std::size_t i = 0; i < Pour::kBodiesNames.size(); ++i)
    if (name == Pour::kBodiesNames[i]) bodies.pouring.bodies = static_cast<Pour::Bodies>(i);
  return bodies;
}

}  // namespace orthant
