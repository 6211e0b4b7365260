#include "experiments/studies/identify/fit.h"

#include "experiments/studies/identify/nlopt_search.h"
#include "experiments/studies/identify/timed.h"

#include <orthant/core/scenes/slider_crank.h>
#include <orthant/integrators/derivatives/motion_tangent.h>
#include <orthant/integrators/simulate.h>
#include <orthant/solvers/registry.h>

#include <Eigen/Cholesky>
#include <IpIpoptApplication.hpp>
#include <IpTNLP.hpp>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace orthant {

namespace {

using Three = Eigen::Vector3d;  // μ, e, c in units of kUnit
const Three kUnit(0.02, 0.3, 0.0015), kLow(0.1, 0.3, 0.4), kHigh(3, 2, 2);

Scene scene_at(const Three& x) {
  return slider_crank({.mu = x[0] * kUnit[0], .e = x[1] * kUnit[1], .clearance = x[2] * kUnit[2]});
}

class Fit {
 public:
  Fit(double duration, int samples, double sigma) : duration_(duration), every_(duration / samples), sigma_(sigma) {}

  Eigen::VectorXd angles(const Three& x) {
    ++runs;
    const System system(scene_at(x));
    EventDriven integrator(system);
    std::vector<double> theta;
    const Run run = simulate(integrator, *solver_, {.step = every_, .duration = duration_},
                             [&](const RunSample& moment) { theta.push_back(moment.state.q[2]); });
    if (run.status != Status::solved) throw std::runtime_error("event-driven: " + run.why);
    return Eigen::Map<Eigen::VectorXd>(theta.data(), std::ssize(theta));
  }
  /// And J, in units of kUnit.
  Eigen::VectorXd angles(const Three& x, Eigen::MatrixXd& J) {
    ++gradients;
    const System system(scene_at(x));
    std::vector<RunParameter> parameters;
    for (int k = 0; k < 3; ++k)
      parameters.push_back({"x" + std::to_string(k), x[k],
                            [x, k](double value) {
                              Three other = x;
                              other[k] = value;
                              return scene_at(other);
                            },
                            -1});
    std::vector<double> theta, slopes;
    const MotionTangent t =
        differentiate_motion(system, parameters, {}, *solver_, duration_, every_,
                             [&](const State& s, const Eigen::MatrixXd& dq, const Eigen::MatrixXd&) {
                               theta.push_back(s.q[2]);
                               for (int k = 0; k < 3; ++k) slopes.push_back(dq(2, k));
                             });
    if (t.status != Status::solved) throw std::runtime_error("event-driven: " + t.why);
    if (!t.none.empty()) throw std::runtime_error("no derivative: " + t.none);
    J = Eigen::Map<Eigen::MatrixXd>(slopes.data(), 3, std::ssize(theta)).transpose();
    return Eigen::Map<Eigen::VectorXd>(theta.data(), std::ssize(theta));
  }
  void measure(const Three& truth, unsigned seed) {
    data_ = angles(truth);
    std::mt19937_64 random(seed);
    std::normal_distribution<double> noise(0, sigma_);
    for (double& y : data_) y += noise(random);
  }
  double cost(const Three& x) { return (angles(x) - data_).squaredNorm() / (2 * sigma_ * sigma_); }
  double cost(const Three& x, Three& gradient) {
    Eigen::MatrixXd J;
    const Eigen::VectorXd r = angles(x, J) - data_;
    gradient = J.transpose() * r / (sigma_ * sigma_);
    return r.squaredNorm() / (2 * sigma_ * sigma_);
  }
  /// Gauss–Newton's matrix and right-hand side.
  double normal_equations(const Three& x, Eigen::Matrix3d& H, Three& g) {
    Eigen::MatrixXd J;
    const Eigen::VectorXd r = angles(x, J) - data_;
    H = J.transpose() * J / (sigma_ * sigma_), g = J.transpose() * r / (sigma_ * sigma_);
    return r.squaredNorm() / (2 * sigma_ * sigma_);
  }

