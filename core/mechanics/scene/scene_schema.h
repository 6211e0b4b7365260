// core/mechanics/scene/scene_schema.h — JSON Schema of scene files, for editors (taplo) and other programs.
//
// The keys are those that the reader of scenes asks for (toml/field_record.h), recorded while it reads one small scene
// of each kind and type: reader and schema cannot differ. Rules between keys are left to the reader.
// Two definitions, "plane" and "space"; dimension = 3 chooses the latter.
#pragma once

#include <string>

namespace orthant {

/// Draft 7, as text.
std::string scene_schema();

}  // namespace orthant
