#include <orthant/integrators/derivatives/parameter_step.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <type_traits>
#include <variant>
#include <vector>

namespace orthant {

namespace {

/// What differs in one element, of four scenes.
class Samples {
 public:
  explicit Samples(const ParameterChange& change) : change_(change) {}

  /// f(system, values) appends to values.
  template <class F> void take(F&& f) {
    for (std::size_t k = 0; k < 4; ++k) {
      values_[k].clear();
      f(*change_.at[k], values_[k]);
    }
    const auto& w = change_.weights;
    double most = 0, differs = 0, size = 0;
    for (std::size_t i = 0; i < values_[0].size(); ++i) {
      const double x[] = {values_[0][i], values_[1][i], values_[2][i], values_[3][i]};
      for (const double one : x) size = std::max(size, std::abs(one));
      if (x[0] == x[1] && x[1] == x[2] && x[2] == x[3]) continue;
      const double fine = (w[0] * x[0] + w[1] * x[1] + w[2] * x[2] + w[3] * x[3]) / change_.step;
      const double rough = change_.side == 0 ? (x[2] - x[1]) / (2 * change_.step)
                                             : change_.side * (-1.5 * x[0] + 2 * x[1] - 0.5 * x[2]) / change_.step;
      most = std::max(most, std::abs(fine)), differs = std::max(differs, std::abs(fine - rough));
    }
    const double rounding = 0x1p-52 * size / change_.step;
    if (!(most > 16 * rounding)) {  // it does not change at all, or by less than it is rounded
      lost_ = lost_ || most > 0;
      return;
    }
    resolved_ = true;
    const double other = std::max(0.0, differs - 16 * rounding) / most;
    worst_.truncation = std::max(worst_.truncation, std::pow(other, change_.side == 0 ? 2 : 1.5));
    worst_.rounding = std::max(worst_.rounding, rounding / most);
  }
  /// Nothing changes by more than rounding, but something may: the step is lost in it.
  StepError worst() const { return lost_ && !resolved_ ? StepError{worst_.truncation, 1} : worst_; }

 private:
  const ParameterChange& change_;
  StepError worst_;
  bool lost_ = false, resolved_ = false;
  std::array<std::vector<double>, 4> values_;
};

struct PairSamples {
  explicit PairSamples(const ParameterChange& of) : change(of) {}
  template <class F> void take(F&& f) {
    std::vector<double> one, other;
    f(*change.at[0], one), f(*change.at[2], other);
    same = same && one == other;
  }
  const ParameterChange& change;
  bool same = true;
};

void append(const Row& row, std::vector<double>& to) {
  for (const double j : row.ja) to.push_back(row.a >= 0 ? j : 0);
  for (const double j : row.jb) to.push_back(row.b >= 0 ? j : 0);
}

void append(const Eigen::VectorXd& x, std::vector<double>& to) { to.insert(to.end(), x.begin(), x.end()); }

template <class Samples> void take_elements(const ParameterChange& change, const System& system, const Kinematics& at,
                                            const Eigen::VectorXd& v, Samples& samples) {
  for (const int joint : change.joints)
    samples.take([&](const System& s, std::vector<double>& to) {
      const auto& one = s.scene().joints[static_cast<std::size_t>(joint)];
      std::vector<Row> rows(static_cast<std::size_t>(row_count(one)));
      std::vector<double> phi(rows.size()), rate(rows.size());
      std::visit(
          [&](const auto& j) {
            j.rows(at, rows.data()), j.residual(at, phi.data());
            if constexpr (requires(double* r) { j.rate(at, r); }) j.rate(at, rate.data());
          },
          one);
      for (std::size_t i = 0; i < rows.size(); ++i) {
        append(rows[i], to);
        to.push_back(phi[i]), to.push_back(rate[i]);
      }
    });
  for (const int spring : change.springs)
    samples.take([&](const System& s, std::vector<double>& to) {
      std::visit(
          [&](const auto& one) {
            const SpringState there = one.evaluate(at, v.data());
            append(there.row, to);
            to.push_back(there.tension), to.push_back(one.stiffness), to.push_back(one.damping);
          },
          s.scene().springs[static_cast<std::size_t>(spring)]);
    });
  for (const int friction : change.frictions)
    samples.take([&](const System& s, std::vector<double>& to) {
      append(s.scene().frictions[static_cast<std::size_t>(friction)].of.row(at), to);
    });
  for (const int load : change.loads)
    samples.take([&](const System& s, std::vector<double>& to) {
      Eigen::VectorXd f = Eigen::VectorXd::Zero(system.dof());
      s.scene().loads[static_cast<std::size_t>(load)].add(at, at.t, f.data());
      append(f, to);
    });
}

/// all: also contacts that may be those of another corner at values nearby.
template <class Samples>
void take_all(const ParameterChange& change, const System& system, double duration, bool all, Samples& samples) {
  constexpr double kTimes[] = {0, 0.381966, 1};  // of the duration
  const State start = system.initial_state();
  Kinematics at = Terms(system).at;
  for (const double part : kTimes) {
    set_poses(system, start.t + part * duration, start.q, at);
    take_elements(change, system, at, start.v, samples);
  }
  set_poses(system, start.t, start.q, at);
  for (const int contact : change.contacts) {
    const auto c = static_cast<std::size_t>(contact);
    const bool smooth = std::visit(
        [](const auto& one) {
          using Kind = std::remove_cvref_t<decltype(one)>;
          return std::is_same_v<Kind, CornerWall> || std::is_same_v<Kind, DiscWall> || std::is_same_v<Kind, DiscDisc> ||
                 std::is_same_v<Kind, Journal> || std::is_same_v<Kind, Limit>;
        },
        system.scene().contacts[c]);
    if (!smooth && !all) continue;
    samples.take([&](const System& s, std::vector<double>& to) {
      const ContactRows rows = std::visit([&](const auto& one) { return one.rows(at); }, s.scene().contacts[c]);
      append(rows.normal, to), append(rows.tangent, to);
      to.push_back(gap_of(s, {}, contact, at));
    });
  }
  samples.take([](const System& s, std::vector<double>& to) { append(s.mass(), to); });
  samples.take([](const System& s, std::vector<double>& to) { append(s.weight(), to); });
  samples.take([](const System& s, std::vector<double>& to) { append(s.initial_state().q, to); });
  samples.take([](const System& s, std::vector<double>& to) { append(s.initial_state().v, to); });
}

}  // namespace

StepError error_of_step(const ParameterChange& change, const System& system, double duration) {
  Samples samples(change);
  take_all(change, system, duration, false, samples);
  return samples.worst();
}

bool same_samples(const ParameterChange& change, const System& system) {
  PairSamples samples(change);
  take_all(change, system, 1, true, samples);
  return samples.same;
}

}  // namespace orthant