  int runs = 0, gradients = 0;

 private:
  double duration_, every_, sigma_;
  std::unique_ptr<Solver> solver_ = make_solver("auto");
  Eigen::VectorXd data_;
};

void by_nlopt(nlopt_algorithm algorithm, Fit& fit, Three& x) {
  Eigen::VectorXd at = x;
  search(
      {.algorithm = algorithm, .low = kLow, .high = kHigh, .x_relative = 1e-6, .most = 500},
      [&](const Eigen::VectorXd& to, Eigen::VectorXd* gradient) {
        if (gradient == nullptr) return fit.cost(Three(to));
        Three g;
        const double value = fit.cost(Three(to), g);
        *gradient = g;
        return value;
      },
      at);
  x = at;
}

class IpoptFit final : public Ipopt::TNLP {
 public:
  IpoptFit(Fit& fit, Three& x) : fit_(fit), x_(x) {}

 private:
  using Number = Ipopt::Number;
  using Int = Ipopt::Index;
  bool get_nlp_info(Int& n, Int& m, Int& in_jacobian, Int& in_hessian, IndexStyleEnum& style) override {
    n = 3, m = in_jacobian = 0, in_hessian = 6, style = C_STYLE;
    return true;
  }
  bool get_bounds_info(Int /*n*/, Number* low, Number* high, Int /*m*/, Number* /*g_l*/, Number* /*g_u*/) override {
    Eigen::Map<Three>(low, 3) = kLow, Eigen::Map<Three>(high, 3) = kHigh;
    return true;
  }
  bool get_starting_point(Int /*n*/, bool /*has_x*/, Number* x, bool /*has_z*/, Number* /*z_l*/, Number* /*z_u*/,
                          Int /*m*/, bool /*has_lambda*/, Number* /*lambda*/) override {
    Eigen::Map<Three>(x, 3) = x_;
    return true;
  }
  bool eval_f(Int /*n*/, const Number* x, bool /*fresh*/, Number& f) override {
    f = fit_.cost(Three(x[0], x[1], x[2]));
    return true;
  }
  bool eval_grad_f(Int /*n*/, const Number* x, bool /*fresh*/, Number* gradient) override {
    Three g;
    fit_.cost(Three(x[0], x[1], x[2]), g);
    Eigen::Map<Three>(gradient, 3) = g;
    return true;
  }
  bool eval_g(Int /*n*/, const Number* /*x*/, bool /*fresh*/, Int /*m*/, Number* /*g*/) override { return true; }
  bool eval_jac_g(Int /*n*/, const Number* /*x*/, bool /*fresh*/, Int /*m*/, Int /*entries*/, Int* /*row*/,
                  Int* /*column*/, Number* /*value*/) override {
    return true;
  }
  void finalize_solution(Ipopt::SolverReturn /*status*/, Int /*n*/, const Number* x, const Number* /*z_l*/,
                         const Number* /*z_u*/, Int /*m*/, const Number* /*g*/, const Number* /*lambda*/, Number /*f*/,
                         const Ipopt::IpoptData* /*data*/, Ipopt::IpoptCalculatedQuantities* /*more*/) override {
    x_ = Three(x[0], x[1], x[2]);
  }
  Fit& fit_;
  Three& x_;
};

void by_ipopt(Fit& fit, Three& x) {
  Ipopt::SmartPtr<Ipopt::IpoptApplication> application = IpoptApplicationFactory();
  application->Options()->SetIntegerValue("print_level", 0);
  application->Options()->SetStringValue("sb", "yes");
  application->Options()->SetStringValue("hessian_approximation", "limited-memory");
  application->Options()->SetNumericValue("tol", 1e-6);
  application->Options()->SetIntegerValue("max_iter", 100);
  if (application->Initialize() != Ipopt::Solve_Succeeded) throw std::runtime_error("Ipopt does not start");
  application->OptimizeTNLP(new IpoptFit(fit, x));
}

void by_gauss_newton(Fit& fit, Three& x) {
  for (int pass = 0; pass < 50; ++pass) {
    Eigen::Matrix3d H;
    Three g;
    const double now = fit.normal_equations(x, H, g);
    const Three step = H.ldlt().solve(-g);
    double length = 1;
    Three next = x;
    for (; length > 1e-6; length /= 2) {
      next = (x + length * step).cwiseMax(kLow).cwiseMin(kHigh);
      if (fit.cost(next) <= now) break;
    }
    const double moved = (next - x).cwiseQuotient(x).lpNorm<Eigen::Infinity>();
    x = next;
    if (moved < 1e-6) break;
  }
}

}  // namespace

