#include <orthant/core/mechanics/scene_toml.h>
#include <orthant/core/scenes/bouncing_ball.h>
#include <orthant/core/scenes/chain.h>
#include <orthant/core/scenes/coulomb_decay.h>
#include <orthant/core/scenes/impact_oscillator.h>
#include <orthant/core/scenes/incline.h>
#include <orthant/core/scenes/n_four_bar.h>
#include <orthant/core/scenes/pendulum.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/core/scenes/slider_crank.h>
#include <orthant/core/scenes/stick_slip.h>
#include <orthant/core/support/options.h>

namespace orthant {
namespace {

struct NoOptions {
  template <class V> void visit(V&&) {}
};

Scene ideal(const NoOptions&) { return slider_crank_ideal(); }

template <class Options, Scene (*draw)(const Options&)> Scene make(std::span<const std::string> sets) {
  Options options;
  for (const std::string& set : sets) set_options(options, set);
  return draw(options);
}

template <class Options> std::string options_of() { return describe(Options{}); }

constexpr SceneEntry kScenes[] = {
    {"bouncing_ball", "a point mass falls on a floor; for e < 1 its impacts accumulate",
     &make<BouncingBall, bouncing_ball>, &options_of<BouncingBall>},
    {"impact_oscillator", "a driven oscillator strikes a wall once a period",
     &make<ImpactOscillator, impact_oscillator>, &options_of<ImpactOscillator>},
    {"stick_slip", "a spring-held block on a moving belt, static friction above kinetic", &make<StickSlip, stick_slip>,
     &options_of<StickSlip>},
    {"coulomb_decay", "a spring-held block on a rough floor swings and stops", &make<CoulombDecay, coulomb_decay>,
     &options_of<CoulombDecay>},
    {"incline", "a block on a slope, sent up or down", &make<Incline, incline>, &options_of<Incline>},
    {"pendulum", "a point mass on a rigid rod", &make<Pendulum, pendulum>, &options_of<Pendulum>},
    {"chain", "point masses on links, released", &make<Chain, chain>, &options_of<Chain>},
    {"n_four_bar", "parallelograms in a row, turning through their singular poses", &make<NFourBar, n_four_bar>,
     &options_of<NFourBar>},
    {"slider_crank", "slider-crank whose slider has clearance in its guide: four corners, two walls",
     &make<SliderCrank, slider_crank>, &options_of<SliderCrank>},
    {"slider_crank_ideal", "the same without clearance and friction: a prismatic joint, no contacts",
     &make<NoOptions, ideal>, &options_of<NoOptions>},
};

}  // namespace

std::span<const SceneEntry> scenes() { return kScenes; }

Scene make_scene(std::string_view name_or_path, std::span<const std::string> sets) {
  std::string known;
  for (const SceneEntry& entry : kScenes) {
    if (entry.name == name_or_path) return entry.make(sets);
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  const std::filesystem::path file(name_or_path);
  std::error_code error;
  if (!std::filesystem::exists(file, error))
    throw std::invalid_argument("unknown scene '" + std::string(name_or_path) +
                                "': must be a TOML file that exists or one of " + known);
  return read_scene(file, sets);
}

}  // namespace orthant
