#include <orthant/integrators/derivatives/run_tangent.h>
#include <orthant/integrators/derivatives/touching_start.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace orthant {

namespace {

template <class Space, class Options>
RunTangent tangent_of_run(const SystemOf<Space>& system, const std::vector<RunParameterOf<Space>>& parameters,
                          const Options& options, Solver& solver, const Clock& clock,
                          const std::vector<RunColumn>& columns, const TangentRecorder& record) {
  using Scheme = StepSchemeOf<Options, Space>;
  check(clock);
  const auto count = static_cast<Index>(parameters.size());
  std::vector<ParameterChangeOf<Space>> changes;
  for (const auto& parameter : parameters) changes.push_back(changes_of(parameter, system, clock.duration));
  RunTangent result;
  result.warnings = one_sided_in_words(parameters, changes);
  std::ranges::move(evaluated_knots_in_words(parameters, changes, clock.step, clock.duration, Scheme::loads_at(options),
                                             Scheme::drives_at(options)),
                    std::back_inserter(result.warnings));
  typename Scheme::Integrator integrator(system, options);
  typename Scheme::Linearization linear(system, options);
  StartLinearizationOf<Space> start(system);
  linear.begin_friction(begun_frictions(changes, system));
  ColumnSlopesOf<Space> slopes(system, columns);
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
      if (columns[i].impulse()) take(static_cast<Index>(i), columns[i]);
  };
  State before;
  RunNotes notes;
  std::vector<int> touching;  // at the start
  bool begun = false;
  Clock each = clock;
  each.every = 1;
  result.run = simulate(integrator, solver, each, [&](const RunSampleOf<Space>& moment) {
    if (begun && (!has_answer(moment.report.status) || moment.state.t == before.t)) return;
    if (!begun) {
      start.set_up(system.initial_state(), moment.state);
      for (Index j = 0; j < count; ++j) {
        dq.col(j) = changes[at(j)].start_q, dv.col(j) = changes[at(j)].start_v;
        start.part_of(changes[at(j)], parts[at(j)]);
      }
      start.push(parts, dq, dv);
      if constexpr (std::is_same_v<Options, MoreauJeanOptions>)
        touching = touching_starts(system, moment.state, options.theta * steps.duration_of(0), changes, dq, dv);
      begun = true;
    } else {
      trace.take(integrator, before, steps.duration_of(step), moment.state);
      linear.set_up(trace);
      for (Index j = 0; j < count; ++j) linear.part_of(changes[at(j)], parts[at(j)]);
      linear.push(parts, dq, dv, slopes.any_impulse() ? &impulses : nullptr);
      each_impulse([&](Index row, RunColumn column) {
        for (Index j = 0; j < count; ++j) by(row, j) += impulse_of(column, impulses[at(j)]);
        value[row] += impulse_of(column, system, moment);
      });
      refuse_overflow(std::isfinite(dq.sum() + dv.sum()), before.t);
      note_degenerate(before.t, linear.degenerate(), step == 0 ? touching : std::vector<int>(), result.degenerate);
      result.inconsistent += !linear.consistent();
      notes.take(linear, before.t);
      ++step;
    }
    before = moment.state;
    if (record && steps.recorded(step)) write(moment.state);
  });
  notes.append_words(system, columns, result.warnings);
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

RunTangent differentiate_run(const SystemOf<Spatial>& system, const std::vector<RunParameterOf<Spatial>>& parameters,
                             const MoreauJeanOptions& scheme, Solver& solver, const Clock& clock,
                             const std::vector<RunColumn>& columns, const TangentRecorder& record) {
  return tangent_of_run(system, parameters, scheme, solver, clock, columns, record);
}

}  // namespace orthant
