// core/mechanics/models/files.h — files that a model names: meshes, included parts; only from one folder.
//
//   Relative names start at the folder of the model's file (in MJCF at meshdir in it), package://NAME/PATH and
//   model://NAME/PATH at the allowed folder or at NAME in it. The resulting file, links resolved, must lie in the
//   allowed folder: the model's own, or the one of the option `folder`. A model without a file cannot name others.
#pragma once

#include <orthant/core/mechanics/models/attributes.h>

#include <cstdint>
#include <filesystem>

namespace orthant::models {

class ModelFiles {
 public:
  /// `file`: the model's; `allowed`: may be empty.
  ModelFiles(const std::filesystem::path& file, const std::filesystem::path& allowed);

  /// Where the name leads. Throws std::invalid_argument naming element, value and rule.
  std::filesystem::path find(const XmlElement& element, const XmlAttribute& attribute, const std::string& name,
                             const std::filesystem::path& below = {}) const;
  /// Its bytes, at most `most` [bytes]. All files of a model together: at most kMostFiles.
  std::string read(const XmlElement& element, const XmlAttribute& attribute, const std::filesystem::path& file,
                   std::uintmax_t most);

  static constexpr int kMostFiles = 1000;

 private:
  std::filesystem::path folder_, allowed_;  // canonical; folder_ is empty without a file
  int count_ = 0;
};

}  // namespace orthant::models
