// A step of rattle, as its derivative needs it: see rattle_linearization.h.
#include <orthant/integrators/derivatives/rattle_linearization.h>

namespace orthant {

void RattleTrace::take(const Rattle& integrator, const State& x, double duration, const State& end) {
  const System& system = integrator.system();
  h = duration, before = x, after = end, froze_again = integrator.froze_again();
  contacts.clear();
  const auto mu_in = [](const Formulation& formulation, Index row) {
    for (const Friction& f : formulation.step_problem().friction())
      if (f.first == row) return f.mu;
    return 0.0;
  };
  const auto fill = [&](Stage& stage, const Formulation& formulation, Index normal, Index tangent, double mu) {
    stage.has_normal = normal >= 0, stage.has_tangent = tangent >= 0;
    if (stage.has_normal) stage.normal = formulation.solution().z[normal];
    if (stage.has_tangent) stage.tangent = formulation.solution().z[tangent];
    if (stage.has_tangent) stage.mu = mu_in(formulation, tangent), stage.is_static = stage.mu != mu;
  };
  const Formulation &positions = integrator.positions(), &velocities = integrator.velocities();
  for (std::size_t k = 0; k < integrator.closed().size(); ++k) {
    Contact c;
    c.contact = integrator.closed()[k].contact;
    const ContactLaw& law = system.law(c.contact);
    if (positions.size() > 0)
      positions.step_problem().each_contact([&](Index normal, Index, Index tangent, const StepProblem::Contact& other) {
        if (other.index == c.contact) fill(c.position, positions, normal, tangent, law.mu);
      });
    if (velocities.size() > 0)
      fill(c.velocity, velocities, velocities.normal_row(k), velocities.tangent_row(k), law.mu);
    const double approach = apply(integrator.closed_at_start()[k].rows.normal, x.v.data());
    c.strikes = -approach > kRestSpeed * law.unit;
    c.rebounds = integrator.rebounds(k, h, x);
    c.at_surface = integrator.targets()[k].normal != -law.e * approach;
    contacts.push_back(c);
  }
  const auto frictions = static_cast<Index>(system.scene().frictions.size());
  friction_position.setZero(frictions), friction_velocity.setZero(frictions);
  for (Index i = 0; i < frictions; ++i) {
    friction_position[i] = positions.joint_friction(at(i));
    friction_velocity[i] = velocities.joint_friction(at(i));
  }
}

}  // namespace orthant
