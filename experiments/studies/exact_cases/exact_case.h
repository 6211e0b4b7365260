// experiments/studies/exact_cases/exact_case.h — a hard case: a scene, its exact answer, and what counts as an error.
#pragma once

#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/integrators/simulate.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace orthant {

struct ExactCase {
  std::string id, title;  // "B1", "bouncing ball: ..."
  std::string measure;    // what `error` is, with its unit
  AnyScene scene;
  double duration = 1, h = 1e-2;  // [s]; h: the coarsest step, halved from there
  /// Against the exact answer, at each recorded moment of one run; may remember what it saw (each run gets a fresh
  /// copy).
  std::function<double(const RunSample&)> error;
  bool throughout = false;  // the worst of all moments counts, else the last one

  enum class Motion { smooth, events, instant } motion = Motion::events;  // instant: decided in one step, no order in h
  enum class Energy { conserved, falls, driven } energy = Energy::falls;
  std::string
      word{};  // a scheme at acceleration level ends with this word and is right to: there is no, or no one, motion
  double exact = 1e-9;  // error at which an answer counts as exact, whatever the order

  /// An equivalent formulation: it runs by the same integrator and solver, and `unlike` tells from the two ends
  /// how far the answers are apart. `error` is not read. With `rival` the original is run by that solver instead.
  std::optional<Scene> original{};
  std::string rival{};
  std::function<double(const State& told, const State& original)> unlike{};

  /// A threshold: the parameter at which `error` of family(parameter) changes from > ½ to ≤ ½, found by bisection; the
  /// error of the case is then its relative distance from `threshold`. `scene` and its error are not run.
  std::function<Scene(double)> family{};
  double low = 0, high = 0, threshold = 0;

  std::vector<std::string> solvers{};  // run with these only; empty: with all
  std::string integrator{};            // likewise
  bool pyramids = false;               // in place of discs: only by schemes that take them

  /// In space, instead of `error`: of one state.
  std::function<double(const SystemOf<Spatial>&, const State&)> error_in_space{};

  bool in_space() const { return std::holds_alternative<spatial::Scene>(scene); }
  bool has_contacts() const {
    return std::visit([](const auto& s) { return !s.contacts.empty(); }, scene);
  }
};

/// The planar cases, in the order of their numbers.
std::vector<ExactCase> exact_cases();
/// The cases in space, S1, S2, …
std::vector<ExactCase> exact_cases_in_space();

}  // namespace orthant