Table fit_parameters(const FitPlan& plan) {
  const Three truth = Three(0.01, 0.4, 0.001).cwiseQuotient(kUnit);
  std::cout << "Friction, restitution and clearance of the slider-crank\n"
            << "data: theta_1 at " << plan.samples << " times up to " << plan.duration << " s, noise " << plan.sigma
            << " rad, seed " << plan.seed << "\ntrue: mu = 0.01, e = 0.4, c = 0.001 m; start: mu = " << kUnit[0]
            << ", e = " << kUnit[1] << ", c = " << kUnit[2] << " m\n\n";
  Table table{"method", "derivatives", "mu", "e", "c [m]", "cost", "runs", "runs with J", "seconds", "failure"};
  struct Method {
    const char *name, *derivatives;
    std::function<void(Fit&, Three&)> run;
  };
  const auto nlopt = [](nlopt_algorithm algorithm) {
    return [algorithm](Fit& fit, Three& x) { by_nlopt(algorithm, fit, x); };
  };
  const Method methods[] = {{"NLopt BOBYQA", "no", nlopt(NLOPT_LN_BOBYQA)},
                            {"NLopt COBYLA", "no", nlopt(NLOPT_LN_COBYLA)},
                            {"NLopt Nelder-Mead", "no", nlopt(NLOPT_LN_NELDERMEAD)},
                            {"NLopt L-BFGS", "gradient", nlopt(NLOPT_LD_LBFGS)},
                            {"NLopt SLSQP", "gradient", nlopt(NLOPT_LD_SLSQP)},
                            {"Ipopt", "gradient", by_ipopt},
                            {"Gauss-Newton", "J", by_gauss_newton}};
  Three best = Three::Ones();
  double least = kInf;
  for (const Method& method : methods) {
    Fit fit(plan.duration, plan.samples, plan.sigma);
    fit.measure(truth, plan.seed);
    fit.runs = 0;
    Three x = Three::Ones();
    const Timed timed = time_of([&] { method.run(fit, x); });
    const int runs = fit.runs, gradients = fit.gradients;
    const double cost = fit.cost(x);
    if (cost < least) least = cost, best = x;
    const Three value = x.cwiseProduct(kUnit);
    table.row({method.name, method.derivatives, Table::Number{value[0]}, Table::Number{value[1]},
               Table::Number{value[2]}, Table::Number{cost}, runs, gradients, Table::Number{timed.seconds, 3},
               timed.failure});
  }
  Fit fit(plan.duration, plan.samples, plan.sigma);
  fit.measure(truth, plan.seed);
  Eigen::Matrix3d H;
  Three g;
  fit.normal_equations(best, H, g);
  const Three bars = H.inverse().diagonal().cwiseSqrt().cwiseProduct(kUnit), value = best.cwiseProduct(kUnit);
  std::cout << std::setprecision(6) << "\nmu = " << value[0] << " +- " << bars[0] << "\ne = " << value[1] << " +- "
            << bars[1] << "\nc = " << value[2] << " +- " << bars[2] << " m   (one standard deviation)\n\n";
  return table;
}

}  // namespace orthant
