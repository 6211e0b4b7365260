// tests/core/mechanics/models/imported.h — models as scenes, and their files.
#pragma once

#include <orthant/core/mechanics/models/import.h>
#include <orthant/core/mechanics/models/xml.h>
#include <orthant/core/mechanics/scene/scene_toml.h>
#include <orthant/core/mechanics/spatial/solid.h>

#include <doctest/doctest.h>

#include <algorithm>

#include "tests/support/folder.h"

namespace orthant {

struct Imported {
  spatial::Scene scene;
  std::vector<std::string> notes;
  bool noted(const std::string& what) const {
    return std::any_of(notes.begin(), notes.end(), [&](const std::string& n) { return n.find(what) != n.npos; });
  }
};

inline Imported taken(const std::string& text, const std::vector<std::string>& sets = {},
                      const std::string& file = "m.xml") {
  const ImportedModel model = import_model(text, file, sets);
  INFO(model.toml);
  return {std::get<spatial::Scene>(parse_any_scene(model.toml, {}, "imported")), model.notes};
}

inline std::string refusal_of_model(const std::string& text, const std::vector<std::string>& sets = {},
                                    const std::string& file = "m.xml") {
  try {
    static_cast<void>(taken(text, sets, file));
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "taken";
}

inline std::string mujoco(const std::string& parts) { return "<mujoco model='m'>\n" + parts + "</mujoco>"; }

inline std::string world(const std::string& parts) { return "<worldbody>" + parts + "</worldbody>\n"; }

inline spatial::Kinematics at_start(const spatial::Scene& s) {
  spatial::Kinematics k;
  for (const spatial::Body& b : s.bodies) {
    const auto R = quaternions::matrix_of(b.orientation);
    k.pose.push_back({b.position, R, R});
  }
  k.pose.emplace_back();
  return k;
}

/// The largest residual of any joint in the initial pose.
inline double broken_at_start(const spatial::Scene& s) {
  const spatial::Kinematics k = at_start(s);
  double most = 0;
  for (const spatial::Joint& j : s.joints)
    std::visit(
        [&](const auto& one) {
          Eigen::Matrix<double, 6, 1> phi = Eigen::Matrix<double, 6, 1>::Zero();
          one.residual(k, phi.data());
          most = std::max(most, phi.cwiseAbs().maxCoeff());
        },
        j);
  return most;
}

}  // namespace orthant
