#include "vtk_files.h"

#include "outlines.h"

#include <orthant/core/support/file.h>

#include <fcntl.h>
#include <stdio.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <stdexcept>

namespace orthant {
namespace {

namespace fs = std::filesystem;

/// One moment: `row` begins with t, then x, y, θ, ẋ, ẏ, ω of each body.
std::string vtu_of(const std::vector<Outline>& shapes, const double* row) {
  std::ostringstream points, joined, ends, types, body, velocity, omega;
  points.precision(17), velocity.precision(17), omega.precision(17);
  std::size_t count = 0;
  for (const Outline& shape : shapes) {
    const double* pose = shape.body == kGround ? nullptr : row + 1 + 6 * shape.body;
    const double c = pose ? std::cos(pose[2]) : 1, s = pose ? std::sin(pose[2]) : 0;
    for (const Vector2d& p : shape.corners) {
      points << (pose ? pose[0] : 0) + c * p.x() - s * p.y() << ' ' << (pose ? pose[1] : 0) + s * p.x() + c * p.y()
             << " 0\n";
      joined << count++ << ' ';
    }
    ends << count << ' ';
    types << (shape.closed ? 7 : 4) << ' ';  // VTK_POLYGON, VTK_POLY_LINE
    body << shape.body << ' ';
    velocity << (pose ? pose[3] : 0) << ' ' << (pose ? pose[4] : 0) << " 0\n";
    omega << (pose ? pose[5] : 0) << ' ';
  }
  const auto array = [](const char* type, const char* name, int components, const std::ostringstream& data) {
    return "<DataArray type=\"" + std::string(type) + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
           std::to_string(components) + "\" format=\"ascii\">\n" + data.str() + "\n</DataArray>\n";
  };
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
         "<UnstructuredGrid>\n<Piece NumberOfPoints=\"" +
         std::to_string(count) + "\" NumberOfCells=\"" + std::to_string(shapes.size()) + "\">\n<Points>\n" +
         array("Float64", "position", 3, points) + "</Points>\n<Cells>\n" + array("Int64", "connectivity", 1, joined) +
         array("Int64", "offsets", 1, ends) + array("UInt8", "types", 1, types) + "</Cells>\n<CellData>\n" +
         array("Int32", "body", 1, body) + array("Float64", "velocity", 3, velocity) +
         array("Float64", "omega", 1, omega) + "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
}

/// NAME_7.vtu of the folder NAME.
bool is_moment(const std::string& name, const std::string& stem) {
  const std::size_t digits = stem.size() + 1;
  return name.size() > digits + 4 && name.starts_with(stem + '_') && name.ends_with(".vtu") &&
         name.find_first_not_of("0123456789", digits) == name.size() - 4;
}

/// Removes the moments NAME_i of an earlier result, a folder; files of others there go to `folder`.
void discard(const fs::path& old, const fs::path& folder, const std::string& stem) {
  std::vector<fs::path> others;
  if (fs::is_directory(old))
    for (const auto& entry : fs::directory_iterator(old))
      if (!is_moment(entry.path().filename().string(), stem)) others.push_back(entry.path());
  if (!others.empty()) fs::create_directories(folder);
  for (const fs::path& other : others) fs::rename(other, folder / other.filename());
  fs::remove_all(old);
}

/// Each takes the other's place, at one stroke where the file system can (NFS cannot); `b` need not exist.
void exchange(const fs::path& a, const fs::path& b) {
  if (!fs::exists(b)) return fs::rename(a, b);
  if (renameat2(AT_FDCWD, a.c_str(), AT_FDCWD, b.c_str(), RENAME_EXCHANGE) == 0) return;
  fs::path aside = a;
  fs::rename(b, aside += "_aside");
  fs::rename(a, b);
  fs::rename(aside, a);
}

/// Writes the moments into `folder`; the index's text, for a folder that will be called `stem`.
std::string write_moments(const fs::path& folder, const std::string& stem, const Scene& scene, std::size_t width,
                          const std::vector<double>& table) {
  const std::vector<Outline> shapes = outlines(scene);
  std::ostringstream index;
  index.precision(17);
  index << "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
           "<Collection>\n";
  for (std::size_t i = 0; i < table.size() / width; ++i) {
    const std::string name = stem + "_" + std::to_string(i) + ".vtu";
    write_whole(folder / name, vtu_of(shapes, table.data() + i * width));
    index << "<DataSet timestep=\"" << table[i * width] << "\" file=\"" << stem << '/' << name << "\"/>\n";
  }
  index << "</Collection>\n</VTKFile>\n";
  return index.str();
}

}  // namespace

void write_vtk(const fs::path& file, const Scene& scene, std::size_t width, const std::vector<double>& table) {
  check_writable(file);
  const std::string stem = file.stem().string();
  try {
    const fs::path index = fs::weakly_canonical(fs::absolute(file));  // links are followed
    const fs::path folder = fs::weakly_canonical(fs::absolute(file).parent_path() / stem);
    if (fs::exists(folder) && !fs::is_directory(folder))
      throw std::runtime_error("cannot write " + folder.string() + ": is no folder");
    for (const fs::path& path : {index, folder})
      for (const fs::path& left : leftovers_beside(path)) discard(left, folder, stem);
    const fs::path new_index = beside(index), new_folder = beside(folder);
    try {
      fs::create_directory(new_folder);
      write_whole(new_index, write_moments(new_folder, stem, scene, width, table));
      exchange(new_folder, folder);
      std::error_code error;
      fs::rename(new_index, index, error);
      if (error) exchange(folder, new_folder);
      if (error) throw fs::filesystem_error("", error);
    } catch (...) {
      fs::remove(new_index), fs::remove_all(new_folder);
      throw;
    }
    discard(new_folder, folder, stem);  // where the earlier one is now
  } catch (const fs::filesystem_error& error) {
    throw std::runtime_error("cannot write " + file.string() + ": " + error.code().message());
  }
}

}  // namespace orthant
