#include <orthant/core/mechanics/scene/scene_schema.h>

#include <orthant/core/mechanics/scene/scene_toml.h>

#include "toml/field_record.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <map>

namespace orthant {
namespace {

using Json = nlohmann::ordered_json;
using scene_file::FieldRecord;
using scene_file::FieldRecorder;
using scene_file::Form;

constexpr const char* kTwoBodies = R"(
[[body]]
name = "a"
mass = 1
inertia = 1
position = [0, 1]
[[body]]
name = "b"
mass = 1
inertia = 1
position = [1, 3]
)";

/// One element of each kind and type, with every alternative that asks for other keys.
constexpr std::array kSamples = {
    "[[joint]]\ntype = 'revolute'\nbodies = ['a', 'b']",
    "[[joint]]\ntype = 'prismatic'\nbodies = ['a', 'b']",
    "[[joint]]\ntype = 'fixed'\nbodies = ['a', 'b']",
    "[[joint]]\ntype = 'distance'\nbodies = ['a', 'b']",
    "[[joint]]\ntype = 'drive'\nof = 'angle'\nbodies = ['ground', 'a']\ntable = {times = [0, 1, 2], values = [0, 1, "
    "0]}",
    "[[joint]]\ntype = 'drive'\nof = 'slide'\nbodies = ['ground', 'a']",
    "[[joint]]\ntype = 'drive'\nof = 'distance'\nbodies = ['ground', 'a']",
    "[[joint]]\ntype = 'revolute'\nname = 'pin'\nbodies = ['a', 'b']\n[[joint]]\ntype = 'drive'\njoint = 'pin'",
    "[[joint]]\ntype = 'revolute'\nname = 'pin'\nbodies = ['a', 'b']\n[[contact]]\ntype = 'limit'\njoint = "
    "'pin'\nlower = -9",
    "[[joint]]\ntype = 'revolute'\nname = 'pin'\nbodies = ['a', 'b']\n[[spring]]\ntype = 'joint'\njoint = 'pin'",
    "[[joint]]\ntype = 'revolute'\nname = 'pin'\nbodies = ['a', 'b']\n[[joint]]\ntype = 'relation'\nterms = [{joint "
    "= 'pin'}]",
    "[[joint]]\ntype = 'revolute'\nname = 'pin'\nbodies = ['a', 'b']\n[[contact]]\ntype = 'relation'\nlower = "
    "-9\nterms = [{joint = 'pin'}]",
    "[[joint]]\ntype = 'relation'\nterms = [{of = 'slide', bodies = ['ground', 'a']}, {of = 'angle', bodies = "
    "['ground', "
    "'b']}]",
    "[[joint]]\ntype = 'gear'\nbodies = ['a', 'b']\nratio = 2",
    "[[contact]]\ntype = 'corner-wall'\nbody = 'a'\nwall = {normal = [0, 1]}",
    "[[contact]]\ntype = 'disc-wall'\nbody = 'a'\nradius = 0.1\nwall = {normal = [0, 1]}",
    "[[contact]]\ntype = 'disc-disc'\nbodies = ['a', 'b']\nradius_a = 0.1\nradius_b = 0.1",
    "[[contact]]\ntype = 'polygon-wall'\nbody = 'a'\ncorners = [[0, 0], [1, 0], [0, 1]]\nwall = {normal = [0, 1]}",
    "[[contact]]\ntype = 'disc-polygon'\nbodies = ['a', 'b']\nradius = 0.1\ncorners = [[0, 0], [1, 0], [0, 1]]",
    "[[contact]]\ntype = 'polygon-polygon'\nbodies = ['a', 'b']\ncorners_a = [[0, 0], [1, 0], [0, 1]]\ncorners_b = "
    "[[0, "
    "0], [1, 0], [0, 1]]",
    "[[contact]]\ntype = 'chain'\nbodies = ['a', 'ground']\nradius = 0.1\npoints = [[0, 0], [1, 0]]",
    "[[contact]]\ntype = 'chain'\nbodies = ['a', 'ground']\ncorners = [[0, 0], [1, 0], [0, 1]]\npoints = [[0, 0], [1, "
    "0]]",
    "[[contact]]\ntype = 'journal'\nbodies = ['a', 'b']\nradius_a = 0.1\nradius_b = 5",
    "[[contact]]\ntype = 'guide'\nbody = 'a'\nwidth = 0.2\nheight = 0.1\nclearance = 0.01\nwalls = {point = [0, 1]}",
    "[[contact]]\ntype = 'limit'\nof = 'angle'\nbodies = ['ground', 'a']\nlower = -1",
    "[[contact]]\ntype = 'limit'\nof = 'slide'\nbodies = ['ground', 'a']\nupper = 9",
    "[[contact]]\ntype = 'rope'\nbodies = ['a', 'b']\nlength = 3",
    "[[contact]]\ntype = 'relation'\nlower = -9\nterms = [{of = 'slide', bodies = ['ground', 'a']}, {of = 'angle', "
    "bodies "
    "= ['ground', 'b']}]",
    "[[contact]]\ntype = 'pulley'\nbodies = ['a', 'b']\npulley_a = [0, 5]\nlength = 9",
    "[[collision]]\nshapes = [{body = 'a', radius = 0.1}, {body = 'b', corners = [[0, 0], [1, 0], [0, 1]]}]\nwalls = "
    "[{normal = [0, 1]}]\nchains = [{points = [[0, 0], [1, 0]]}]",
    "[[joint]]\ntype = 'revolute'\nname = 'pin'\nbodies = ['a', 'b']\n[[friction]]\njoint = 'pin'\nbound = 1",
    "[[friction]]\nof = 'slide'\nbodies = ['a', 'b']\nbound = 1",
    "[[spring]]\ntype = 'point'\nbodies = ['a', 'b']",
    "[[spring]]\ntype = 'torsion'\nbodies = ['a', 'b']",
    "[[spring]]\ntype = 'joint'\nof = 'slide'\nbodies = ['a', 'b']",
    "[[load]]\nbody = 'a'\nfactor = {type = 'cosine', omega = 1}",
    "[[load]]\nbody = 'a'\nfactor = {type = 'table', times = [0, 1], values = [0, 1]}",
    "[[load]]\nbody = 'a'\nfactor = {type = 'spline', times = [0, 1], values = [0, 1]}",
};

constexpr const char* kTwoInSpace = R"(
dimension = 3
[[body]]
name = "a"
solid = {box = [1, 2, 3]}
density = 1
position = [0, 0, 1]
angle = 0.1
axis = [0, 0, 1]
[[body]]
name = "b"
mass = 1
inertia = 1
position = [1, 3, 0]
)";

