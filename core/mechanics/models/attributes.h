// core/mechanics/models/attributes.h — attributes of XML elements as numbers and words; errors name file, line,
// element, attribute, value and rule.
#pragma once

#include <orthant/core/mechanics/blocks.h>
#include <orthant/core/mechanics/models/xml.h>

#include <array>
#include <optional>
#include <span>

namespace orthant::models {

using Attribute = const XmlAttribute*;  // null: it is not there

/// "arm.urdf:12: <mass>: value = 'x': must be a number".
[[noreturn]] void refuse(const XmlElement& element, const XmlAttribute& attribute, const std::string& rule);
[[noreturn]] void refuse(const XmlElement& element, const std::string& sentence);

/// Finite numbers between white space, `least` to `most` of them.
std::vector<double> numbers_of(const XmlElement& element, const XmlAttribute& attribute, std::size_t least,
                               std::size_t most);
double number_of(const XmlElement& element, const XmlAttribute& attribute);
Vector3d vector_of(const XmlElement& element, const XmlAttribute& attribute);
/// A unit vector; of zero length it is refused.
Vector3d direction_of(const XmlElement& element, const XmlAttribute& attribute);
bool truth_of(const XmlElement& element, const XmlAttribute& attribute);  // true or false
/// The place of the word in `words`.
std::size_t choice_of(const XmlElement& element, const XmlAttribute& attribute,
                      std::span<const std::string_view> words);

/// The attribute, which must be there.
const XmlAttribute& needed(const XmlElement& element, std::string_view attribute);

}  // namespace orthant::models
