// core/lcp/files/hdf5_image.h — HDF5 image in memory, written to disk as a whole or not at all (file.h).
#pragma once

#include <memory>
#include <span>
#include <string>

namespace orthant {

namespace detail {

/// While it lives the HDF5 library prints nothing; the caller's settings come back.
class Hdf5Quiet {
 public:
  Hdf5Quiet();
  Hdf5Quiet(const Hdf5Quiet&) = delete;
  Hdf5Quiet& operator=(const Hdf5Quiet&) = delete;
  ~Hdf5Quiet();

 private:
  int (*print_)(long, void*) = nullptr;
  void* data_ = nullptr;
};

}  // namespace detail

/// Paths as "group/name"; a group is made before what is in it. Throws std::runtime_error where the library fails.
class Hdf5Image {
 public:
  Hdf5Image();
  ~Hdf5Image();
  void group(const std::string& path);
  void whole(const std::string& path, int value);  // as an array of one
  void numbers(const std::string& path, std::span<const int> x);
  void numbers(const std::string& path, std::span<const double> x);
  void text(const std::string& path, const std::string& words);
  std::string bytes();

 private:
  detail::Hdf5Quiet quiet_;
  struct File;
  std::unique_ptr<File> file_;
};

}  // namespace orthant
