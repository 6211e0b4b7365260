// Scene of a model: values at the start, bodies from links that move as one, the text as a whole.
#include <orthant/core/mechanics/models/attributes.h>
#include <orthant/core/mechanics/models/scene_text.h>
#include <orthant/core/mechanics/models/toml_values.h>

#include <algorithm>
#include <stdexcept>

namespace orthant::models {

std::string SceneText::write() {
  set_starts();
  make_carriers();
  for (std::size_t c = 1; c < carriers_.size(); ++c) body(carriers_[c]);
  for (std::size_t c = 1; c < carriers_.size(); ++c) joints(carriers_[c]);
  for (const ModelTie& tie : model_.ties) add_tie(tie);
  shapes();
  std::string text = "# " + model_.format + " model " + in_quotes(in_one_line(model_.name)) + ", imported. SI units.\n";
  for (const std::string& note : model_.notes) text += "# " + in_one_line(note) + "\n";
  text += "dimension = 3\ngravity = " + list(model_.gravity) + "\nstep = " + number(model_.step) + "\n";
  return text + bodies_ + joints_ + contacts_ + collisions_ + frictions_ + springs_;
}

void SceneText::set_starts() {
  std::string known;
  auto wanted = options_.at;
  for (ModelLink& link : model_.links)
    for (ModelJoint& j : link.joints) {
      if (!j.coordinate()) continue;
      known += (known.empty() ? "" : ", ") + j.name;
      if (const auto given = wanted.find(j.name); given != wanted.end()) {
        j.start = given->second;
        wanted.erase(given);
        continue;
      }
      const double before = j.start;
      if (j.lower) j.start = std::max(j.start, *j.lower);
      if (j.upper) j.start = std::min(j.start, *j.upper);
      if (j.start != before)
        note("joint " + j.name + " starts at its limit, " + number(j.start) + ": its zero is beyond it");
    }
  if (!wanted.empty())
    throw std::invalid_argument("option model.at." + shortened(wanted.begin()->first) +
                                ": must be the name of a joint that turns or slides, one of " +
                                (known.empty() ? "(the model has none)" : shortened(known, 400)));
}

Place SceneText::motion(const ModelJoint& j) {
  const double by = j.start - j.reference;
  if (by == 0 || !j.coordinate()) return {};
  if (j.kind == ModelJoint::Kind::slide) return {Matrix3d::Identity(), by * j.axis};
  const Matrix3d R = Eigen::AngleAxisd(by, j.axis).toRotationMatrix();
  return {R, j.anchor - R * j.anchor};
}

void SceneText::make_carriers() {
  carrier_of_.resize(model_.links.size());
  in_carrier_.resize(model_.links.size());
  carriers_.emplace_back();
  std::vector<Place> world(model_.links.size());
  for (std::size_t i = 0; i < model_.links.size(); ++i) {
    const ModelLink& link = model_.links[i];
    Place at = link.at;
    for (const ModelJoint& j : link.joints) at = at * motion(j);
    const auto up = static_cast<std::size_t>(std::max(0, link.parent));
    world[i] = i == 0 ? Place{} : world[up] * at;
    const bool part = link.joints.empty() && (options_.fixed_joints == ModelOptions::FixedJoints::merge ||
                                              link.mass == 0 || (carrier_of_[up] == 0 && link.parent == 0));
    if (i == 0 || part) {
      if (i > 0) carrier_of_[i] = carrier_of_[up], in_carrier_[i] = in_carrier_[up] * link.at;
      if (i > 0) (carrier(i).parts += carrier(i).parts.empty() ? "" : ", ") += shortened(link.name);
    } else {
      carrier_of_[i] = static_cast<int>(carriers_.size());
      Carrier c;
      c.name = body_names_.take(link.name, "body" + std::to_string(carriers_.size()));
      c.link = static_cast<int>(i), c.parent = carrier_of_[up], c.world = world[i];
      c.root = c.parent == 0 ? carrier_of_[i] : carriers_[static_cast<std::size_t>(c.parent)].root;
      carriers_.push_back(c);
    }
    add_part(carrier(i).whole, link, in_carrier_[i]);
  }
  if (carriers_.size() == 1) {
    const ModelLink& last = model_.links.back();
    std::string left_out;
    for (const std::string& one : model_.notes)
      if (one.find("> of <worldbody>") < one.size() || one.find("> of <body>") < one.size()) left_out += "; " + one;
    const std::string why =
        "nothing can move: must have a joint that moves, or a base that is free "
        "(--set model.base=free)" +
        left_out;
    if (last.element == nullptr) throw std::invalid_argument(model_.file + ": " + why);
    refuse(*last.element, why);
  }
  for (const Carrier& c : carriers_) {
    if (c.link == 0) continue;
    const XmlElement& element = *model_.links[static_cast<std::size_t>(c.link)].element;
    if (!(c.whole.mass > 0)) refuse(element, "has no mass, but moves: must have a mass and an inertia");
    check_inertia(element, c.whole.inertia);
  }
}

void SceneText::add_part(ModelLink& whole, const ModelLink& part, const Place& at) {
  add_mass(whole, part.mass, at * part.centre, at.R * part.inertia * at.R.transpose());
  for (ModelShape shape : part.shapes) {
    shape.at = at * shape.at;
    for (Vector3d& corner : shape.corners) corner = at * corner;
    whole.shapes.push_back(shape);
  }
}

void SceneText::body(const Carrier& c) {
  const ModelLink& w = c.whole;
  const Matrix3d J = (w.inertia + w.inertia.transpose()) / 2;
  bodies_ += "\n[[body]]\nname = " + in_quotes(c.name) + "\n";
  const ModelLink& link = model_.links[static_cast<std::size_t>(c.link)];
  if (link.name != c.name) bodies_ += "# link " + in_one_line(shortened(link.name)) + "\n";
  if (!c.parts.empty()) bodies_ += "# with " + c.parts + "\n";
  bodies_ += "mass = " + number(w.mass) + "\n";
  Matrix3d across = J;
  across.diagonal().setZero();
  if (across.isZero(0))
    bodies_ += "inertia = " + list(J.diagonal()) + "\n";
  else
    bodies_ += "inertia = [" + list(J.row(0)) + ", " + list(J.row(1)) + ", " + list(J.row(2)) + "]\n";
  bodies_ += "position = " + list(Vector3d(c.world * w.centre)) + "\n";
  if (!c.world.R.isIdentity(0)) bodies_ += "orientation = " + list(quaternion_of(c.world.R)) + "\n";
}

std::string scene_text(Model& model, const ModelOptions& options) { return SceneText(model, options).write(); }

}  // namespace orthant::models
