// core/mechanics/models/urdf.h — URDF import: reads a robot as a model.
//
// Taken: links with inertial (any frame), collision shapes (box, sphere, cylinder, capsule, mesh: the convex hull of an
// STL or OBJ file, scaled); joints revolute, continuous, prismatic, fixed, planar, floating with origin, axis, limits,
// damping, friction. The rest is listed in Model::notes: visual shapes, motors (effort, velocity), mimic, and so on.
// Source: the URDF specification of ROS (wiki.ros.org/urdf/XML).
#pragma once

#include <orthant/core/mechanics/models/files.h>
#include <orthant/core/mechanics/models/model.h>

namespace orthant::models {

/// The tree behind `root` has to outlive the model. Throws std::invalid_argument naming file, line, element, rule.
Model read_urdf(const XmlElement& root, ModelFiles& files, const ModelOptions& options);

}  // namespace orthant::models
