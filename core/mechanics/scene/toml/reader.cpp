// Planar scenes from TOML: bodies, sizes, order of the tables.
#include "reader.h"

namespace orthant::scene_file {

Scene Reader::scene() {
  Fields top(root_, "", file_);
  if (const toml::node* dimension = root_.get("dimension"); dimension != nullptr && dimension->value<double>() != 2)
    top.refuse("dimension", *dimension, "2 here, or 3 where scenes in space are taken");
  top.maybe("gravity", scene_.gravity), top.maybe("duration", scene_.duration), top.maybe("step", scene_.step);
  top.maybe("assemble", scene_.assemble);
  top.choice("restitution", scene_.restitution, kRestitutionNames);
  top.choice("impacts", scene_.impacts, kImpactsNames);
  each(top, "body", [&](Fields& f) { body(f); });
  pose_bodies();
  each(top, "joint", [&](Fields& f) { joint(f); });
  each(top, "contact", [&](Fields& f) { contact(f); });
  each(top, "collision", [&](Fields& f) { collision(f); });
  each(top, "friction", [&](Fields& f) { friction(f); });
  each(top, "spring", [&](Fields& f) { spring(f); });
  each(top, "load", [&](Fields& f) { load(f); });
  top.find("dimension");
  top.done();
  try {
    check(scene_);
  } catch (const SceneError& error) {
    throw std::invalid_argument(place(find(error), file_) + ": " + error.what());
  }
  const std::size_t written = scene_.contacts.size();
  list_pairs();
  try {
    if (scene_.contacts.size() > written) check_contacts(scene_, written);
  } catch (const SceneError& error) {
    throw std::invalid_argument(file_ + ": " + error.what());
  }
  return std::move(scene_);
}

void Reader::body(Fields& f) {
  Body b;
  f.need("name", b.name), f.need("mass", b.mass), f.need("inertia", b.inertia);
  f.maybe("position", b.position), f.maybe("angle", b.angle);
  f.maybe("velocity", b.velocity), f.maybe("omega", b.omega);
  if (b.name.empty()) f.refuse("name", *f.table().get("name"), "of letters, digits, _ and -");
  ids_.emplace(b.name, scene_.body(b));
}

void Reader::pose_bodies() {
  for (const Body& b : scene_.bodies)
    initial_.pose.push_back({b.position, b.angle, std::cos(b.angle), std::sin(b.angle)});
  initial_.pose.emplace_back();
}

BodyId Reader::id(const Fields& f, std::string_view key, const toml::node& node) const {
  const auto name = node.value_exact<std::string>();
  if (name && *name == "ground") return kGround;
  const auto found = name ? ids_.find(*name) : ids_.end();
  if (found == ids_.end()) {
    std::vector<std::string> names{"ground"};
    for (const Body& b : scene_.bodies) names.push_back(b.name);
    f.refuse(key, node, "the name of a body: " + join(names));
  }
  return found->second;
}

BodyId Reader::body_of(Fields& f) const {
  std::string unused;
  f.need("body", unused);
  return id(f, "body", *f.table().get("body"));
}

const toml::node& Reader::find(const SceneError& error) const {
  if (error.kind.empty()) {
    const toml::node* key = root_.get(error.field);
    return key != nullptr ? *key : root_;
  }
  const std::size_t index = error.kind == "contact" ? written_[error.index] : error.index;
  const toml::table& element = *root_.get(error.kind)->as_array()->get(index)->as_table();
  const toml::node* key = element.get(error.field);
  return key != nullptr ? *key : element;
}

}  // namespace orthant::scene_file