constexpr const char* kSurfaceInSpace = "[[contact]]\nsurface = {velocity = [1, 0, 0]}";

constexpr const char* kPinInSpace =
    "[[joint]]\ntype = 'revolute'\nname = 'pin'\nbodies = ['a', 'b']\naxis = [0, 0, 1]\n";

constexpr std::array kSamplesInSpace = {
    "[[joint]]\ntype = 'spherical'\nbodies = ['a', 'b']",
    "[[joint]]\ntype = 'revolute'\nbodies = ['a', 'b']\naxis = [0, 0, 1]",
    "[[joint]]\ntype = 'cylindrical'\nbodies = ['a', 'b']\naxis = [0, 0, 1]",
    "[[joint]]\ntype = 'universal'\nbodies = ['a', 'b']\naxis = [0, 0, 1]\naxis_b = [1, 0, 0]",
    "[[joint]]\ntype = 'screw'\nbodies = ['a', 'b']\naxis = [0, 0, 1]\npitch = 0.1",
    "PIN[[joint]]\ntype = 'revolute'\nname = 'other'\nbodies = ['a', 'b']\naxis = [0, 0, 1]\n"
    "[[joint]]\ntype = 'gear'\njoints = ['pin', 'other']\nratio = 1",
    "[[joint]]\ntype = 'gear'\nbodies = ['a', 'b']\naxis = [0, 0, 1]\nteeth = [20, 60]",
    "PIN[[joint]]\ntype = 'prismatic'\nname = 'rail'\nbodies = ['a', 'b']\naxis = [0, 0, 1]\n"
    "[[joint]]\ntype = 'rack'\njoints = ['pin', 'rail']\nradius = 1",
    "[[joint]]\ntype = 'rack'\nbodies = ['a', 'b']\naxis = [0, 0, 1]\naxis_b = [1, 0, 0]\nradius = 1",
    "[[joint]]\ntype = 'planar'\nbodies = ['a', 'b']\naxis = [0, 0, 1]",
    "[[joint]]\ntype = 'prismatic'\nbodies = ['a', 'b']\naxis = [0, 0, 1]",
    "[[joint]]\ntype = 'fixed'\nbodies = ['a', 'b']",
    "[[joint]]\ntype = 'point-in-plane'\nbodies = ['a', 'b']\naxis = [0, 0, 1]",
    "[[joint]]\ntype = 'point-on-line'\nbodies = ['a', 'b']\naxis = [0, 0, 1]",
    "[[joint]]\ntype = 'distance'\nbodies = ['a', 'b']",
    "[[joint]]\ntype = 'drive'\nof = 'slide'\nbodies = ['a', 'b']\naxis = [1, 0, 0]\ntable = {times = [0, 1, 2], "
    "values = [0, 1, 0]}",
    "PIN[[joint]]\ntype = 'drive'\nof = 'angle'\nbodies = ['a', 'b']\naxis = [0, 0, 1]",
    "[[joint]]\ntype = 'drive'\nof = 'distance'\nbodies = ['a', 'b']",
    "PIN[[joint]]\ntype = 'drive'\njoint = 'pin'",
    "SURFACE\ntype = 'sphere-wall'\nbody = 'a'\nradius = 0.1\nwall = {normal = [0, 0, 1]}",
    "SURFACE\ntype = 'corner-wall'\nbody = 'a'\nwall = {normal = [0, 0, 1]}",
    "SURFACE\ntype = 'box-wall'\nbody = 'a'\nsize = [1, 1, 1]\nwall = {normal = [0, 0, 1]}",
    "SURFACE\ntype = 'polytope-wall'\nbody = 'a'\ncorners = [[0, 0, 0]]\nwall = {normal = [0, 0, 1]}",
    "SURFACE\ntype = 'rim-wall'\nbody = 'a'\nradius = 0.1\nwall = {normal = [0, 0, 1]}",
    "SURFACE\ntype = 'cylinder-wall'\nbody = 'a'\nradius = 0.1\nheight = 1\nwall = {normal = [0, 0, 1]}",
    "SURFACE\ntype = 'cone-wall'\nbody = 'a'\nradius = 0.1\nheight = 1\nwall = {normal = [0, 0, 1]}",
    "SURFACE\ntype = 'ellipsoid-wall'\nbody = 'a'\nsemi_axes = [1, 2, 3]\nwall = {normal = [0, 0, 1]}",
    "SURFACE\ntype = 'sphere-sphere'\nbodies = ['a', 'b']\nradius_a = 0.1\nradius_b = 0.1",
    "SURFACE\ntype = 'socket'\nbodies = ['a', 'b']\nradius_a = 0.1\nradius_b = 0.2",
    "SURFACE\ntype = 'pin-bush'\nbodies = ['a', 'b']\naxis = [0, 0, 1]\nradius_a = 0.1\nradius_b = 0.2\nlength_a = 1",
    "SURFACE\ntype = 'sphere-bush'\nbodies = ['a', 'b']\nradius_a = 0.1\nradius_b = 0.2\naxis_b = [0, 0, 1]",
    "SURFACE\ntype = 'block-channel'\nbodies = ['a', 'b']\naxis = [1, 0, 0]\nup = [0, 0, 1]\nsize = [1, 1, 1]\nwidth = "
    "2\nheight = 2",
    "PIN[[contact]]\ntype = 'limit'\njoint = 'pin'\nlower = -1",
    "[[contact]]\ntype = 'limit'\nof = 'slide'\nbodies = ['a', 'b']\naxis = [1, 0, 0]\nupper = 9",
    "[[spring]]\ntype = 'drag'\nbody = 'a'\nlinear = 1",
    "PIN[[joint]]\ntype = 'revolute'\nname = 'other'\nbodies = ['a', 'b']\naxis = [0, 0, 1]\n"
    "[[contact]]\ntype = 'backlash'\njoints = ['pin', 'other']\nratio = 1\nplay = 0.1",
    "[[contact]]\ntype = 'backlash'\nbodies = ['a', 'b']\naxis = [0, 0, 1]\nteeth = [20, 60]\nplay = 0.1",
    "[[contact]]\ntype = 'backlash'\nbodies = ['a', 'b']\naxis = [0, 0, 1]\naxis_b = [1, 0, 0]\nradius = 1\nplay = 1",
    "PIN[[contact]]\ntype = 'limit'\nof = 'angle'\nbodies = ['a', 'b']\naxis = [0, 0, 1]\nupper = 1",
    "[[contact]]\ntype = 'limit'\nof = 'distance'\nbodies = ['a', 'b']\nupper = 9",
    "[[contact]]\ntype = 'rope'\nbodies = ['a', 'b']\nlength = 9",
    "[[collision]]\nwalls = [{normal = [0, 0, 1]}]\nshapes = [{body = 'a', radius = 1}, {body = 'b', size = [1, 1, "
    "1]},\n"
    "{body = 'a', radius = 1, ends = [[0, 0, 0], [1, 0, 0]]},\n"
    "{body = 'a', corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]},\n"
    "{body = 'a', heights = [[0, 0], [0, 0]]}]",
    "PIN[[friction]]\njoint = 'pin'\nbound = 1",
    "[[friction]]\nof = 'slide'\nbodies = ['a', 'b']\naxis = [1, 0, 0]\nbound = 1",
    "PIN[[friction]]\nof = 'angle'\nbodies = ['a', 'b']\naxis = [0, 0, 1]\nbound = 1",
    "[[friction]]\nof = 'distance'\nbodies = ['a', 'b']\nbound = 1",
    "[[spring]]\ntype = 'point'\nbodies = ['a', 'b']",
    "PIN[[spring]]\ntype = 'joint'\njoint = 'pin'",
    "[[spring]]\ntype = 'joint'\nof = 'slide'\nbodies = ['a', 'b']\naxis = [1, 0, 0]",
    "PIN[[spring]]\ntype = 'joint'\nof = 'angle'\nbodies = ['a', 'b']\naxis = [0, 0, 1]",
    "[[spring]]\ntype = 'joint'\nof = 'distance'\nbodies = ['a', 'b']",
    "[[load]]\nbody = 'a'\nfactor = {type = 'cosine', omega = 1}",
    "[[load]]\nbody = 'a'\nfactor = {type = 'table', times = [0, 1], values = [0, 1]}",
    "[[load]]\nbody = 'a'\nfactor = {type = 'spline', times = [0, 1], values = [0, 1]}",
};

