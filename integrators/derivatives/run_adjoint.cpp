#include <orthant/integrators/checkpoint.h>
#include <orthant/integrators/derivatives/run_adjoint.h>
#include <orthant/integrators/derivatives/touching_start.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

namespace orthant {

namespace {

/// Where a segment of the run begins.
struct Anchor {
  State x;
  std::string memory;  // of the integrator
};

template <class Integrator> std::string memory_of(Integrator& integrator) {
  CheckpointData memory;
  integrator.remember(memory);
  return memory.bytes();
}

template <class Space, class Options> class Adjoint {
  using System = SystemOf<Space>;
  using Integrator = typename StepSchemeOf<Options, Space>::Integrator;
  using Linearization = typename StepSchemeOf<Options, Space>::Linearization;
  using Trace = typename Linearization::Trace;

 public:
  Adjoint(const System& system, const std::vector<RunParameterOf<Space>>& parameters, const Options& options,
          const Clock& clock, const std::vector<RunColumn>& columns, Index scalars, const RecordWeights& weights)
      : system_(system),
        options_(options),
        clock_(clock),
        steps_(clock),
        slopes_(system, columns),
        weights_(weights),
        linear_(system, options),
        start_(system),
        W_(static_cast<Index>(columns.size()), scalars) {
    for (const auto& parameter : parameters) changes_.push_back(changes_of(parameter, system, clock.duration));
    using Scheme = StepSchemeOf<Options, Space>;
    result_.warnings = one_sided_in_words(parameters, changes_);
    std::ranges::move(evaluated_knots_in_words(parameters, changes_, clock.step, clock.duration,
                                               Scheme::loads_at(options), Scheme::drives_at(options)),
                      std::back_inserter(result_.warnings));
    linear_.begin_friction(begun_frictions(changes_, system));
    parts_.resize(changes_.size());
    result_.value.setZero(scalars);
    result_.gradient.setZero(scalars, static_cast<Index>(changes_.size()));
  }

  RunAdjoint of(Solver& solver) {
    Integrator integrator(system_, options_);
    forward(integrator, solver);
    if (result_.run.status == Status::solved) backward(integrator, solver);
    return std::move(result_);
  }

 private:
  void forward(Integrator& integrator, Solver& solver) {
    segment_ = static_cast<long>(std::ceil(std::sqrt(static_cast<double>(steps_.total))));
    Clock each = clock_;
    each.every = 1;
    long step = -1;
    const auto& columns = slopes_.columns();
    result_.run = simulate(integrator, solver, each, [&](const RunSampleOf<Space>& moment) {
      if (step >= 0 && (!has_answer(moment.report.status) || step == steps_.total)) return;
      ++step;
      if (step % segment_ == 0 && step < steps_.total) anchors_.push_back({moment.state, memory_of(integrator)});
      const bool recorded = steps_.recorded(step);
      if (!recorded && !slopes_.any_impulse()) return;
      weigh(steps_.record_of(step));
      if (recorded) slopes_.set_up(moment.state);
      for (std::size_t i = 0; i < columns.size(); ++i) {
        double value = recorded ? slopes_.value(i, moment.state) : 0;
        if (columns[i].impulse()) value = impulse_of(columns[i], system_, moment);
        result_.value += value * W_.row(static_cast<Index>(i)).transpose();
      }
    });
    result_.checkpoints = std::ssize(anchors_);
  }

  void weigh(long record) {
    if (record == weighed_) return;
    weighed_ = record;
    W_.setZero();
    weights_(record, record == steps_.records() - 1, W_);
  }

  void backward(Integrator& integrator, Solver& solver) {
    const Index scalars = W_.cols();
    begin();
    q_.setZero(system_.dof(), scalars), v_ = q_;
    std::vector<Trace> traces(static_cast<std::size_t>(segment_));
    for (long s = std::ssize(anchors_) - 1; s >= 0; --s) {
      const long first = s * segment_, end = std::min(first + segment_, steps_.total);
      State x = anchors_[static_cast<std::size_t>(s)].x;
      CheckpointData memory(anchors_[static_cast<std::size_t>(s)].memory);
      integrator.remember(memory);
      for (long k = first; k < end; ++k) {
        before_ = x;
        if (integrator.step(steps_.duration_of(k), solver, x).status != Status::solved)
          throw std::runtime_error("gradient of a run: a step that was solved once is not solved again");
        x.t = steps_.end_of(k);
        traces[static_cast<std::size_t>(k - first)].take(integrator, before_, steps_.duration_of(k), x);
      }
      for (long k = end - 1; k >= first; --k) step_back(k, traces[static_cast<std::size_t>(k - first)]);
    }
    seed(0, anchors_.front().x);
    for (std::size_t j = 0; j < changes_.size(); ++j) start_.part_of(changes_[j], parts_[j]);
    for (Index k = 0; k < scalars; ++k) {
      start_.pull(q_.col(k).data(), v_.col(k).data(), sum_into(k));
      for (std::size_t j = 0; j < changes_.size(); ++j)
        result_.gradient(k, static_cast<Index>(j)) +=
            changes_[j].start_q.dot(q_.col(k)) + changes_[j].start_v.dot(v_.col(k));
    }
    notes_.append_words(system_, slopes_.columns(), result_.warnings);
    std::reverse(result_.degenerate.begin(), result_.degenerate.end());
  }

  // Sets up start_, and finds what touches there.
  void begin() {
    const State& start = anchors_.front().x;
    start_.set_up(system_.initial_state(), start);
    if constexpr (std::is_same_v<Options, MoreauJeanOptions>) {
      DirectionBlock q(system_.dof(), std::ssize(changes_)), v(system_.dof(), std::ssize(changes_));
      for (std::size_t j = 0; j < changes_.size(); ++j) {
        q.col(static_cast<Index>(j)) = changes_[j].start_q, v.col(static_cast<Index>(j)) = changes_[j].start_v;
        start_.part_of(changes_[j], parts_[j]);
      }
      start_.push(parts_, q, v);
      touching_ = touching_starts(system_, start, options_.theta * steps_.duration_of(0), changes_, q, v);
    }
  }

  // The columns at the end of step k − 1.
  void seed(long k, const State& x) {
    weigh(steps_.record_of(k));
    if (!steps_.recorded(k) || W_.isZero(0)) return;
    slopes_.set_up(x);
    for (std::size_t i = 0; i < slopes_.columns().size(); ++i)
      for (Index scalar = 0; scalar < W_.cols(); ++scalar) {
        const double weight = W_(static_cast<Index>(i), scalar);
        if (weight == 0) continue;
        slopes_.pull(i, weight, q_.col(scalar).data(), v_.col(scalar).data());
        for (std::size_t j = 0; j < changes_.size() && slopes_.any_by_parameter(); ++j)
          result_.gradient(scalar, static_cast<Index>(j)) += weight * slopes_.by_parameter(i, changes_[j]);
      }
  }

  void step_back(long k, const Trace& trace) {
    seed(k + 1, trace.after);
    linear_.set_up(trace);
    for (std::size_t j = 0; j < changes_.size(); ++j) linear_.part_of(changes_[j], parts_[j]);
    for (Index scalar = 0; scalar < W_.cols(); ++scalar) {
      if (slopes_.any_impulse()) {
        impulses_.clear(system_);
        for (std::size_t i = 0; i < slopes_.columns().size(); ++i) {
          const RunColumn& column = slopes_.columns()[i];
          const double weight = W_(static_cast<Index>(i), scalar);
          if (column.impulse()) impulse_of(column, impulses_) += weight;
        }
      }
      pull(scalar, slopes_.any_impulse() ? &impulses_ : nullptr);
    }
    refuse_overflow(q_.allFinite() && v_.allFinite(), trace.before.t);
    note_degenerate(trace.before.t, linear_.degenerate(), k == 0 ? touching_ : std::vector<int>(), result_.degenerate);
    result_.inconsistent += !linear_.consistent();
    notes_.take(linear_, trace.before.t);
  }

  void pull(Index scalar, const ImpulseChange* impulses) {
    linear_.pull(q_.col(scalar).data(), v_.col(scalar).data(), impulses, sum_into(scalar));
  }

  auto sum_into(Index scalar) {
    return [this, scalar](const Eigen::VectorXd& by_step, const Eigen::VectorXd& by_projection) {
      for (std::size_t j = 0; j < parts_.size(); ++j)
        result_.gradient(scalar, static_cast<Index>(j)) += inner(parts_[j], by_step, by_projection);
    };
  }

  const System& system_;
  Options options_;
  Clock clock_;
  RunSteps steps_;
  ColumnSlopesOf<Space> slopes_;
  const RecordWeights& weights_;
  Linearization linear_;
  StartLinearizationOf<Space> start_;
  std::vector<ParameterChangeOf<Space>> changes_;
  std::vector<StepPart> parts_;
  RunNotes notes_;
  std::vector<int> touching_;  // contacts, at the start
  Eigen::MatrixXd W_;
  long weighed_ = -1, segment_ = 1;  // the record that W_ is of; steps between two checkpoints
  std::vector<Anchor> anchors_;
  Eigen::MatrixXd q_, v_;  // x̄, a column a scalar
  ImpulseChange impulses_;
  State before_;
  RunAdjoint result_;
};

}  // namespace

RecordWeights weigh_last() {
  return [](long /*record*/, bool last, Eigen::MatrixXd& W) {
    if (last) W.setIdentity();
  };
}

RecordWeights weigh_all() {
  return [](long /*record*/, bool /*last*/, Eigen::MatrixXd& W) { W.setIdentity(); };
}

RunAdjoint differentiate_run_reverse(const System& system, const std::vector<RunParameter>& parameters,
                                     const StepScheme& scheme, Solver& solver, const Clock& clock,
                                     const std::vector<RunColumn>& columns, Index scalars,
                                     const RecordWeights& weights) {
  check(clock);
  return std::visit(
      [&](const auto& options) {
        using Options = std::remove_cvref_t<decltype(options)>;
        return Adjoint<Planar, Options>(system, parameters, options, clock, columns, scalars, weights).of(solver);
      },
      scheme);
}

RunAdjoint differentiate_run_reverse(const SystemOf<Spatial>& system,
                                     const std::vector<RunParameterOf<Spatial>>& parameters,
                                     const MoreauJeanOptions& scheme, Solver& solver, const Clock& clock,
                                     const std::vector<RunColumn>& columns, Index scalars,
                                     const RecordWeights& weights) {
  check(clock);
  return Adjoint<Spatial, MoreauJeanOptions>(system, parameters, scheme, clock, columns, scalars, weights).of(solver);
}

}  // namespace orthant
