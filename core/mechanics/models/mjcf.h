// core/mechanics/models/mjcf.h — MJCF import: reads a model in MuJoCo's XML.
//
// Taken: compiler (angle, eulerseq, autolimits, inertiafromgeom, inertiagrouprange, boundmass, boundinertia,
// balanceinertia, meshdir, assetdir, strippath), option (gravity, timestep), default classes, include, frames; bodies
// with inertial or with the masses of their geoms; joints hinge, slide, ball, free with ref, range, damping,
// frictionloss, stiffness, springref; geoms plane, sphere, capsule, ellipsoid, cylinder, box, mesh with mass, density,
// friction (sliding), contype, conaffinity; contact exclude; equality connect and weld between bodies.
// The rest is listed in Model::notes: actuators, tendons, sensors, armature, soft contacts, equality of joints, …
// Source: MuJoCo's XML reference (mujoco.readthedocs.io).
#pragma once

#include <orthant/core/mechanics/models/files.h>
#include <orthant/core/mechanics/models/model.h>

namespace orthant::models {

/// Included files become parts of `root`, which has to outlive the model. Throws std::invalid_argument naming file,
/// line, element and rule.
Model read_mjcf(XmlElement& root, ModelFiles& files);

}  // namespace orthant::models
