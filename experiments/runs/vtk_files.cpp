#include "experiments/runs/vtk_files.h"

#include "experiments/runs/outlines.h"
#include "experiments/runs/solids.h"

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

/// The cells of one moment, as text.
class Cells {
 public:
  explicit Cells(int omega_components) : omega_components_(omega_components) {
    points_.precision(17), velocity_.precision(17), omega_.precision(17);
  }
  void point(double x, double y, double z) { points_ << x << ' ' << y << ' ' << z << '\n', ++count_; }
  /// Ends a cell: of the next points, where `corners` is empty; else of those.
  void end(int type, BodyId body, const std::string& velocity, const std::string& omega, std::size_t first = 0,
           const std::vector<int>& corners = {}) {
    if (corners.empty())
      for (; joined_count_ < count_; ++joined_count_) joined_ << joined_count_ << ' ';
    for (const int corner : corners) joined_ << first + static_cast<std::size_t>(corner) << ' ';
    joined_count_ += corners.size(), ++cells_;
    ends_ << joined_count_ << ' ', types_ << type << ' ', body_ << body << ' ';
    velocity_ << velocity << '\n', omega_ << omega << (omega_components_ == 1 ? ' ' : '\n');
  }
  std::size_t count() const { return count_; }

  std::string text() const {
    const auto array = [](const char* type, const char* name, int components, const std::ostringstream& data) {
      return "<DataArray type=\"" + std::string(type) + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
             std::to_string(components) + "\" format=\"ascii\">\n" + data.str() + "\n</DataArray>\n";
    };
    return "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
           "<UnstructuredGrid>\n<Piece NumberOfPoints=\"" +
           std::to_string(count_) + "\" NumberOfCells=\"" + std::to_string(cells_) + "\">\n<Points>\n" +
           array("Float64", "position", 3, points_) + "</Points>\n<Cells>\n" +
           array("Int64", "connectivity", 1, joined_) + array("Int64", "offsets", 1, ends_) +
           array("UInt8", "types", 1, types_) + "</Cells>\n<CellData>\n" + array("Int32", "body", 1, body_) +
           array("Float64", "velocity", 3, velocity_) + array("Float64", "omega", omega_components_, omega_) +
           "</CellData>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n";
  }

 private:
  int omega_components_;
  std::ostringstream points_, joined_, ends_, types_, body_, velocity_, omega_;
  std::size_t count_ = 0, joined_count_ = 0, cells_ = 0;
};

constexpr int kPolyLine = 4, kPolygon = 7;  // VTK's numbers

std::string numbers(const double* x, int count) {
  std::ostringstream text;
  text.precision(17);
  for (int i = 0; i < count; ++i) text << (i > 0 ? " " : "") << (x ? x[i] : 0);
  return text.str();
}

/// One moment: `row` begins with t, then x, y, θ, ẋ, ẏ, ω of each body.
std::string vtu_of(const std::vector<Outline>& shapes, const double* row) {
  Cells cells(1);
  for (const Outline& shape : shapes) {
    const double* pose = shape.body == kGround ? nullptr : row + 1 + 6 * shape.body;
    const double c = pose ? std::cos(pose[2]) : 1, s = pose ? std::sin(pose[2]) : 0;
    for (const Vector2d& p : shape.corners)
      cells.point((pose ? pose[0] : 0) + c * p.x() - s * p.y(), (pose ? pose[1] : 0) + s * p.x() + c * p.y(), 0);
    cells.end(shape.closed ? kPolygon : kPolyLine, shape.body, numbers(pose ? pose + 3 : nullptr, 2) + " 0",
              numbers(pose ? pose + 5 : nullptr, 1));
  }
  return cells.text();
}

struct Surface {
  BodyId body = kGround;
  Faces faces;
};

/// In space `row` begins with t, then x, y, z, q (4), ẋ, ẏ, ż, ω (3) of each body.
std::string vtu_of(const std::vector<Surface>& surfaces, const double* row) {
  Cells cells(3);
  for (const Surface& one : surfaces) {
    const double* pose = one.body == kGround ? nullptr : row + 1 + 13 * one.body;
    const Vector3d x = pose ? Vector3d(pose[0], pose[1], pose[2]) : Vector3d(0, 0, 0);
    const Eigen::Matrix3d turn =
        pose ? quaternions::matrix_of(Eigen::Map<const Eigen::Vector4d>(pose + 3)) : Eigen::Matrix3d::Identity();
    const std::size_t first = cells.count();
    for (const Vector3d& p : one.faces.points) {
      const Vector3d at = x + turn * p;
      cells.point(at.x(), at.y(), at.z());
    }
    const std::string velocity = numbers(pose ? pose + 7 : nullptr, 3), omega = numbers(pose ? pose + 10 : nullptr, 3);
    for (const auto& face : one.faces.faces) cells.end(kPolygon, one.body, velocity, omega, first, face);
  }
  return cells.text();
}

std::vector<Outline> shapes_of(const Scene& scene) { return outlines(scene); }
std::vector<Surface> shapes_of(const spatial::Scene& scene) {
  std::vector<Surface> all;
  for (const DrawnSolid& solid : solids(scene)) all.push_back({solid.body, surface(solid)});
  return all;
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
template <class Scene> std::string write_moments(const fs::path& folder, const std::string& stem, const Scene& scene,
                                                 std::size_t width, const std::vector<double>& table) {
  const auto shapes = shapes_of(scene);
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

template <class Scene> void write_index_and_moments(const fs::path& file, const Scene& scene, std::size_t width,
                                                    const std::vector<double>& table) {
  check_writable(file);
  const std::string stem = file.stem().string();
  try {
    const fs::path index = fs::weakly_canonical(fs::absolute(file));  // links are followed
    const fs::path folder = fs::weakly_canonical(fs::absolute(file).parent_path() / stem);
    if (fs::exists(folder) && !fs::is_directory(folder))
      throw std::runtime_error("cannot write " + folder.string() + ": is no folder");
    for (const fs::path& path : {index, folder})
      for (const fs::path& left : leftovers_beside(path)) discard(left, folder, stem);
    const fs::path new_index = temporary_name(index), new_folder = temporary_name(folder);
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

}  // namespace

void write_vtk(const fs::path& file, const Scene& scene, std::size_t width, const std::vector<double>& table) {
  write_index_and_moments(file, scene, width, table);
}

void write_vtk(const fs::path& file, const spatial::Scene& scene, std::size_t width, const std::vector<double>& table) {
  write_index_and_moments(file, scene, width, table);
}

}  // namespace orthant