Json array_of(const Json& items) { return {{"type", "array"}, {"items", items}}; }
Json list_of(int count, const Json& items) {
  return {{"type", "array"}, {"items", items}, {"minItems", count}, {"maxItems", count}};
}

Json form_as_json(const FieldRecord& field) {
  const Json number = {{"type", "number"}}, word = {{"type", "string"}};
  switch (field.form) {
    case Form::number:
      return number;
    case Form::boolean:
      return {{"type", "boolean"}};
    case Form::word:
      return word;
    case Form::body:
      return word;
    case Form::pair:
      return list_of(2, number);
    case Form::triple:
      return list_of(3, number);
    case Form::quadruple:
      return list_of(4, number);
    case Form::tensor:
      return {{"anyOf", {number, list_of(3, number), list_of(3, list_of(3, number))}}};
    case Form::numbers:
      return array_of(number);
    case Form::rows:
      return array_of(array_of(number));
    case Form::points_in_space:
      return array_of(list_of(3, number));
    case Form::points:
      return array_of(list_of(2, number));
    case Form::bodies:
      return list_of(2, word);
    case Form::choice:
      return {{"enum", field.choices}};
    case Form::any:
      break;
    case Form::table:
      break;
    case Form::tables:
      break;
  }
  return Json::object();
}

