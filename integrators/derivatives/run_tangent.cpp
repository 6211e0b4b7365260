#include <orthant/integrators/derivatives/run_tangent.h>

#include <cmath>

namespace orthant {

namespace {

template <class Options> RunTangent tangent_of_run(const System& system, const std::vector<RunParameter>& parameters,
                                                   const Options& options, Solver& solver, const Clock& clock,
                                                   const std::vector<RunColumn>& columns,
                                                   const TangentRecorder& record) {
  using Scheme = StepSchemeOf<Options>;
  check(clock);
  const auto count = static_cast<Index>(parameters.size());
  std::vector<ParameterChange> changes;
  for (const RunParameter& parameter : parameters) changes.push_back(changes_of(parameter, system, clock.duration));
  RunTangent result;
  result.warnings = one_sided_in_words(parameters, changes);
  typename Scheme::Integrator integrator(system, options);
  typename Scheme::Linearization linear(system, options);
  StartLinearization start(system);
  linear.begin_friction(begun_frictions(changes, system));
  ColumnSlopes slopes(system, columns);
  std::vector<StepPart> parts(parameters.size());
  typename Scheme::Linearization::Trace trace;
  std::vector<ImpulseChange> impulses(parameters.size());
  DirectionBlock dq = DirectionBlock::Zero(system.dof(), count), dv = dq;
  Eigen::VectorXd one_q, one_v;
  const auto size = static_cast<Index>(columns.size());
  Eigen::VectorXd value = Eigen::VectorXd::Zero(size);
  Eigen::MatrixXd by = Eigen::MatrixXd::Zero(size, count);  // of impulses: since the last record
  const RunSteps steps(clock);
  long step = 0;
  const auto write = [&](const State& x) {
    slopes.set_up(x);
    for (std::size_t i = 0; i < columns.size(); ++i) value[static_cast<Index>(i)] += slopes.value(i, x);
    for (Index j = 0; j < count; ++j) {
      one_q = dq.col(j), one_v = dv.col(j);
      for (std::size_t i = 0; i < columns.size(); ++i)
        by(static_cast<Index>(i), j) += slopes.push(i, changes[at(j)], one_q.data(), one_v.data());
    }
    record(x.t, value, by);
    value.setZero(), by.setZero();
  };
  const auto each_impulse = [&](auto&& take) {
    for (std::size_t i = 0; i < columns.size(); ++i)
      if (columns[i].kind == RunColumn::Kind::normal || columns[i].kind == RunColumn::Kind::tangent)
        take(static_cast<Index>(i), columns[i].place, columns[i].kind == RunColumn::Kind::normal);
  };
  State before;
  bool begun = false;
  Clock each = clock;
  each.every = 1;
  result.run = simulate(integrator, solver, each, [&](const RunSample& moment) {
    if (begun && (!has_answer(moment.report.status) || moment.state.t == before.t)) return;
    if (!begun) {
      start.set_up(system.initial_state(), moment.state);
      for (Index j = 0; j < count; ++j) {
        dq.col(j) = changes[at(j)].start_q, dv.col(j) = changes[at(j)].start_v;
        start.part_of(changes[at(j)], parts[at(j)]);
      }
      start.push(parts, dq, dv);
      begun = true;
    } else {
      trace.take(integrator, before, steps.duration_of(step), moment.state);
      linear.set_up(trace);
      for (Index j = 0; j < count; ++j) linear.part_of(changes[at(j)], parts[at(j)]);
      linear.push(parts, dq, dv, slopes.any_impulse() ? &impulses : nullptr);
      each_impulse([&](Index row, Index contact, bool normal) {
        for (Index j = 0; j < count; ++j)
          by(row, j) += (normal ? impulses[at(j)].normal : impulses[at(j)].tangent)[contact];
      });
      each_impulse([&](Index row, Index contact, bool normal) {
        const Impulse& impulse = moment.impulses[at(contact)];
        value[row] += normal ? impulse.normal : impulse.tangent;
      });
      refuse_overflow(std::isfinite(dq.sum() + dv.sum()), before.t);
      if (!linear.degenerate().empty()) result.degenerate.push_back({before.t, linear.degenerate()});
      result.inconsistent += !linear.consistent();
      ++step;
    }
    before = moment.state;
    if (record && steps.recorded(step)) write(moment.state);
  });
  result.q = dq, result.v = dv;
  return result;
}

}  // namespace

RunTangent differentiate_run(const System& system, const std::vector<RunParameter>& parameters,
                             const StepScheme& scheme, Solver& solver, const Clock& clock,
                             const std::vector<RunColumn>& columns, const TangentRecorder& record) {
  return std::visit(
      [&](const auto& options) { return tangent_of_run(system, parameters, options, solver, clock, columns, record); },
      scheme);
}

}  // namespace orthant
