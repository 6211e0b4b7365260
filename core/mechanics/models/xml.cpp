// XML parser: the part of xml.h that needs TinyXML-2.
#include <orthant/core/mechanics/models/xml.h>
#include <orthant/core/support/shortened.h>

#include <tinyxml2.h>

#include <algorithm>
#include <stdexcept>

namespace orthant::models {
namespace {

constexpr std::ptrdiff_t kMostTags = 200000, kMostAttributes = 1000000;

[[noreturn]] void refuse_xml(const std::string& file, int line, const std::string& sentence) {
  throw std::invalid_argument(file + ":" + std::to_string(line) + ": " + sentence);
}

void refuse_document_type(const tinyxml2::XMLNode& node, const std::string& file) {
  for (const auto* child = node.FirstChild(); child != nullptr; child = child->NextSibling())
    if (child->ToUnknown() != nullptr)
      refuse_xml(file, child->GetLineNum(), "<!" + shortened(child->Value(), 40) + ": must have no document type");
}

XmlElement tree_of(const tinyxml2::XMLElement& from, const std::string& file) {
  XmlElement element{.name = from.Name(), .file = file, .line = from.GetLineNum(), .attributes = {}, .children = {}};
  for (const auto* a = from.FirstAttribute(); a != nullptr; a = a->Next()) {
    for (const XmlAttribute& other : element.attributes)
      if (other.name == a->Name())
        refuse_xml(file, a->GetLineNum(), "attribute \"" + shortened(a->Name(), 40) + "\": is given twice");
    element.attributes.push_back({a->Name(), a->Value(), a->GetLineNum()});
  }
  refuse_document_type(from, file);
  for (const auto* child = from.FirstChildElement(); child != nullptr; child = child->NextSiblingElement())
    element.children.push_back(tree_of(*child, file));
  return element;
}

}  // namespace

bool has_xml() { return true; }

XmlElement parse_xml(std::string_view text, const std::string& file) {
  if (std::count(text.begin(), text.end(), '<') > kMostTags)
    throw std::invalid_argument(file + ": has more than " + std::to_string(kMostTags) + " tags: must have less");
  if (std::count(text.begin(), text.end(), '=') > kMostAttributes)
    throw std::invalid_argument(file + ": has more than " + std::to_string(kMostAttributes) +
                                " attributes: must have less");
  if (text.find('\0') != std::string_view::npos)
    throw std::invalid_argument(file + ": has a byte of value 0: must be text");
  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    if (document.ErrorID() == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED)
      refuse_xml(file, document.ErrorLineNum(),
                 "elements are nested too deep: must be at most " + std::to_string(TINYXML2_MAX_ELEMENT_DEPTH));
    std::string why = document.ErrorName();
    why = why.substr(why.starts_with("XML_ERROR_") ? 10 : 0);
    refuse_xml(file, std::max(1, document.ErrorLineNum()), "is no XML: " + shortened(why));
  }
  refuse_document_type(document, file);
  const tinyxml2::XMLElement* root = document.RootElement();
  if (root == nullptr) throw std::invalid_argument(file + ": must have an element");
  if (const auto* second = root->NextSiblingElement())
    refuse_xml(file, second->GetLineNum(), "<" + shortened(second->Name(), 40) + ">: must be the only root element");
  return tree_of(*root, file);
}

}  // namespace orthant::models