Json object_with(const std::vector<FieldRecord>& fields, const std::string& prefix) {
  Json properties = Json::object(), needed = Json::array();
  for (const FieldRecord& field : fields) {
    if (!field.key.starts_with(prefix)) continue;
    const std::string key = field.key.substr(prefix.size());
    if (key.find('.') != std::string::npos) continue;  // of an inner table
    Json& property = properties[key];
    if (field.form == Form::table)
      property = object_with(fields, prefix + key + ".");
    else if (field.form == Form::tables)
      property = array_of(object_with(fields, prefix + key + "[]."));
    else
      property = form_as_json(field);
    if (field.needed) needed.push_back(key);
  }
  Json object = {{"type", "object"}, {"properties", properties}, {"additionalProperties", false}};
  if (!needed.empty()) object["required"] = needed;
  return object;
}

std::vector<FieldRecord> recorded_fields() {
  const FieldRecorder recorder;
  for (const char* sample : kSamples) parse_scene(std::string(kTwoBodies) + sample);
  return recorder.all();
}

std::vector<FieldRecord> recorded_fields_in_space() {
  const FieldRecorder recorder;
  for (std::string sample : kSamplesInSpace) {
    if (sample.starts_with("PIN")) sample.replace(0, 3, kPinInSpace);
    if (sample.starts_with("SURFACE")) sample.replace(0, 7, kSurfaceInSpace);
    parse_any_scene(kTwoInSpace + sample);
  }
  return recorder.all();
}

