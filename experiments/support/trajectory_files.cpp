#include "trajectory_files.h"

#include "outlines.h"
#include "trajectory.h"

#include <orthant/core/support/file.h>
#include <orthant/core/support/hdf5_image.h>

#include <cmath>
#include <sstream>

namespace orthant {
namespace {

namespace fs = std::filesystem;

std::string hdf5_of(const std::vector<std::string>& columns, const std::vector<double>& table) {
  Hdf5Image out;
  std::vector<double> column(table.size() / columns.size());
  for (std::size_t c = 0; c < columns.size(); ++c) {
    for (std::size_t i = 0; i < column.size(); ++i) column[i] = table[i * columns.size() + c];
    out.numbers(columns[c], column);
  }
  return out.bytes();
}

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

void write_vtk(const fs::path& file, const Scene& scene, std::size_t width, const std::vector<double>& table) {
  const std::vector<Outline> shapes = outlines(scene);
  const std::string stem = file.stem().string();
  const fs::path folder = file.parent_path() / stem;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw std::runtime_error("cannot write " + folder.string() + ": " + error.message());
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
  write_whole(file, index.str());
}

}  // namespace

void check_trajectory_file(const fs::path& file) {
  for (const char* end : {".csv", ".h5", ".hdf5", ".pvd"})
    if (file.extension() == end) return;
  throw std::invalid_argument(file.string() + ": must end in .csv, .h5, .hdf5 or .pvd");
}

void write_trajectory(const fs::path& file, const Scene& scene, const std::vector<std::string>& columns,
                      const std::vector<double>& table) {
  check_trajectory_file(file);
  const fs::path end = file.extension();
  if (end == ".h5" || end == ".hdf5") return write_whole(file, hdf5_of(columns, table));
  if (end == ".pvd") return write_vtk(file, scene, columns.size(), table);
  write_whole(file, to_csv(columns, table));
}

}  // namespace orthant
