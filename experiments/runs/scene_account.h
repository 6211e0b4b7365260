// experiments/runs/scene_account.h — account of a scene before a run: mobility, jams, clearances, advice.
//
//   Grübler     3 bodies − Σ rows of joints, in space 6 bodies − …; by rank the rank of G in place of the sum. They
//               differ by redundant rows. Where bodies start off their joints, all is said of the place into which they
//               are moved (assemble.h).
//   step        h = 0.02 min(1/ω, √(ρ/g), ρ/|v|, 1/|ω_b|): ω of springs, drives, loads, ρ a body's radius of gyration
//               about its centre, v and ω_b its velocities at the start; at most the duration / 100. For fixed steps.
//   integrator  adaptive where it takes the scene, with at most 30 contacts and pairs; else moreau-jean. In space
//               stewart-trinkle for rims and ellipsoids, generalized-alpha for motions without contact and friction.
#pragma once

#include <orthant/core/mechanics/dynamics/redundancy.h>

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

namespace orthant {

struct SceneAccount {
  struct Clearance {
    std::string name;
    double gap = 0;  // [m] at the start; of an angle's limit [rad]
  };
  int dimension = 2;
  int bodies = 0, joints = 0, joint_rows = 0, contacts = 0, collisions = 0, pairs = 0;
  double mass = 0;  // [kg] of all bodies
  int gruebler = 0;
  bool ranked = true;  // false: more joint rows than are looked at
  Redundancy redundancy;
  std::string redundant_rows;  // in words; empty: none
  std::vector<std::string> driven;
  std::string jam;              // in words; empty: the drives' motion exists, or there are none
  double jam_looked_until = 0;  // [s]; 0: not looked
  std::vector<Clearance> clearances;
  std::vector<std::string> remarks;  // of the start
  double step = 0;
  std::string integrator, why_integrator;
};

SceneAccount account_of(const System& given);
SceneAccount account_of(const SystemOf<Spatial>& given);

std::string in_words(const SceneAccount& account);
nlohmann::ordered_json as_json(const SceneAccount& account);

}  // namespace orthant
