#include <orthant/core/mechanics/models/attributes.h>
#include <orthant/core/support/shortened.h>

#include <charconv>
#include <cmath>
#include <stdexcept>

namespace orthant::models {

void refuse(const XmlElement& element, const XmlAttribute& attribute, const std::string& rule) {
  throw std::invalid_argument(element.place() + ": " + shortened(attribute.name, 40) + " = '" +
                              shortened(attribute.value) + "': must be " + rule);
}

void refuse(const XmlElement& element, const std::string& sentence) {
  throw std::invalid_argument(element.place() + ": " + sentence);
}

std::vector<double> numbers_of(const XmlElement& element, const XmlAttribute& attribute, std::size_t least,
                               std::size_t most) {
  constexpr std::string_view kSpace = " \t\r\n";
  const std::string rule =
      most == 1 ? "a number"
                : (least == most ? "" : std::to_string(least) + " to ") + std::to_string(most) + " numbers";
  std::vector<double> all;
  std::string_view rest = attribute.value;
  while (true) {
    const auto first = rest.find_first_not_of(kSpace);
    if (first == std::string_view::npos) break;
    rest.remove_prefix(first);
    const auto length = std::min(rest.find_first_of(kSpace), rest.size());
    std::string_view word = rest.substr(0, length);
    rest.remove_prefix(length);
    if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
    double value = 0;
    const auto read = std::from_chars(word.data(), word.data() + word.size(), value);
    if (read.ec != std::errc{} || read.ptr != word.data() + word.size() || !std::isfinite(value) || all.size() == most)
      refuse(element, attribute, rule);
    all.push_back(value);
  }
  if (all.size() < least) refuse(element, attribute, rule);
  return all;
}

double number_of(const XmlElement& element, const XmlAttribute& attribute) {
  return numbers_of(element, attribute, 1, 1)[0];
}

Vector3d vector_of(const XmlElement& element, const XmlAttribute& attribute) {
  const auto x = numbers_of(element, attribute, 3, 3);
  return {x[0], x[1], x[2]};
}

Vector3d direction_of(const XmlElement& element, const XmlAttribute& attribute) {
  const Vector3d x = vector_of(element, attribute);
  if (x.isZero(0)) refuse(element, attribute, "a direction, not zero");
  return x.stableNormalized();
}

bool truth_of(const XmlElement& element, const XmlAttribute& attribute) {
  if (attribute.value != "true" && attribute.value != "false") refuse(element, attribute, "true or false");
  return attribute.value == "true";
}

std::size_t choice_of(const XmlElement& element, const XmlAttribute& attribute,
                      std::span<const std::string_view> words) {
  std::string list;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i] == attribute.value) return i;
    list += (i > 0 ? ", " : "") + std::string(words[i]);
  }
  refuse(element, attribute, "one of " + list);
}

const XmlAttribute& needed(const XmlElement& element, std::string_view attribute) {
  const Attribute found = element.find(attribute);
  if (found == nullptr) refuse(element, "missing attribute " + std::string(attribute));
  return *found;
}

}  // namespace orthant::models
