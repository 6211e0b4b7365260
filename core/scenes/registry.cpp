#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/arch.h>
#include <orthant/core/scenes/bouncing_ball.h>
#include <orthant/core/scenes/chain.h>
#include <orthant/core/scenes/coulomb_decay.h>
#include <orthant/core/scenes/cradle.h>
#include <orthant/core/scenes/grain_column.h>
#include <orthant/core/scenes/impact_oscillator.h>
#include <orthant/core/scenes/incline.h>
#include <orthant/core/scenes/n_four_bar.h>
#include <orthant/core/scenes/painleve_rod.h>
#include <orthant/core/scenes/pendulum.h>
#include <orthant/core/scenes/pile.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/core/scenes/rocking_block.h>
#include <orthant/core/scenes/rod_drop.h>
#include <orthant/core/scenes/roll.h>
#include <orthant/core/scenes/slider_crank.h>
#include <orthant/core/scenes/sphere_bounce.h>
#include <orthant/core/scenes/stick_slip.h>
#include <orthant/core/scenes/superball.h>
#include <orthant/core/scenes/table.h>
#include <orthant/core/scenes/tower.h>
#include <orthant/core/support/options.h>
#include <orthant/core/support/registered.h>

#include <algorithm>

namespace orthant {
namespace {

struct NoOptions {
  template <class V> void visit(V&&) {}
};

Scene ideal(const NoOptions&) { return slider_crank_ideal(); }

template <class Options, Scene (*draw)(const Options&)> Scene make(std::span<const std::string> sets) {
  Options options;
  std::string list;  // in one, so that no key may stand in two
  for (const std::string& set : sets) list += (list.empty() ? "" : ",") + set;
  set_options(options, list);
  return draw(options);
}

const SceneEntry kScenes[] = {
    {"bouncing_ball", "a point mass falls on a floor; for e < 1 its impacts accumulate",
     &make<BouncingBall, bouncing_ball>, &list_options<BouncingBall>},
    {"impact_oscillator", "a driven oscillator strikes a wall once a period",
     &make<ImpactOscillator, impact_oscillator>, &list_options<ImpactOscillator>},
    {"stick_slip", "a spring-held block on a moving belt, static friction above kinetic", &make<StickSlip, stick_slip>,
     &list_options<StickSlip>},
    {"coulomb_decay", "a spring-held block on a rough floor swings and stops", &make<CoulombDecay, coulomb_decay>,
     &list_options<CoulombDecay>},
    {"incline", "a block on a slope, sent up or down", &make<Incline, incline>, &list_options<Incline>},
    {"pendulum", "a point mass on a rigid rod", &make<Pendulum, pendulum>, &list_options<Pendulum>},
    {"chain", "point masses on links, released", &make<Chain, chain>, &list_options<Chain>},
    {"n_four_bar", "parallelograms in a row, turning through their singular poses", &make<NFourBar, n_four_bar>,
     &list_options<NFourBar>},
    {"superball", "a light ball above a heavy one strikes the floor", &make<SuperBall, superball>,
     &list_options<SuperBall>},
    {"cradle", "equal balls in a row, the first strikes the others", &make<Cradle, cradle>, &list_options<Cradle>},
    {"roll", "a ball slides, then rolls", &make<Roll, roll>, &list_options<Roll>},
    {"rocking_block", "a block rocks from corner to corner", &make<RockingBlock, rocking_block>,
     &list_options<RockingBlock>},
    {"painleve_rod", "a rod slides on a rough floor: one, no or two contact forces", &make<PainleveRod, painleve_rod>,
     &list_options<PainleveRod>},
    {"table", "more legs than the weight can tell apart", &make<Table, table>, &list_options<Table>},
    {"tower", "blocks one on the other, the heavy on the light", &make<Tower, tower>, &list_options<Tower>},
    {"sphere_bounce", "a ball strikes a rough floor at a slant", &make<SphereBounce, sphere_bounce>,
     &list_options<SphereBounce>},
    {"rod_drop", "a slanting rod falls onto a smooth floor", &make<RodDrop, rod_drop>, &list_options<RodDrop>},
    {"grain_column", "grains one on the other fall onto the floor together", &make<GrainColumn, grain_column>,
     &list_options<GrainColumn>},
    {"pile", "discs of unlike size dropped into a trough, all of which may touch each other", &make<Pile, pile>,
     &list_options<Pile>},
    {"arch", "a semicircular arch of voussoirs without mortar", &make<Arch, arch>, &list_options<Arch>},
    {"slider_crank", "slider-crank whose slider has clearance in its guide: four corners, two walls",
     &make<SliderCrank, slider_crank>, &list_options<SliderCrank>},
    {"slider_crank_ideal", "the same without clearance and friction: a prismatic joint, no contacts",
     &make<NoOptions, ideal>, &list_options<NoOptions>},
};

std::vector<SceneEntry>& scene_rows() {
  static std::vector<SceneEntry> rows(std::begin(kScenes), std::end(kScenes));
  return rows;
}

}  // namespace

std::span<const SceneEntry> scenes() { return scene_rows(); }

void register_scene(SceneEntry entry) {
  entry.name = registered_name("scene", entry.name, scenes(), "_");
  entry.summary = kept_text(entry.summary);
  scene_rows().push_back(std::move(entry));
}

bool is_built_in(std::string_view name) {
  return std::ranges::any_of(scenes(), [&](const SceneEntry& entry) { return entry.name == name; });
}

Scene make_scene(std::string_view name_or_path, std::span<const std::string> sets) {
  std::string known;
  for (const SceneEntry& entry : scenes()) {
    if (entry.name == name_or_path) return entry.make(sets);
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  const std::filesystem::path file(name_or_path);
  std::error_code error;
  if (!std::filesystem::exists(file, error))
    throw std::invalid_argument("unknown scene '" + shortened(name_or_path, 1000) +
                                "': must be a TOML file that exists or one of " + known);
  return read_scene(file, sets);
}

}  // namespace orthant
