#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/scenes/arch.h>
#include <orthant/core/scenes/bennett.h>
#include <orthant/core/scenes/bouncing_ball.h>
#include <orthant/core/scenes/boxes.h>
#include <orthant/core/scenes/bricard.h>
#include <orthant/core/scenes/chain.h>
#include <orthant/core/scenes/coulomb_decay.h>
#include <orthant/core/scenes/cradle.h>
#include <orthant/core/scenes/euler_disc.h>
#include <orthant/core/scenes/flyball.h>
#include <orthant/core/scenes/gear_train.h>
#include <orthant/core/scenes/grain_column.h>
#include <orthant/core/scenes/impact_oscillator.h>
#include <orthant/core/scenes/incline.h>
#include <orthant/core/scenes/masse.h>
#include <orthant/core/scenes/n_four_bar.h>
#include <orthant/core/scenes/painleve_rod.h>
#include <orthant/core/scenes/pendulum.h>
#include <orthant/core/scenes/pile.h>
#include <orthant/core/scenes/rattleback.h>
#include <orthant/core/scenes/registry.h>
#include <orthant/core/scenes/robot_arm.h>
#include <orthant/core/scenes/rocking_block.h>
#include <orthant/core/scenes/rod_drop.h>
#include <orthant/core/scenes/roll.h>
#include <orthant/core/scenes/slider_crank.h>
#include <orthant/core/scenes/slider_crank_space.h>
#include <orthant/core/scenes/spatial_slider_crank.h>
#include <orthant/core/scenes/sphere_bounce.h>
#include <orthant/core/scenes/spheres.h>
#include <orthant/core/scenes/spherical_chain.h>
#include <orthant/core/scenes/stick_slip.h>
#include <orthant/core/scenes/superball.h>
#include <orthant/core/scenes/table.h>
#include <orthant/core/scenes/top.h>
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

