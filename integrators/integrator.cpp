#include <orthant/core/support/options.h>
#include <orthant/integrators/integrator.h>

#include <algorithm>
#include <stdexcept>

namespace orthant {

bool StepReport::note(int rows, Status status_of_it, double residual, int iterations, const Miss& missed) {
  if (status_of_it == Status::rounded && rounded++ == 0) miss = missed;
  status = has_answer(status_of_it) ? Status::solved : status_of_it;
  if (status == Status::solved) lcp_residual = std::max(lcp_residual, residual);
  lcp_rows = std::max(lcp_rows, rows);
  lcp_iterations += iterations;
  ++lcp_solves;
  return status == Status::solved;
}

void Integrator::employ(std::vector<std::unique_ptr<Solver>> helpers) {
  crew_ = std::make_unique<Crew>(std::move(helpers));
}

void Integrator::refuse_loaded_friction(std::string_view scheme) const {
  for (const JointFriction& f : system_.scene().frictions)
    if (f.loaded())
      throw std::invalid_argument(
          "integrator " + std::string(scheme) + ": friction \"" + f.name +
          "\" depends on the joint's load: mu must be 0, or the integrator one that knows it, " +
          "such as moreau-jean or stewart-trinkle");
}

void Integrator::refuse_tangential_restitution(std::string_view scheme) const {
  const auto refuse = [&](const std::string& what, const ContactLaw& law) {
    if (law.e_t != 0)
      throw std::invalid_argument(
          "integrator " + std::string(scheme) + ": " + what + " has e_t = " + detail::text_of(law.e_t) +
          ": must be 0, or the integrator one that knows it, " + "such as moreau-jean or stewart-trinkle");
  };
  for (int i = 0; i < system_.listed(); ++i)
    refuse("contact \"" + std::visit([](const auto& c) { return c.name; }, system_.scene().contacts[at(i)]) + "\"",
           system_.law(i));
  for (const Collision& c : system_.scene().collisions) refuse("collision \"" + c.name + "\"", c.law);
}

bool Integrator::fail(StepReport& report, Status status, std::string why) {
  report.status = status;
  why_ = std::move(why);
  return false;
}

}  // namespace orthant
