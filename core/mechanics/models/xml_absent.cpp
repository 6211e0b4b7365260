// In place of xml.cpp where the build has no TinyXML-2: models are refused, with what is missing.
#include <orthant/core/mechanics/models/xml.h>

#include <stdexcept>

namespace orthant::models {

bool has_xml() { return false; }

XmlElement parse_xml(std::string_view /*text*/, const std::string& file) {
  throw std::invalid_argument(file +
                              ": URDF and MJCF need TinyXML-2, which this build has not: install libtinyxml2-dev, "
                              "then build with ORTHANT_WITH_TINYXML2=ON");
}

}  // namespace orthant::models
