#include <orthant/integrators/derivatives/spatial_row_slope.h>

#include <cmath>
#include <optional>

namespace orthant {

namespace {

using SpatialRow = RowOf<Spatial>;
using SpatialRowSlope = RowSlopeOf<Spatial>;
constexpr std::size_t kRowEntries = 2 * Spatial::kVelocities;

void put_entries(const SpatialRow& row, double* to) {
  const auto entries = entries_of(row);
  std::copy(entries.begin(), entries.end(), to);
}

/// rows(at, SpatialRow*) fills n rows on the bodies a and b, in either order.
template <std::size_t n, class F>
void find_row_slopes(KinematicsOf<Spatial>& at, BodyId a, BodyId b, F&& rows, SpatialRowSlope* slopes) {
  static_assert(n * kRowEntries <= PoseDifferences::kMostValues);
  std::array<SpatialRow, n> all;
  rows(at, all.data());
  const std::array<SpatialRow, n> here = all;
  for (std::size_t i = 0; i < n; ++i) slopes[i].count = 0;
  PoseDifferences::each(
      at, a, b, n * kRowEntries,
      [&](const KinematicsOf<Spatial>& k, PoseDifferences::Values& values) {
        rows(k, all.data());
        for (std::size_t i = 0; i < n; ++i) put_entries(all[i], values.data() + i * kRowEntries);
      },
      [&](Eigen::Index by, const PoseDifferences::Values& slope) {
        for (std::size_t i = 0; i < n; ++i)
          for (std::size_t k = 0; k < kRowEntries; ++k)
            if (const Eigen::Index of = place_of_entry(here[i], k); of >= 0)
              slopes[i].add(of, by, slope[i * kRowEntries + k]);
      });
}

constexpr double kFlatRim = 1e-8;  // [rad]: below, differences over a hundredth of it are rounding

const spatial::Contact& contact_of(const SystemOf<Spatial>& system, int contact) {
  return system.scene().contacts[static_cast<std::size_t>(contact)];
}

spatial::ContactRows plain_rows(const spatial::Contact& contact, const KinematicsOf<Spatial>& at) {
  return std::visit([&](const auto& c) { return c.rows(at); }, contact);
}

/// The contact of a rim's point as one of the body.
spatial::Contact held_point(const spatial::RimPlane& rim, const KinematicsOf<Spatial>& at) {
  const spatial::Pose& body = at.at(rim.a);
  const Vector3d centre = rim.rows(at).point + rim.tube * at.at(rim.b).turn(rim.normal) - body.x;
  return spatial::SpherePlane{rim.name,   rim.a,  body.turn_back(centre), rim.tube, rim.b, rim.plane_point,
                              rim.normal, rim.law};
}

SurfaceRows surface_rows(const spatial::Contact& contact, const ContactLaw& law, const KinematicsOf<Spatial>& at,
                         const Vector3d* axis) {
  constexpr double kJumps = 0.9;  // cosine between first tangents of which one is not the other's continuation
  spatial::ContactRows c = plain_rows(contact, at);
  const Vector3d n = spatial::direction_of(c.normal);
  Vector3d t = spatial::direction_of(c.tangents[0]);
  const Vector3d next = axis == nullptr ? t : Vector3d((*axis - n.dot(*axis) * n).normalized());
  if (t.dot(next) < kJumps) {
    const Vector3d other = n.cross(t);
    const double cosine = next.dot(t), sine = next.dot(other);
    const auto [one, two] = c.tangents;
    c.tangents = {combined(scaled(one, cosine), sine, two), combined(scaled(one, -sine), cosine, two)};
    t = next;
  }
  spatial::adapt_to_surface(law, at, c);
  SurfaceRows all;
  const SpatialRow none = blank(c.normal);
  all.rows = {c.normal, c.tangents[0], c.tangents[1], none, none, none};
  all.belt[1] = c.belt.first, all.belt[2] = c.belt.second;
  if (law.surface.turns()) {
    const std::array<Vector3d, 3> axes = {t, n.cross(t), n};
    const Vector3d turn = at.at(c.normal.b).turn(law.surface.omega);
    for (std::size_t i = 0; i < 3; ++i) {
      all.rows[3 + i] = spatial::turn_row(at, c.normal.a, c.normal.b, axes[i]);
      all.belt[3 + i] = turn.dot(axes[i]);
    }
  }
  return all;
}

}  // namespace

double turning_length(const SystemOf<Spatial>& system, int contact, const KinematicsOf<Spatial>& at) {
  return std::visit(
      [&](const auto& c) {
        using Kind = std::remove_cvref_t<decltype(c)>;
        if constexpr (std::is_same_v<Kind, spatial::RimPlane>) {
          const double steepness = c.steepness(at);
          return steepness > kFlatRim ? steepness : 0.;
        } else if constexpr (std::is_same_v<Kind, spatial::PinBush>) {
          return c.radius_b - c.radius_a;
        } else if constexpr (std::is_same_v<Kind, spatial::Socket> || std::is_same_v<Kind, spatial::SphereBush>) {
          return c.radius_b - c.radius_a - c.gap(at);
        } else if constexpr (std::is_same_v<Kind, spatial::SphereSphere>) {
          return c.radius_a + c.radius_b + c.gap(at);
        } else if constexpr (std::is_same_v<Kind, spatial::EllipsoidPlane>) {
          return c.semi_axes.minCoeff() * c.semi_axes.minCoeff() / c.semi_axes.maxCoeff();
        } else {
          return 1.;
        }
      },
      contact_of(system, contact));
}

spatial::Pose PoseDifferences::shifted(const spatial::Pose& pose, int coordinate, double by) {
  spatial::Pose moved = pose;
  if (coordinate < 3) {
    moved.x[coordinate] += by;
    return moved;
  }
  const Vector3d axis = pose.axes.col(coordinate - 3);  // R exp δφ turns the world about R δφ
  const spatial::Matrix3d turn = Eigen::AngleAxisd(by, axis).toRotationMatrix();
  moved.axes = turn * pose.axes, moved.R = turn * pose.R;
  return moved;
}

Vector3d tangent_axis(const SystemOf<Spatial>& system, int contact, const KinematicsOf<Spatial>& at) {
  Eigen::Index axis = 0;
  spatial::direction_of(plain_rows(contact_of(system, contact), at).tangents[0]).maxCoeff(&axis);
  return Vector3d::Unit(axis);
}

bool tangents_jump(const Vector3d& normal) {
  std::array<double, 3> sizes = {std::abs(normal.x()), std::abs(normal.y()), std::abs(normal.z())};
  std::ranges::sort(sizes);
  return sizes[1] - sizes[0] <= 1e-9;
}

SurfaceRows surface_rows(const SystemOf<Spatial>& system, int contact, const KinematicsOf<Spatial>& at,
                         const Vector3d* axis) {
  return surface_rows(contact_of(system, contact), system.law(contact), at, axis);
}

void slopes_of(const spatial::Joint& joint, KinematicsOf<Spatial>& at, SpatialRowSlope* slopes) {
  std::visit(
      [&](const auto& j) {
        const auto [a, b] = bodies_of(j);
        find_row_slopes<static_cast<std::size_t>(std::remove_cvref_t<decltype(j)>::kRows)>(
            at, a, b, [&](const KinematicsOf<Spatial>& k, SpatialRow* G) { j.rows(k, G); }, slopes);
      },
      joint);
}

void slopes_of(const SystemOf<Spatial>& system, int contact, KinematicsOf<Spatial>& at, SurfaceSlopes& slopes) {
  constexpr std::size_t n = SurfaceRows::kMost;
  static_assert(n * (kRowEntries + 1) <= PoseDifferences::kMostValues);
  const bool turns = system.law(contact).surface.turns();
  const std::size_t used = turns ? n : 3;
  const Vector3d axis = tangent_axis(system, contact, at);
  const SurfaceRows here = surface_rows(system, contact, at);
  const ContactLaw& law = system.law(contact);
  const double turning = turning_length(system, contact, at);
  const auto* rim = std::get_if<spatial::RimPlane>(&contact_of(system, contact));
  std::optional<spatial::Contact> held;
  if (turning == 0 && rim != nullptr) held = held_point(*rim, at);
  const spatial::Contact& moved = held ? *held : contact_of(system, contact);
  for (auto& slope : slopes.rows) slope.count = 0;
  slopes.belt.clear();
  const auto [a, b] = bodies_of(system, {}, contact);
  PoseDifferences::each(
      at, a, b, used * (kRowEntries + 1),
      [&](const KinematicsOf<Spatial>& k, PoseDifferences::Values& values) {
        const SurfaceRows there = surface_rows(moved, law, k, &axis);
        for (std::size_t i = 0; i < used; ++i) {
          put_entries(there.rows[i], values.data() + i * (kRowEntries + 1));
          values[i * (kRowEntries + 1) + kRowEntries] = there.belt[i];
        }
      },
      [&](Eigen::Index by, const PoseDifferences::Values& slope) {
        for (std::size_t i = 0; i < used; ++i) {
          const double* const of_row = slope.data() + i * (kRowEntries + 1);
          for (std::size_t k = 0; k < kRowEntries; ++k)
            if (const Eigen::Index of = place_of_entry(here.rows[i], k); of >= 0) slopes.rows[i].add(of, by, of_row[k]);
          if (of_row[kRowEntries] != 0) slopes.belt.push_back({static_cast<Eigen::Index>(i), by, of_row[kRowEntries]});
        }
      },
      turning > 0 ? PoseDifferences::way_of(turning) : PoseDifferences::kStep);
}

void slope_of(const spatial::Coordinate& coordinate, KinematicsOf<Spatial>& at, SpatialRowSlope& slope) {
  const auto [a, b] = std::visit([](const auto& c) { return std::pair{c.a, c.b}; }, coordinate.kind());
  find_row_slopes<1>(
      at, a, b, [&](const KinematicsOf<Spatial>& k, SpatialRow* G) { *G = coordinate.row(k); }, &slope);
}

}  // namespace orthant
