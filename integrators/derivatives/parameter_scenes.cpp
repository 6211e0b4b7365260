#include <orthant/core/support/options.h>
#include <orthant/integrators/derivatives/changed_elements.h>
#include <orthant/integrators/derivatives/parameter_scenes.h>
#include <orthant/integrators/derivatives/parameter_step.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

namespace orthant {

namespace {

template <class Space> using SceneOf = typename ElementsOf<Space>::Scene;

/// The factor of another scene, its pieces those between `knots`: beyond its own end each goes on by extrapolation.
class MovedFactor {
 public:
  template <class AnyLoad> MovedFactor(const AnyLoad& other, std::vector<double> knots)
      : factor_(other.factor), own_(other.breakpoints), knots_(std::move(knots)) {}
  double operator()(double t) const {
    const auto i = static_cast<std::size_t>(std::upper_bound(knots_.begin(), knots_.end(), t) - knots_.begin());
    if (i > 0 && t < own_[i - 1]) return beyond(own_[i - 1], own_[i - 1] - t);
    if (i < own_.size() && t >= own_[i]) {
      const double inside = std::nextafter(own_[i], -std::abs(own_[i]) - 1);
      return beyond(inside, inside - t);
    }
    return factor_(t);
  }

 private:
  double beyond(double end, double by) const {
    return 3 * factor_(end) - 3 * factor_(end + by) + factor_(end + 2 * by);
  }
  std::function<double(double)> factor_;
  std::vector<double> own_, knots_;
};

/// The directions across axes of joints are those of `base`, turned along: perpendicular() jumps where two coordinates
/// of an axis are alike.
void keep_across(const Scene& /*base*/, Scene& /*scene*/) {}
void keep_across(const spatial::Scene& base, spatial::Scene& scene) {
  for (std::size_t i = 0; i < scene.joints.size() && i < base.joints.size(); ++i)
    std::visit(
        [&](auto& j) {
          const auto* own = std::get_if<std::remove_cvref_t<decltype(j)>>(&base.joints[i]);
          if constexpr (requires { j.across; })
            if (const Vector3d axis = spatial::axis_of(j).normalized(); own != nullptr)
              j.across = (own->across - axis.dot(own->across) * axis).normalized();
        },
        scene.joints[i]);
}

/// The scene at value + k step, its loads' breakpoints and its joints' directions where `base` has them.
template <class Space> std::unique_ptr<SystemOf<Space>> system_at(const RunParameterOf<Space>& parameter, double value,
                                                                  const SceneOf<Space>& base) {
  SceneOf<Space> scene = parameter.scene(value);
  for (std::size_t i = 0; i < scene.loads.size() && i < base.loads.size(); ++i) {
    auto& load = scene.loads[i];
    const std::vector<double>& knots = base.loads[i].breakpoints;
    if (!load.factor || load.breakpoints.size() != knots.size() || load.breakpoints == knots) continue;
    load.factor = MovedFactor(load, knots), load.breakpoints = knots;
  }
  keep_across(base, scene);
  return std::make_unique<SystemOf<Space>>(std::move(scene));
}

template <class Space> bool fill(const RunParameterOf<Space>& parameter, const SceneOf<Space>& base,
                                 ParameterChangeOf<Space>& change, std::string& why) {
  for (std::size_t k = 0; k < 4; ++k) try {
      change.at[k] = system_at<Space>(parameter, parameter.value + change.places[k] * change.step, base);
    } catch (const std::invalid_argument& error) {
      why = error.what();
      return false;
    }
  return true;
}

/// Scenes on both sides, or else on one. False: on neither.
template <class Space> bool place(const RunParameterOf<Space>& parameter, const SceneOf<Space>& base, double step,
                                  ParameterChangeOf<Space>& change, std::string& why) {
  change.step = step, change.side = 0;
  change.places = {-2, -1, 1, 2}, change.weights = {1. / 12, -8. / 12, 8. / 12, -1. / 12};
  if (fill<Space>(parameter, base, change, why)) return true;
  std::array<std::string, 2> whys;
  for (const int side : {1, -1}) {
    change.side = side, change.places = {0, side, 2 * side, 3 * side};
    change.weights = {-11. / 6 * side, 3. * side, -1.5 * side, 1. / 3 * side};
    if (fill<Space>(parameter, base, change, whys[side > 0 ? 0 : 1])) return true;
  }
  why = "larger values: " + whys[0] + "; smaller values: " + whys[1];
  return false;
}

/// Breakpoints of loads and of drives' tables that move with the parameter.
template <class Space>
void note_knots(const RunParameterOf<Space>& parameter, const SceneOf<Space>& base, ParameterChangeOf<Space>& change) {
  std::array<SceneOf<Space>, 4> scenes;
  for (const int load : change.loads) {
    const auto i = static_cast<std::size_t>(load);
    if (base.loads[i].breakpoints.empty()) continue;
    if (scenes[2].loads.empty())
      for (std::size_t k = 0; k < 4; ++k) scenes[k] = parameter.scene(parameter.value + change.places[k] * change.step);
    for (std::size_t b = 0; b < base.loads[i].breakpoints.size(); ++b) {
      double by = 0;
      for (std::size_t k = 0; k < 4; ++k)
        if (scenes[k].loads[i].breakpoints.size() > b) by += change.weights[k] * scenes[k].loads[i].breakpoints[b];
      if (by /= change.step; std::abs(by) > 1e-9) change.knots.emplace_back(base.loads[i].breakpoints[b], by);
    }
  }
  using DriveOf = typename ElementsOf<Space>::Drive;
  for (const int joint : change.joints) {
    if (!change.moves_drive) break;
    std::array<const DriveOf*, 4> drives{};
    for (std::size_t k = 0; k < 4; ++k)
      drives[k] = std::get_if<DriveOf>(&change.at[k]->scene().joints[static_cast<std::size_t>(joint)]);
    const auto* own = std::get_if<DriveOf>(&base.joints[static_cast<std::size_t>(joint)]);
    if (own == nullptr || std::ranges::count(drives, nullptr) > 0) continue;
    for (std::size_t b = 0; b < own->law.table.times().size(); ++b) {
      double by = 0;
      for (std::size_t k = 0; k < 4; ++k)
        if (drives[k]->law.table.times().size() > b) by += change.weights[k] * drives[k]->law.table.times()[b];
      if (by /= change.step; std::abs(by) > 1e-9) change.drive_knots.emplace_back(own->law.table.times()[b], by);
    }
  }
}

}  // namespace

template <class Space> void choose_scenes(const RunParameterOf<Space>& parameter, const SystemOf<Space>& system,
                                          double duration, double relative, ParameterChangeOf<Space>& change) {
  const double of_zero = relative * 1e-2;
  const double first = parameter.value != 0 ? relative * std::abs(parameter.value) : of_zero;
  constexpr double kFine = 1e-8, kCoarse = 1e-4;  // of the largest derivative of an element
  constexpr double kRoundedPlace = 1e-9;          // likewise
  constexpr int kTries = 16;
  const auto refuse = [&](const std::string& why) {
    throw std::invalid_argument("derivative with respect to " + parameter.name + ": " + why);
  };
  std::string why;
  const auto measured = [&](double step) -> std::optional<StepError> {
    if (!place<Space>(parameter, system.scene(), step, change, why)) return {};
    if (change.other().dof() != system.dof() || change.other().joint_rows() != system.joint_rows())
      refuse("a parameter must not change the number of elements of the scene");
    list_changed_elements(system, change.other(), duration, change);
    return error_of_step(change, system, duration);
  };
  double step = first;
  std::optional<StepError> error = measured(step);
  constexpr double kShorter[] = {1e-1, 1e-2, 1e-3, 1e-4, 1e-6};  // near the end of a range, but inside
  for (const double part : kShorter)
    if (!error || change.side != 0) error = measured(part * first), step = part * first;
  if (!error || change.side != 0) error = measured(first), step = first;
  if (!error) refuse("the scene exists on neither side of its value, " + detail::text_of(parameter.value) + ": " + why);
  if (error->rounding >= 1 && step < of_zero) {  // a value of rounding only: as zero
    error = measured(of_zero);
    if (error)
      step = of_zero;
    else
      error = measured(step);
  }
  if (first > relative && step == first) {
    // A place far from the origin says nothing of the lengths on which the motion changes: as short as by a value of 1,
    // or as rounding lets it be.
    const double shorter = std::max(relative, first * error->rounding / kRoundedPlace);
    const int side = change.side;
    const std::optional<StepError> other = shorter < first ? measured(shorter) : std::nullopt;
    if (other && change.side == side && other->sum() <= std::max(kFine, error->sum()))
      error = other, step = shorter;
    else
      measured(first);
  }
  double best = step;
  const int side = change.side;
  StepError least = *error;
  const double way = least.rounding > least.truncation ? 10 : 0.1;
  for (int i = 0; i < kTries && least.sum() > kFine; ++i) {
    error = measured(step *= way);
    if (!error || change.side != side || error->sum() > 10 * least.sum()) break;
    if (error->sum() < least.sum()) least = *error, best = step;
  }
  if (change.step != best) measured(best);
  if (change.moves_drive) {  // nearer scenes: hardly any evaluation of a step lies between their breakpoints
    error = measured(1e-3 * best);
    if (!error || change.side != side || error->sum() > kFine) measured(best);
  }
  if (least.sum() > kCoarse)
    refuse("no step of a difference resolves the change of the scene: two of them differ by " +
           detail::text_of(least.sum()) + " of it");
  note_knots<Space>(parameter, system.scene(), change);
}

template void choose_scenes(const RunParameterOf<Planar>&, const SystemOf<Planar>&, double, double,
                            ParameterChangeOf<Planar>&);
template void choose_scenes(const RunParameterOf<Spatial>&, const SystemOf<Spatial>&, double, double,
                            ParameterChangeOf<Spatial>&);

}  // namespace orthant
