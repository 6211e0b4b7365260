// Friction discs: the forms that methods of linear problems have for them.
#include <orthant/solvers/active_set/interior_point.h>
#include <orthant/solvers/active_set/newton_fb.h>
#include <orthant/solvers/active_set/newton_min.h>
#include <orthant/solvers/automatic.h>
#include <orthant/solvers/cones/cone_admm.h>
#include <orthant/solvers/cones/cone_apgd.h>
#include <orthant/solvers/cones/cone_auto.h>
#include <orthant/solvers/cones/cone_interior_point.h>
#include <orthant/solvers/cones/cone_pgs.h>
#include <orthant/solvers/cones/newton_ac.h>
#include <orthant/solvers/first_order/admm.h>
#include <orthant/solvers/first_order/apgd.h>
#include <orthant/solvers/first_order/nncg.h>
#include <orthant/solvers/first_order/pgs.h>
#include <orthant/solvers/first_order/psor.h>
#include <orthant/solvers/first_order/sgs.h>

namespace orthant {

std::unique_ptr<Solver> Pgs::for_discs() const {
  return std::make_unique<ConePgs>(ConePgs::Options{.tolerance = options_.tolerance,
                                                    .omega = options_.omega,
                                                    .max_sweeps = options_.max_sweeps,
                                                    .threads = options_.threads});
}

std::unique_ptr<Solver> Nncg::for_discs() const {
  return std::make_unique<ConePgs>(ConePgs::Options{.tolerance = options_.tolerance,
                                                    .max_sweeps = options_.max_sweeps,
                                                    .accelerated = true,
                                                    .threads = options_.threads});
}

std::unique_ptr<Solver> Psor::for_discs() const {
  return std::make_unique<ConePgs>(ConePgs::Options{.tolerance = options_.tolerance,
                                                    .omega = options_.omega == 0 ? 1.4 : options_.omega,
                                                    .max_sweeps = options_.max_sweeps,
                                                    .threads = options_.threads});
}

std::unique_ptr<Solver> Sgs::for_discs() const {
  return std::make_unique<ConePgs>(ConePgs::Options{.tolerance = options_.tolerance,
                                                    .max_sweeps = options_.max_sweeps,
                                                    .symmetric = true,
                                                    .threads = options_.threads});
}

std::unique_ptr<Solver> Admm::for_discs() const {
  return std::make_unique<ConeAdmm>(ConeAdmm::Options{.tolerance = options_.tolerance,
                                                      .rho = options_.rho,
                                                      .max_iterations = options_.max_iterations,
                                                      .adapt = options_.adapt});
}

std::unique_ptr<Solver> Apgd::for_discs() const {
  return std::make_unique<ConeApgd>(
      ConeApgd::Options{.tolerance = options_.tolerance, .max_iterations = options_.max_iterations});
}

std::unique_ptr<Solver> NewtonMin::for_discs() const {
  return std::make_unique<NewtonAc>(NewtonAcOptions{
      .tolerance = options_.tolerance, .max_steps = options_.max_iterations, .map = ContactMap::natural});
}

std::unique_ptr<Solver> NewtonFb::for_discs() const {
  return std::make_unique<NewtonAc>(NewtonAcOptions{
      .tolerance = options_.tolerance, .max_steps = options_.max_iterations, .map = ContactMap::fischer_burmeister});
}

std::unique_ptr<Solver> InteriorPoint::for_discs() const {
  return std::make_unique<ConeInteriorPoint>(
      ConeInteriorPoint::Options{.tolerance = options_.tolerance, .max_iterations = options_.max_iterations});
}

std::unique_ptr<Solver> Automatic::for_discs() const { return std::make_unique<ConeAuto>(options_.tolerance); }

}  // namespace orthant
