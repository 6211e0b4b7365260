// HDF5 files of strangers: what they promise must be in them. Read through FCLIB files.
#include <orthant/core/lcp/files/hdf5_input.h>
#include <orthant/core/lcp/files/io_fclib.h>
#include <orthant/core/lcp/problems/contact_piles.h>

#include "tests/support/folder.h"

#include <H5Cpp.h>
#include <doctest/doctest.h>

#include <sys/stat.h>

#include <vector>

using namespace orthant;

namespace {

void must_refuse(const std::string& file, const std::string& words) {
  CHECK_THROWS_WITH_AS(read_fclib(file), doctest::Contains(words.c_str()), std::runtime_error);
}

}  // namespace

TEST_CASE("HDF5: a data set must hold all its entries, in the same file") {
  const Folder folder;
  ContactProblem p{box_column(2, {.mu = 0.4}), 2, 0, "", ""};
  p.contacts = p.problem.size() / p.dimension;
  write_fclib(folder / "p.hdf5", p);
  const hsize_t count = static_cast<hsize_t>(p.contacts);
  const auto mu = [&](const auto& make) {
    folder.write("bad.hdf5", slurp(folder / "p.hdf5"));
    H5::H5File file(folder / "bad.hdf5", H5F_ACC_RDWR);
    file.unlink("fclib_global/vectors/mu");
    make(file);
  };
  const auto put = [&](const H5::H5File& file, const char* path, const H5::DSetCreatPropList& made) {
    return file.createDataSet(path, H5::PredType::NATIVE_DOUBLE, H5::DataSpace(1, &count), made);
  };
  const std::vector<double> values(static_cast<std::size_t>(count), 0.4);
  {
    const H5::H5File other(folder / "other.hdf5", H5F_ACC_TRUNC);
    put(other, "mu", {}).write(values.data(), H5::PredType::NATIVE_DOUBLE);
  }
  const std::string elsewhere = "fclib_global/vectors/mu is in another file: must be in this one";
  mu([&](const H5::H5File& file) {
    H5Lcreate_external("other.hdf5", "mu", file.getId(), "fclib_global/vectors/mu", H5P_DEFAULT, H5P_DEFAULT);
  });
  must_refuse(folder / "bad.hdf5", elsewhere);
  // Nor is the other file opened, which need not end: from here, through another name, by way of a group.
  const std::string pipe = folder / "pipe";
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  const auto to_pipe = [&](const H5::H5File& file, const char* path) {
    H5Lcreate_external(pipe.c_str(), "mu", file.getId(), path, H5P_DEFAULT, H5P_DEFAULT);
  };
  mu([&](const H5::H5File& file) { to_pipe(file, "fclib_global/vectors/mu"); });
  must_refuse(folder / "bad.hdf5", elsewhere);
  mu([&](const H5::H5File& file) {
    to_pipe(file, "elsewhere");
    file.link(H5L_TYPE_SOFT, "/elsewhere", "fclib_global/vectors/mu");
  });
  must_refuse(folder / "bad.hdf5", "fclib_global/vectors/mu cannot be read");
  mu([&](const H5::H5File& file) {
    file.unlink("fclib_global/vectors");
    to_pipe(file, "fclib_global/vectors");
  });
  must_refuse(folder / "bad.hdf5", "fclib_global/vectors is in another file: must be in this one");

  mu([&](const H5::H5File& file) {
    H5::DSetCreatPropList made;
    made.setExternal((folder / "other.hdf5").c_str(), 0, count * sizeof(double));
    put(file, "fclib_global/vectors/mu", made);
  });
  must_refuse(folder / "bad.hdf5", elsewhere);
  mu([&](const H5::H5File& file) {
    H5::DSetCreatPropList made;
    const H5::DataSpace space(1, &count);
    H5Pset_virtual(made.getId(), space.getId(), "other.hdf5", "mu", space.getId());
    put(file, "fclib_global/vectors/mu", made);
  });
  must_refuse(folder / "bad.hdf5", elsewhere);

  // An extent that grew in the bytes only: the library would read that far beyond what it holds.
  mu([&](const H5::H5File& file) {
    H5::DSetCreatPropList made;
    made.setLayout(H5D_COMPACT);
    const hsize_t odd = 12345;
    const std::vector<char> bytes(odd, 1);
    file.createDataSet("fclib_global/vectors/mu", H5::PredType::NATIVE_INT8, H5::DataSpace(1, &odd), made)
        .write(bytes.data(), H5::PredType::NATIVE_INT8);
  });
  std::string bytes = slurp(folder / "bad.hdf5");
  const std::string extent("\x39\x30\0\0\0\0\0\0", 8);
  int changed = 0;
  for (std::size_t i = bytes.find(extent); i != std::string::npos; i = bytes.find(extent, i + 1))
    bytes[i + 2] = 1, ++changed;  // 12345 + 65536
  REQUIRE(changed >= 1);
  // Later libraries (1.14) see that themselves: then it "cannot be read".
  must_refuse(folder.write("bad.hdf5", bytes), "fclib_global/vectors/mu ");
}

