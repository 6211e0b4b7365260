// integrators/run_fields.h — fields of a run's summary: name, unit and meaning, in one list for every output.
//
//   visit_fields(run, [](const char* name, const char* unit, const char* meaning, auto& value) { … });
//
//   The JSON and the Python summary, the rows of a sweep, checkpoints, `orthant list summary` and the documentation's
//   table come from this list. value is a long or a double. Infinity: the run has no such value, and outputs leave it
//   out.
#pragma once

#include <orthant/integrators/simulate.h>

namespace orthant {

/// RunType: Run or const Run.
template <class RunType, class Visit> void visit_fields(RunType& run, Visit&& visit) {
  auto& motion = run.motion;
  visit("steps", "", "completed output steps", run.steps);
  visit("seconds", "s", "wall time of the steps, without recording", run.seconds);
  visit("energy_initial", "J", "energy at the start", run.energy_initial);
  visit("energy_final", "J", "energy at the end", run.energy_final);
  visit("max_joint_residual", "m, rad", "largest residual of the joints", run.max_joint_residual);
  visit("max_joint_rate", "m/s, rad/s", "largest rate of the joints, of schemes that keep them at velocity level",
        run.max_joint_rate);
  visit("max_penetration", "m", "largest overlap of a contact", run.max_penetration);
  visit("max_penetration_time", "s", "its time", run.max_penetration_time);
  visit("smallest_clearance", "m", "smallest clearance of the scene", motion.smallest_clearance);
  visit("work", "J", "work of drives, loads and moving surfaces", motion.work);
  visit("energy_defect", "J",
        "rise of energy - work above its least value before; any change, where nothing dissipates",
        motion.energy_defect);
  visit("energy_defect_time", "s", "its time", motion.energy_defect_time);
  visit("energy_scale", "J", "kinetic energy of the start, potential energy released, sum of |work|",
        motion.energy_scale);
  visit("max_lcp_residual", "m/s", "largest residual of a step's problem", run.max_lcp_residual);
  visit("accepted", "", "inner steps accepted", run.accepted);
  visit("rejected", "", "inner steps rejected", run.rejected);
  visit("events", "", "located events", run.events);
  visit("crossings", "", "crowds of events crossed to first order", run.crossings);
  visit("error_estimate", "m, rad", "error of the final coordinates; 0: the integrator has no estimate",
        run.error_estimate);
  visit("rotation_error", "rad", "estimated error of free rotation in space, of integrators of fixed step",
        run.rotation_error);
  visit("energy_rises", "", "impacts (a fixed step's count as one) and crossings that raised the energy",
        run.energy_rises);
  visit("max_energy_rise", "J", "largest of these rises", run.max_energy_rise);
  visit("max_energy_rise_time", "s", "time of that event, or end of that step", run.max_energy_rise_time);
  visit("passages", "", "steps in which bodies passed through each other", run.passages);
  visit("first_passage_time", "s", "end of the first such step", run.first_passage_time);
  visit("rounded_steps", "", "steps with a problem that is rounded only", run.rounded_steps);
  visit("first_rounded_time", "s", "end of the first such step", run.first_rounded_time);
  visit("plastic_steps", "", "steps with impacts that friction kept from rebounding", run.plastic_steps);
  visit("first_plastic_time", "s", "end of the first such step", run.first_plastic_time);
  visit("undetermined_steps", "", "steps in which friction depends on a share of load that rigid bodies leave open",
        run.undetermined_steps);
  visit("first_undetermined_time", "s", "end of the first such step", run.first_undetermined_time);
  visit("lcp_solves", "", "problems solved", run.lcp_solves);
  visit("lcp_iterations", "", "iterations of the solver in them", run.lcp_iterations);
}

}  // namespace orthant
