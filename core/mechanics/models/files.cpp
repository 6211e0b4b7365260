#include <orthant/core/mechanics/models/files.h>
#include <orthant/core/support/file.h>

#include <algorithm>
#include <stdexcept>

namespace orthant::models {
namespace {

namespace fs = std::filesystem;

}  // namespace

ModelFiles::ModelFiles(const fs::path& file, const fs::path& allowed) {
  std::error_code error;
  if (fs::is_regular_file(file, error)) folder_ = fs::canonical(file).parent_path();
  allowed_ = folder_;
  if (allowed.empty()) return;
  if (!fs::is_directory(allowed, error))
    throw std::invalid_argument("option model.folder = '" + allowed.string() + "': must be a folder that exists");
  allowed_ = fs::canonical(allowed);
}

fs::path ModelFiles::find(const XmlElement& element, const XmlAttribute& attribute, const std::string& name,
                          const fs::path& below) const {
  if (folder_.empty()) refuse(element, attribute, "left out: a model without a file of its own names no others");
  if (name.empty()) refuse(element, attribute, "the name of a file");
  std::vector<fs::path> places;
  std::string rest = name;
  const auto scheme = [&](std::string_view prefix) {
    if (!rest.starts_with(prefix)) return false;
    rest.erase(0, prefix.size());
    return true;
  };
  if (scheme("package://") || scheme("model://")) {
    const auto slash = rest.find('/');
    if (slash == std::string::npos) refuse(element, attribute, "package://NAME/PATH");
    places = {allowed_ / rest.substr(slash + 1), allowed_ / rest};
  } else {
    scheme("file://");
    if (rest.find("://") != std::string::npos)
      refuse(element, attribute, "a file, or package://NAME/PATH: nothing is fetched");
    places = {folder_ / below / rest};
  }
  for (const fs::path& place : places) {
    std::error_code error;
    const fs::path found = fs::weakly_canonical(place, error);
    if (error || !lies_in(found, allowed_))
      refuse(element, attribute, "in the folder " + allowed_.string() + " (--set model.folder=PATH allows another)");
    if (fs::is_regular_file(found, error)) return found;
  }
  refuse(element, attribute, "a file that exists, " + fs::weakly_canonical(places.front()).string() + " does not");
}

std::string ModelFiles::read(const XmlElement& element, const XmlAttribute& attribute, const fs::path& file,
                             std::uintmax_t most) {
  if (++count_ > kMostFiles) refuse(element, "is file " + std::to_string(count_) + ": must be less");
  try {
    return read_whole(file, largest_input(most));
  } catch (const std::runtime_error& error) {
    refuse(element, attribute, std::string("a file that can be read: ") + error.what());
  }
}

}  // namespace orthant::models