Json scenes_with(const std::vector<FieldRecord>& all) {
  std::vector<std::string> kinds;                                                   // in the order of the format
  std::map<std::string, std::map<std::string, std::vector<FieldRecord>>> elements;  // by kind, by type
  std::vector<FieldRecord> top;
  for (const FieldRecord& field : all) {
    if (field.element.empty()) {
      top.push_back(field);
      if (field.form == Form::tables) kinds.push_back(field.key);
    } else {
      elements[field.element][field.type].push_back(field);
    }
  }
  Json schema = object_with(top, "");
  for (const std::string& kind : kinds) {
    Json variants = Json::array();
    for (const auto& [type, fields] : elements[kind]) {
      Json one = object_with(fields, "");
      if (!type.empty()) one["properties"]["type"] = {{"const", type}};
      variants.push_back(one);
    }
    schema["properties"][kind] = array_of(variants.size() == 1 ? variants[0] : Json{{"oneOf", variants}});
  }
  return schema;
}

}  // namespace

std::string scene_schema() {
  Json plane = scenes_with(recorded_fields()), space = scenes_with(recorded_fields_in_space());
  plane["properties"]["dimension"] = {{"const", 2}}, space["properties"]["dimension"] = {{"const", 3}};
  const Json in_plane = {{"$ref", "#/definitions/plane"}}, in_space = {{"$ref", "#/definitions/space"}};
  const Json all = {
      {"$schema", "http://json-schema.org/draft-07/schema#"},
      {"title", "Orthant scene"},
      {"description", "A mechanism: bodies, joints, contacts, friction, springs, loads. SI units."},
      {"if", {{"properties", {{"dimension", {{"const", 3}}}}}, {"required", {"dimension"}}}},
      {"then", in_space},
      {"else", in_plane},
      {"anyOf", {true, in_plane, in_space}},  // refuses nothing: taplo completes from it, and not from then and else
      {"definitions", {{"plane", plane}, {"space", space}}}};
  return all.dump(2) + "\n";
}

}  // namespace orthant