TEST_CASE("HDF5: sizes that no file of this size can hold cost no memory") {
  const Folder folder;
  write_fclib(folder / "p.hdf5", {Lcp::standard(DenseMatrix(), {}), 2, 0, "", ""});
  {
    const H5::H5File file(folder / "p.hdf5", H5F_ACC_RDWR);
    const int rows = 2147483647;
    for (const char* size : {"fclib_local/W/m", "fclib_local/W/n"})
      file.openDataSet(size).write(&rows, H5::PredType::NATIVE_INT);
    const int triplets = 0;
    file.openDataSet("fclib_local/W/nz").write(&triplets, H5::PredType::NATIVE_INT);
  }
  must_refuse(folder / "p.hdf5",
              "fclib_local/W is 2147483647 x 2147483647: must not be larger than a file of this size");
}

TEST_CASE("HDF5: one data set by many names is read as often as the file could hold it") {
  const Folder folder;
  const hsize_t count = 1000000;
  {
    const H5::H5File file(folder / "zeros.h5", H5F_ACC_TRUNC);
    H5::DSetCreatPropList made;
    made.setChunk(1, &count), made.setDeflate(9);
    const std::vector<double> zeros(count, 0);
    file.createDataSet("x0", H5::PredType::NATIVE_DOUBLE, H5::DataSpace(1, &count), made)
        .write(zeros.data(), H5::PredType::NATIVE_DOUBLE);
    for (int i = 1; i < 100; ++i) file.link(H5L_TYPE_HARD, "x0", "x" + std::to_string(i));
  }
  const auto read_all = [&] {
    const Hdf5Input input(folder / "zeros.h5");
    for (const std::string& name : input.arrays()) {
      const std::vector<double> zeros = input.numbers(name);
      CHECK(zeros.size() == count);
    }
  };
  CHECK_THROWS_WITH_AS(read_all(), doctest::Contains("than a file of this size can hold"), std::runtime_error);
}

TEST_CASE("HDF5: titles of any kind, or none") {
  const Folder folder;
  ContactProblem p{box_column(2, {.mu = 0.4}), 2, 0, "of its own", ""};
  p.contacts = p.problem.size() / p.dimension;
  write_fclib(folder / "p.hdf5", p);
  const H5::StrType any(H5::PredType::C_S1, H5T_VARIABLE);
  const auto title = [&](hsize_t count, const char* const* words) {
    {
      H5::H5File file(folder / "p.hdf5", H5F_ACC_RDWR);
      file.unlink("fclib_global/info/title");
      H5::DSetCreatPropList made;
      const hsize_t chunk = 1;
      made.setChunk(1, &chunk);
      const H5::DataSet set = file.createDataSet("fclib_global/info/title", any, H5::DataSpace(1, &count), made);
      if (words != nullptr) set.write(words, any);
    }
    return read_fclib(folder / "p.hdf5").title;
  };
  CHECK(read_fclib(folder / "p.hdf5").title == "of its own");
  const char* const words[] = {"a title", "another"};
  CHECK(title(1, words) == "a title");
  CHECK(title(2, words).empty());
  CHECK(title(1, nullptr).empty());  // never written
  CHECK(title(0, nullptr).empty());
}
