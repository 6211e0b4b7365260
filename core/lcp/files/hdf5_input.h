// core/lcp/files/hdf5_input.h — reader of HDF5 files of arrays and texts, as Hdf5Image writes them.
#pragma once

#include <orthant/core/lcp/files/hdf5_image.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace orthant {

/// Paths as "group/name". Throws std::runtime_error naming file, path and rule. Data are read only from this file: data
/// sets that stand in other files (external links and storage, virtual sets) are refused.
class Hdf5Input {
 public:
  explicit Hdf5Input(const std::filesystem::path& file);
  ~Hdf5Input();
  std::vector<std::string> arrays() const;  // names of the data sets outside of groups, alphabetically
  bool has(const std::string& path) const;  // throws where a part of it is a link to another file
  std::uintmax_t most_numbers() const;      // that a file of this size can hold, deflated and of one byte each
  std::vector<double> numbers(const std::string& path) const;
  std::vector<int> integers(const std::string& path) const;
  std::string text(const std::string& path) const;  // at most 64 MiB
  [[noreturn]] void refuse(const std::string& path, const std::string& rule) const;

 private:
  template <class Number> std::vector<Number> list(const std::string& path) const;
  detail::Hdf5Quiet quiet_;
  struct File;
  std::unique_ptr<File> file_;
};

}  // namespace orthant
