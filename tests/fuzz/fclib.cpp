#include <orthant/core/lcp/files/hdf5_image.h>
#include <orthant/core/lcp/files/io_fclib.h>

#include <H5Cpp.h>

#include <sstream>
#include <vector>

#include "target.h"

namespace {

/// The entries as `type`, converted by the library: i, l (64 bits, big-endian), b (8 bits), d, f (big-endian).
H5::DataType number_type(char type) {
  if (type == 'i') return H5::PredType::NATIVE_INT;
  if (type == 'l') return H5::PredType::STD_I64BE;
  if (type == 'b') return H5::PredType::STD_I8LE;
  return type == 'f' ? H5::PredType::IEEE_F32BE : H5::PredType::NATIVE_DOUBLE;
}

/// c: in chunks, deflated; k: in the header; all others: in one piece. An n behind: not written.
H5::DSetCreatPropList layout_of(char layout, hsize_t entries) {
  H5::DSetCreatPropList made;
  if (layout == 'k') made.setLayout(H5D_COMPACT);
  if (layout == 'c') {
    const hsize_t chunk = entries / 2 + 1;
    made.setChunk(1, &chunk), made.setShuffle(), made.setDeflate(6);
  }
  return made;
}

/// One line: path, type and layout, entries. Type s is one text, v a list of texts of any length.
void write_described(const H5::H5File& file, const std::string& line) {
  std::istringstream in(line);
  std::string path, kind, words;
  in >> path >> kind >> std::ws;
  kind.resize(2);
  for (std::size_t end = path.find('/', 1); end != std::string::npos; end = path.find('/', end + 1))
    if (H5Lexists(file.getId(), path.substr(0, end).c_str(), H5P_DEFAULT) == 0) file.createGroup(path.substr(0, end));
  if (kind[0] == 's') {
    std::getline(in, words);
    const H5::StrType type(H5::PredType::C_S1, words.size() + 1);
    file.createDataSet(path, type, H5::DataSpace(H5S_SCALAR), layout_of(kind[1], 1)).write(words, type);
    return;
  }
  std::vector<std::string> entries;
  while (in >> words) entries.push_back(words);
  const hsize_t count = entries.size();
  std::vector<const char*> texts;
  std::vector<double> numbers;
  for (const std::string& entry : entries)
    texts.push_back(entry.c_str()), numbers.push_back(std::strtod(texts.back(), nullptr));
  const H5::DataType type = kind[0] == 'v' ? H5::StrType(H5::PredType::C_S1, H5T_VARIABLE) : number_type(kind[0]);
  const H5::DataSet set = file.createDataSet(path, type, H5::DataSpace(1, &count), layout_of(kind[1], count));
  if (count == 0 || kind.find('n', 1) != std::string::npos) return;
  if (kind[0] == 'v')
    set.write(texts.data(), type);
  else
    set.write(numbers.data(), H5::PredType::NATIVE_DOUBLE);
}

}  // namespace

// The content of a file, line by line. Damaged HDF5 files are no matter of this target: they end in the library.
bool orthant::fuzz::fclib(std::string_view bytes) {
  const NamedFile name("contacts.hdf5", {});
  {
    const detail::Hdf5Quiet quiet;
    const H5::H5File file(name.path(), H5F_ACC_TRUNC);
    std::istringstream lines{std::string(bytes)};
    for (std::string line; std::getline(lines, line);) try {
        write_described(file, line);
      } catch (const H5::Exception&) {  // no such path, or there is one
      }
  }
  return parse([&] { check(read_fclib(name.path()).problem); });
}
