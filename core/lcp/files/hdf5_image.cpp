#include <orthant/core/lcp/files/hdf5_image.h>

#include <H5Cpp.h>

#include <stdexcept>

namespace orthant {
namespace {

/// The library's exceptions are not the standard's.
template <class Work> auto guarded(Work&& work) {
  try {
    return work();
  } catch (const H5::Exception& error) {
    throw std::runtime_error("the HDF5 library fails: " + error.getDetailMsg());
  }
}

H5::FileAccPropList in_memory() {
  H5::FileAccPropList properties;
  properties.setCore(1 << 20, false);
  return properties;
}

}  // namespace

namespace detail {

static_assert(std::is_same_v<H5E_auto2_t, herr_t (*)(hid_t, void*)> && sizeof(hid_t) == sizeof(long));

Hdf5Quiet::Hdf5Quiet() {
  H5E_auto2_t print = nullptr;
  H5Eget_auto2(H5E_DEFAULT, &print, &data_);
  print_ = print;
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}
Hdf5Quiet::~Hdf5Quiet() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }

}  // namespace detail

struct Hdf5Image::File {
  H5::H5File h5{"orthant", H5F_ACC_TRUNC, H5::FileCreatPropList::DEFAULT, in_memory()};

  void put(const std::string& path, std::size_t n, const H5::PredType& type, const void* data) {
    guarded([&] {
      const hsize_t size = n;
      H5::DataSet set = h5.createDataSet(path, type, H5::DataSpace(1, &size));
      if (n > 0) set.write(data, type);
    });
  }
};

Hdf5Image::Hdf5Image() : file_(guarded([] { return std::make_unique<File>(); })) {}
Hdf5Image::~Hdf5Image() = default;

void Hdf5Image::group(const std::string& path) {
  guarded([&] { file_->h5.createGroup(path); });
}
void Hdf5Image::whole(const std::string& path, int value) { file_->put(path, 1, H5::PredType::NATIVE_INT, &value); }
void Hdf5Image::numbers(const std::string& path, std::span<const int> x) {
  file_->put(path, x.size(), H5::PredType::NATIVE_INT, x.data());
}
void Hdf5Image::numbers(const std::string& path, std::span<const double> x) {
  file_->put(path, x.size(), H5::PredType::NATIVE_DOUBLE, x.data());
}
void Hdf5Image::text(const std::string& path, const std::string& words) {
  guarded([&] {
    const H5::StrType type(H5::PredType::C_S1, words.size() + 1);
    file_->h5.createDataSet(path, type, H5::DataSpace(H5S_SCALAR)).write(words, type);
  });
}

std::string Hdf5Image::bytes() {
  return guarded([&] {
    file_->h5.flush(H5F_SCOPE_GLOBAL);
    const auto size = H5Fget_file_image(file_->h5.getId(), nullptr, 0);
    std::string image(size > 0 ? static_cast<std::size_t>(size) : 0, '\0');
    if (size <= 0 || H5Fget_file_image(file_->h5.getId(), image.data(), image.size()) < 0)
      throw std::runtime_error("the HDF5 library gives no image of its file");
    return image;
  });
}

}  // namespace orthant