template <class Options, auto draw> auto make(std::span<const std::string> sets) {
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

const SpatialSceneEntry kSpatialScenes[] = {
    {"slider_crank_space", "slider_crank built from spatial bodies, turned at will; eight corners where it has a width",
     &make<SliderCrankSpace, slider_crank_space>, &list_options<SliderCrankSpace>},
    {"bricard", "Bricard's linkage of six hinges: one row more than rank in every pose", &make<Bricard, bricard>,
     &list_options<Bricard>},
    {"bennett", "Bennett's linkage of four skew hinges, three rows more than rank", &make<Bennett, bennett>,
     &list_options<Bennett>},
    {"top", "Lagrange's top with cusps", &make<Top, top>, &list_options<Top>},
    {"flyball", "a flyball governor on stiff springs", &make<Flyball, flyball>, &list_options<Flyball>},
    {"spatial_slider_crank", "a slider-crank with a spherical and a Hooke joint",
     &make<SpatialSliderCrank, spatial_slider_crank>, &list_options<SpatialSliderCrank>},
    {"slider_crank_clearance", "the spatial slider-crank, a ball in a socket in place of its rod's joint to the slider",
     &make<SliderCrankClearance, slider_crank_clearance>, &list_options<SliderCrankClearance>},
    {"masse", "a ball on a rough table: slides on a parabola, then rolls", &make<Masse, masse>, &list_options<Masse>},
    {"rattleback", "a stone of askew inertia: turns back when spun the wrong way", &make<Rattleback, rattleback>,
     &list_options<Rattleback>},
    {"euler_disc", "Euler's disc: a coin rolls around on its edge, its centre at rest", &make<EulerDisc, euler_disc>,
     &list_options<EulerDisc>},
    {"dominoes", "a row of dominoes, the first one pushed", &make<Dominoes, dominoes>, &list_options<Dominoes>},
    {"card_house", "a house of cards at rest", &make<CardHouse, card_house>, &list_options<CardHouse>},
    {"kapla_tower", "layers of two planks, crosswise, at rest", &make<KaplaTower, kapla_tower>,
     &list_options<KaplaTower>},
    {"box_pyramid", "a pyramid of cubes at rest", &make<BoxPyramid, box_pyramid>, &list_options<BoxPyramid>},
    {"capsules", "capsules fall on each other", &make<Capsules, capsules>, &list_options<Capsules>},
    {"gear_train", "wheels whose teeth have play, the first one driven to and fro", &make<GearTrain, gear_train>,
     &list_options<GearTrain>},
    {"robot_arm", "an arm from a URDF model sweeps a box over a rough floor", &make<RobotArm, robot_arm>,
     &list_options<RobotArm>},
    {"spheres", "spheres dropped into a square well, all of which may touch each other", &make<Spheres, spheres>,
     &list_options<Spheres>},
    {"spherical_chain", "rods joined by balls and sockets, released from the horizontal",
     &make<SphericalChain, spherical_chain>, &list_options<SphericalChain>},
};

/// The scene of that name in the table, or an empty one; `known`: names.
template <class Entry> const Entry* entry_of(std::span<const Entry> all, std::string_view name, std::string& known) {
  const Entry* found = nullptr;
  for (const Entry& entry : all) {
    if (entry.name == name) found = &entry;
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  return found;
}

void check_exists(std::string_view name_or_path, const std::string& known) {
  std::error_code error;
  if (!std::filesystem::exists(std::filesystem::path(name_or_path), error))
    throw std::invalid_argument("unknown scene '" + shortened(name_or_path, 1000) +
                                "': must be a TOML file that exists or one of " + known);
}

std::vector<SceneEntry>& scene_rows() {
  static std::vector<SceneEntry> rows(std::begin(kScenes), std::end(kScenes));
  return rows;
}
std::vector<SpatialSceneEntry>& spatial_scene_rows() {
  static std::vector<SpatialSceneEntry> rows(std::begin(kSpatialScenes), std::end(kSpatialScenes));
  return rows;
}

template <class Entry> void append(std::vector<Entry>& rows, Entry entry) {
  entry.name = registered_name("scene", entry.name, std::span<const Entry>(rows), "_");
  if (is_built_in(entry.name))
    throw std::invalid_argument("scene '" + std::string(entry.name) + "': is registered already");
  entry.summary = kept_text(entry.summary);
  rows.push_back(std::move(entry));
}

}  // namespace

std::span<const SceneEntry> scenes() { return scene_rows(); }
std::span<const SpatialSceneEntry> spatial_scenes() { return spatial_scene_rows(); }

void register_scene(SceneEntry entry) { append(scene_rows(), std::move(entry)); }
void register_scene(SpatialSceneEntry entry) { append(spatial_scene_rows(), std::move(entry)); }

bool is_built_in(std::string_view name) {
  std::string known;
  return entry_of(scenes(), name, known) != nullptr || entry_of(spatial_scenes(), name, known) != nullptr;
}

Scene make_scene(std::string_view name_or_path, std::span<const std::string> sets) {
  std::string known, in_space;
  if (const SceneEntry* entry = entry_of(scenes(), name_or_path, known)) return entry->make(sets);
  if (entry_of(spatial_scenes(), name_or_path, in_space) != nullptr)
    throw std::invalid_argument("scene '" + std::string(name_or_path) + "': is in space: must be a planar one here");
  check_exists(name_or_path, known);
  return read_scene(std::filesystem::path(name_or_path), sets);
}

AnyScene make_any_scene(std::string_view name_or_path, std::span<const std::string> sets) {
  std::string known;
  if (const SceneEntry* entry = entry_of(scenes(), name_or_path, known)) return entry->make(sets);
  if (const SpatialSceneEntry* entry = entry_of(spatial_scenes(), name_or_path, known)) return entry->make(sets);
  check_exists(name_or_path, known);
  return read_any_scene(std::filesystem::path(name_or_path), sets);
}

AnySystem make_any_system(std::string_view name_or_path, std::span<const std::string> sets) {
  const Examined examined = is_built_in(name_or_path) ? Examined::no : Examined::yes;
  return std::visit(
      [examined](auto&& scene) -> AnySystem {
        using Space = std::conditional_t<std::is_same_v<std::decay_t<decltype(scene)>, Scene>, Planar, Spatial>;
        return SystemOf<Space>(std::move(scene), examined);
      },
      make_any_scene(name_or_path, sets));
}

}  // namespace orthant
