#include <orthant/core/lcp/files/hdf5_input.h>

#include <orthant/core/lcp/files/io.h>
#include <orthant/core/support/file.h>

#include <H5Cpp.h>

#include <stdexcept>
#include <type_traits>

namespace orthant {
namespace {

constexpr std::uintmax_t kLargestArray = 1 << 30;  // [bytes] as numbers in memory: in the file it may be packed
constexpr std::uintmax_t kDeflated = 1032;         // most bytes that one becomes (zlib, Technical Details)
constexpr std::uintmax_t kLargestText = 64 << 20;  // [bytes]

/// Refuses a link to another file before that one is opened: it may be none that ends.
herr_t stay_here(const char*, const char*, const char*, const char*, unsigned*, hid_t, void*) { return -1; }

}  // namespace

struct Hdf5Input::File {
  std::string name;
  std::uintmax_t size = 0;  // [bytes]
  std::uintmax_t left = 0;  // entries that may still be read: of data sets with many names, too
  H5::H5File h5;
  H5::DSetAccPropList access;  // within this file

  File() { H5Pset_elink_cb(access.getId(), &stay_here, nullptr); }

  [[noreturn]] void refuse(const std::string& path, const std::string& rule) const {
    throw std::runtime_error(name + ": " + path + " " + rule);
  }

  /// Whether the last part of the path is there. Throws where it is a link to another file.
  bool has(const std::string& path) const {
    if (H5Lexists(h5.getId(), path.c_str(), access.getId()) <= 0) return false;
    H5L_info_t link{};
    if (H5Lget_info(h5.getId(), path.c_str(), &link, access.getId()) >= 0 && link.type == H5L_TYPE_EXTERNAL)
      refuse(path, "is in another file: must be in this one");
    return true;
  }

  /// Throws unless the file stores all entries of the data set. The library (1.10) does not compare sizes itself, and
  /// reads beyond its buffers.
  void check_stored(const std::string& path, const H5::DataSet& set, std::uintmax_t entries) {
    if (entries > left)
      refuse(path, "has " + std::to_string(entries) + " entries: must not have more than a file of this size can hold");
    left -= entries;
    const H5::DSetCreatPropList made = set.getCreatePlist();
    const H5D_layout_t layout = made.getLayout();
    if (set.getFileName() != h5.getFileName() || layout == H5D_VIRTUAL || H5Pget_external_count(made.getId()) != 0)
      refuse(path, "is in another file: must be in this one");
    const std::uintmax_t stored = set.getStorageSize(), each = set.getDataType().getSize();
    if (each == 0 || (layout != H5D_CHUNKED && (stored % each != 0 || stored / each != entries)))
      refuse(path, "has " + std::to_string(stored) + " bytes for " + std::to_string(entries) + " entries of " +
                       std::to_string(each) + " bytes");
  }
};

Hdf5Input::Hdf5Input(const std::filesystem::path& file) : file_(std::make_unique<File>()) {
  file_->name = file.string();
  check_readable(file);
  file_->size = std::filesystem::file_size(file), file_->left = file_->size * kDeflated;
  check_size(file_->name, file_->size, largest_input(kLargestProblem));
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
    if (!file_->has(path.substr(0, end))) return false;
  return file_->has(path);
}

void Hdf5Input::refuse(const std::string& path, const std::string& rule) const { file_->refuse(path, rule); }

template <class Number> std::vector<Number> Hdf5Input::list(const std::string& path) const {
  constexpr bool kWhole = std::is_integral_v<Number>;
  if (!has(path)) refuse(path, "is missing");
  try {
    const H5::DataSet set = file_->h5.openDataSet(path, file_->access);
    const H5T_class_t kind = set.getTypeClass();
    if (kind != H5T_INTEGER && (kWhole || kind != H5T_FLOAT))
      refuse(path, kWhole ? "must hold whole numbers" : "must hold numbers");
    const hssize_t count = set.getSpace().getSimpleExtentNpoints();
    if (count < 0 || static_cast<hsize_t>(count) > UINTMAX_MAX / sizeof(double))
      refuse(path, "has " + std::to_string(count) + " entries");
    check_size(file_->name + ": " + path, static_cast<std::uintmax_t>(count) * sizeof(double),
               largest_input(kLargestArray));
    file_->check_stored(path, set, static_cast<std::uintmax_t>(count));
    std::vector<Number> values(static_cast<std::size_t>(count));
    if (count > 0) set.read(values.data(), kWhole ? H5::PredType::NATIVE_INT : H5::PredType::NATIVE_DOUBLE);
    return values;
  } catch (const H5::Exception&) {
    refuse(path, "cannot be read");
  }
}

std::uintmax_t Hdf5Input::most_numbers() const { return file_->size * kDeflated; }

std::vector<double> Hdf5Input::numbers(const std::string& path) const { return list<double>(path); }
std::vector<int> Hdf5Input::integers(const std::string& path) const { return list<int>(path); }

std::string Hdf5Input::text(const std::string& path) const {
  if (!has(path)) refuse(path, "is missing");
  try {
    const H5::DataSet set = file_->h5.openDataSet(path, file_->access);
    if (set.getTypeClass() != H5T_STRING || set.getSpace().getSimpleExtentNpoints() != 1)
      refuse(path, "must be one text");
    check_size(file_->name + ": " + path, set.getStrType().getSize(), kLargestText);
    file_->check_stored(path, set, 1);
    if (set.getStrType()
            .isVariableStr()) {  // the library's own reader of these takes a text that was not written for one
      char* text = nullptr;
      set.read(&text, set.getStrType());
      const std::unique_ptr<char, decltype(&H5free_memory)> owner(text, &H5free_memory);
      return text != nullptr ? text : "";
    }
    std::string words;
    set.read(words, set.getStrType());
    return words.c_str();  // up to the first NUL
  } catch (const H5::Exception&) {
    refuse(path, "cannot be read");
  }
}

}  // namespace orthant
