#include <orthant/core/lcp/files/hdf5_input.h>

#include <orthant/core/lcp/files/io.h>
#include <orthant/core/support/file.h>

#include <H5Cpp.h>

#include <stdexcept>

namespace orthant {
namespace {

constexpr std::uintmax_t kLargestArray = 1 << 30;  // [bytes] as numbers in memory: in the file it may be packed
constexpr std::uintmax_t kLargestText = 64 << 20;  // [bytes]

}  // namespace

struct Hdf5Input::File {
  std::string name;
  H5::H5File h5;

  [[noreturn]] void refuse(const std::string& path, const std::string& rule) const {
    throw std::runtime_error(name + ": " + path + " " + rule);
  }
};

Hdf5Input::Hdf5Input(const std::filesystem::path& file) : file_(std::make_unique<File>()) {
  file_->name = file.string();
  check_readable(file);
  check_size(file_->name, std::filesystem::file_size(file), largest_input(kLargestProblem));
  try {
    file_->h5.openFile(file_->name, H5F_ACC_RDONLY);
  } catch (const H5::Exception&) {
    throw std::runtime_error(file_->name + ": is no HDF5 file, or a broken one");
  }
}
Hdf5Input::~Hdf5Input() = default;

std::vector<std::string> Hdf5Input::arrays() const {
  std::vector<std::string> names;
  try {
    for (hsize_t i = 0; i < file_->h5.getNumObjs(); ++i)
      if (file_->h5.getObjTypeByIdx(i) == H5G_DATASET) names.push_back(file_->h5.getObjnameByIdx(i));
  } catch (const H5::Exception&) {
    throw std::runtime_error(file_->name + ": its list of data sets cannot be read");
  }
  return names;
}

bool Hdf5Input::has(const std::string& path) const {
  for (std::size_t end = path.find('/'); end != std::string::npos; end = path.find('/', end + 1))
    if (H5Lexists(file_->h5.getId(), path.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return false;
  return H5Lexists(file_->h5.getId(), path.c_str(), H5P_DEFAULT) > 0;
}

std::vector<double> Hdf5Input::numbers(const std::string& path) const {
  if (!has(path)) file_->refuse(path, "is missing");
  try {
    const H5::DataSet set = file_->h5.openDataSet(path);
    const H5T_class_t kind = set.getTypeClass();
    if (kind != H5T_INTEGER && kind != H5T_FLOAT) file_->refuse(path, "must hold numbers");
    const hssize_t count = set.getSpace().getSimpleExtentNpoints();
    if (count < 0 || static_cast<hsize_t>(count) > UINTMAX_MAX / sizeof(double))
      file_->refuse(path, "has " + std::to_string(count) + " entries");
    check_size(file_->name + ": " + path, static_cast<std::uintmax_t>(count) * sizeof(double),
               largest_input(kLargestArray));
    std::vector<double> values(static_cast<std::size_t>(count));
    if (count > 0) set.read(values.data(), H5::PredType::NATIVE_DOUBLE);
    return values;
  } catch (const H5::Exception&) {
    file_->refuse(path, "cannot be read");
  }
}

std::string Hdf5Input::text(const std::string& path) const {
  if (!has(path)) file_->refuse(path, "is missing");
  try {
    const H5::DataSet set = file_->h5.openDataSet(path);
    if (set.getTypeClass() != H5T_STRING || set.getStrType().isVariableStr()) file_->refuse(path, "must be a text");
    check_size(file_->name + ": " + path, set.getStrType().getSize(), kLargestText);
    std::string words;
    set.read(words, set.getStrType());
    return words.c_str();  // up to the first NUL
  } catch (const H5::Exception&) {
    file_->refuse(path, "cannot be read");
  }
}

}  // namespace orthant
