// core/mechanics/scene/scene_schema.h — JSON Schema of scene files, for editors (taplo) and other programs.
//
// The keys are recorded while the reader reads one small scene of each kind and type (toml/field_record.h), so that
// reader and schema agree. Rules between keys are left to the reader.
// Two definitions, "plane" and "space"; dimension = 3 chooses the latter.
#pragma once

#include <string>

namespace orthant {

/// Draft 7, as text.
std::string scene_schema();

}  // namespace orthant
