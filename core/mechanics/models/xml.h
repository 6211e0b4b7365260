// core/mechanics/models/xml.h — XML parser: a tree of elements with their lines, and a mark of each attribute that has
// been read.
//
//   const XmlElement robot = parse_xml(text, "arm.urdf");
//   const XmlAttribute* mass = robot.children[0].find("mass");  // marks it as read
// Not for general XML: text between elements is dropped, and only the five entities of XML and character numbers are
// accepted.
// Refused with file and line: text that is no XML, document types (so no entity can be defined, expanded or fetched),
// more than 100 nested elements, 200 000 tags or a million attributes.
// By TinyXML-2, which reads no other file; a build without it reports that it is missing.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace orthant::models {

struct XmlAttribute {
  std::string name, value;
  int line = 0;
  mutable bool read = false;
};

struct XmlElement {
  std::string name, file;
  int line = 0;
  mutable bool read = false;
  std::vector<XmlAttribute> attributes;
  std::vector<XmlElement> children;

  const XmlAttribute* find(std::string_view attribute) const;
  /// The children of that name, marked as read.
  std::vector<const XmlElement*> all(std::string_view child) const;
  /// The first one of them, or null. Others stay unread.
  const XmlElement* first(std::string_view child) const;
  /// "arm.urdf:12: <link name="arm">".
  std::string place() const;
};

/// The root element. `file` stands for the text in messages. Throws std::invalid_argument.
XmlElement parse_xml(std::string_view text, const std::string& file);

/// The text begins as XML does: with '<', after spaces and a byte order mark.
bool looks_like_xml(std::string_view text);

bool has_xml();

/// Parts of the tree that were not read, one entry per kind: `<gazebo> (3 times, line 40)`,
/// `effort of <limit> (line 12)`. Names are no content.
std::vector<std::string> unread(const XmlElement& root);

}  // namespace orthant::models
