// XML tree: the part of xml.h that needs no library.
#include <orthant/core/mechanics/models/xml.h>
#include <orthant/core/support/shortened.h>

#include <algorithm>

namespace orthant::models {

const XmlAttribute* XmlElement::find(std::string_view attribute) const {
  for (const XmlAttribute& a : attributes)
    if (a.name == attribute) {
      a.read = true;
      return &a;
    }
  return nullptr;
}

std::vector<const XmlElement*> XmlElement::all(std::string_view child) const {
  std::vector<const XmlElement*> found;
  for (const XmlElement& c : children)
    if (c.name == child) c.read = true, found.push_back(&c);
  return found;
}

const XmlElement* XmlElement::first(std::string_view child) const {
  for (const XmlElement& c : children)
    if (c.name == child) {
      c.read = true;
      return &c;
    }
  return nullptr;
}

std::string XmlElement::place() const {
  std::string text = file + ":" + std::to_string(line) + ": <" + shortened(name, 40);
  for (const XmlAttribute& a : attributes)
    if (a.name == "name") text += " name=\"" + shortened(a.value, 40) + "\"";
  return text + ">";
}

bool looks_like_xml(std::string_view text) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  const auto first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '<';
}

namespace {

struct Unread {
  std::string what, names;
  int line = 0, count = 0, named = 0;
};

void add_unread(std::vector<Unread>& all, const std::string& what, int line, const std::string& name) {
  constexpr int kMostNames = 6;
  auto found = std::find_if(all.begin(), all.end(), [&](const Unread& u) { return u.what == what; });
  if (found == all.end()) found = all.insert(all.end(), Unread{what, "", line});
  ++found->count;
  if (name.empty() || ++found->named > kMostNames + 1) return;
  found->names += (found->named == 1 ? " " : ", ") + (found->named > kMostNames ? "..." : shortened(name, 40));
}

void collect(const XmlElement& element, std::vector<Unread>& all) {
  for (const XmlAttribute& a : element.attributes)
    if (!a.read && a.name != "name" && !a.name.starts_with("xmlns"))
      add_unread(all, shortened(a.name, 40) + " of <" + shortened(element.name, 40) + ">", a.line, "");
  for (const XmlElement& child : element.children) {
    if (child.read) {
      collect(child, all);
      continue;
    }
    std::string name;
    for (const XmlAttribute& a : child.attributes)
      if (a.name == "name") name = a.value;
    add_unread(all, "<" + shortened(child.name, 40) + "> of <" + shortened(element.name, 40) + ">", child.line, name);
  }
}

}  // namespace

std::vector<std::string> unread(const XmlElement& root) {
  std::vector<Unread> all;
  collect(root, all);
  std::vector<std::string> texts;
  for (const Unread& u : all)
    texts.push_back(u.what + u.names + (u.count > 1 ? " (" + std::to_string(u.count) + " times, line " : " (line ") +
                    std::to_string(u.line) + ")");
  return texts;
}

}  // namespace orthant::models
