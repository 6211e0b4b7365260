// A plugin: a solver, an integrator and a scene of your own under names, for the command, sweeps and the shoot-out.
//   c++ -std=c++20 -O2 -shared -fPIC plugin.cpp -o plugin.so $(pkg-config --cflags orthant)
//   orthant --plugin ./plugin.so solve problem.json --solver mine:omega=1.2
#include <orthant/core/mechanics/dynamics/terms.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/integrators/registry.h>
#include <orthant/solvers/registry.h>

#include <algorithm>
#include <stdexcept>

namespace {

struct MineOptions {
  double omega = 1;       // relaxation
  int max_sweeps = 1000;  // then iteration_limit
  template <class V> void visit(V&& v) { v("omega", omega, 0.1, 1.9), v("max_sweeps", max_sweeps, 1, 1000000); }
};

/// Projected Gauss-Seidel for dense problems. The judge stays Orthant's.
class Mine final : public orthant::Solver {
 public:
  using Options = MineOptions;
  explicit Mine(const Options& options) : options_(options) {}
  std::string why_not(const orthant::Lcp& p) const override {
    const bool good = p.friction.empty() && std::holds_alternative<orthant::DenseMatrix>(p.A) &&
                      (std::get<orthant::DenseMatrix>(p.A).diagonal().array() > 0).all();
    return good ? "" : "needs a dense matrix with a positive diagonal, and no friction";
  }

 private:
  orthant::Claim run(const orthant::Lcp& p, orthant::Solution& s, orthant::Start) override {
    const auto& M = std::get<orthant::DenseMatrix>(p.A);
    for (s.iterations = 0; s.iterations < options_.max_sweeps; ++s.iterations) {
      if (passes(p, s)) return orthant::Claim::candidate;  // the judge would take it
      for (orthant::Index i = 0; i < p.size(); ++i)
        s.z[i] = std::clamp(s.z[i] - options_.omega * (M.row(i).dot(s.z) + p.b[i]) / M(i, i), p.lo[i], p.hi[i]);
    }
    return orthant::Claim::iteration_limit;
  }
  double tolerance() const override { return 1e-10; }
  Options options_;
};

/// Symplectic Euler of free bodies: v += h f / M, then q += h v.
class FreeEuler final : public orthant::Integrator {
 public:
  FreeEuler(const orthant::System& system, std::string_view name)
      : orthant::Integrator(system, name, orthant::Capabilities{}), terms_(system) {
    if (system.contacts() > 0 || system.joint_rows() > 0)
      throw std::invalid_argument(std::string(name) + ": takes bodies without contacts and joints only");
  }
  orthant::StepReport step(double h, orthant::Solver&, orthant::State& x) override {
    set_poses(system_, x.t, x.q, terms_.at);
    set_twists(system_, x.v, terms_.at);
    evaluate_forces(system_, x.t, x.v, terms_);
    x.v += h * system_.inverse_mass().cwiseProduct(terms_.f);
    x.q += h * x.v;
    x.t += h;
    return orthant::StepReport::solved();
  }
  void remember(orthant::CheckpointData&) override {}  // nothing is kept from step to step
  const orthant::Lcp& problem() const override { return none_; }

 private:
  orthant::Terms terms_;
  orthant::Lcp none_;
};

orthant::Scene falling_disc(std::span<const std::string>) {
  orthant::Scene s{.gravity = {0, -9.81}};
  const auto disc = s.body({.name = "disc", .mass = 1, .inertia = 0.005, .position = {0, 0.5}});
  s.contact(orthant::DiscWall{.name = "floor", .a = disc, .radius = 0.1, .normal = {0, 1}, .law = {.e = 0.5}});
  return s;
}

}  // namespace

extern "C" void orthant_plugin() {
  orthant::register_solver<Mine>("mine", "projected Gauss-Seidel of our own; dense, positive diagonal");
  orthant::register_integrator(
      {.name = "free-euler",
       .summary = "symplectic Euler of free bodies",
       .make = [](const orthant::System& system,
                  std::string_view) { return std::make_unique<FreeEuler>(system, "free-euler"); },
       .make_spatial = nullptr,
       .options = [] { return std::vector<orthant::OptionEntry>(); },
       .can = {}});
  orthant::register_scene(
      {"falling-disc", "a disc falls on a floor", &falling_disc, [] { return std::vector<orthant::OptionEntry>(); }});
}
