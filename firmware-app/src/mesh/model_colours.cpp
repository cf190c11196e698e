#include "mesh/model_colours.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "octurn/error.hpp"
#include "octurn/units.hpp"

namespace octurn {

namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

Vector3d metres_of(const Vertex& vertex) {
  return Eigen::Map<const Vector3f>(vertex.data()).cast<double>() * metres_from_mm(1);
}

/// Vertices of an edited model, millimetres in the object's frame.
std::vector<Vertex> placed_back(std::span<const Vertex> vertices, const ModelEdits& edits) {
  const Eigen::Affine3d object_from_model = model_from_object(edits).inverse();
  std::vector<Vertex> placed(vertices.size());
  std::ranges::transform(vertices, placed.begin(), [&](const Vertex& vertex) {
    const Vector3d mm = object_from_model * metres_of(vertex) * mm_from_metres(1);
    return Vertex{static_cast<float>(mm.x()), static_cast<float>(mm.y()),
                  static_cast<float>(mm.z())};
  });
  return placed;
}

}  // namespace

std::vector<Rgb> model_colours(const FacetFile& facets, const std::filesystem::path& folder,
                               const Scan& scan, const ModelEdits& edits,
                               const std::stop_token& stop) {
  const VertexTable table(facets);
  std::vector<std::array<std::uint32_t, 3>> triangles;
  triangles.reserve(facets.count());
  facets.read([&](std::span<const Facet> block) {
    for (const Facet& facet : block) {
      const auto corners = facet.corners;  // a copy: a facet's members are not aligned
      triangles.push_back(
          {table.index(corners[0]), table.index(corners[1]), table.index(corners[2])});
    }
  });
  std::span<const Vertex> vertices = table.vertices();
  std::vector<Vertex> placed;
  if (edits.move()) {
    placed = placed_back(vertices, edits);
    vertices = placed;
  }
  return vertex_colours(folder, scan, {.vertices = vertices, .triangles = triangles}, stop);
}

void expect_colours_of(const VertexTable& table, std::span<const Rgb> colours) {
  if (!colours.empty() && colours.size() != table.vertices().size()) {
    throw Error(ErrorCode::no_model, "the model was built anew while its colours were written",
                "Download it again.");
  }
}

namespace {

constexpr double min_view_cosine = 0.25;  // of incidence, 75 degrees
// Metres: three sigma of a Kinect v1's noise at 0.75 m, and half a pixel on a surface that steep.
// Noise and steps of depth grow with the square of the distance.
constexpr double near_off = 0.005;
constexpr double near_distance = 0.75;

double max_off(double distance) {
  const double ratio = std::max(1.0, distance / near_distance);
  return near_off * ratio * ratio;
}

/// The vertices' normals, weighted by the areas of their triangles.
std::vector<Vector3f> normals_of(const FacetFile& facets, const VertexTable& table,
                                 const std::stop_token& stop) {
  std::vector<Vector3f> normals(table.vertices().size(), Vector3f::Zero());
  facets.read([&](std::span<const Facet> block) {
    throw_if_stopped(stop);
    for (const Facet& facet : block) {
      const auto corners = facet.corners;  // a copy: a facet's members are not aligned
      const Eigen::Map<const Vector3f> a(corners[0].data());
      const Eigen::Map<const Vector3f> b(corners[1].data());
      const Eigen::Map<const Vector3f> c(corners[2].data());
      const Vector3f normal = (b - a).cross(c - a);
      for (const Vertex& corner : corners) {
        normals[table.index(corner)] += normal;
      }
    }
  });
  return normals;
}

/// Whether a snapshot has a reading of the surface at a point.
/// @param point  metres, optical frame @param normal  of any length
bool sees(const Snapshot& snapshot, const Vector3d& point, const Vector3d& normal) {
  if (point.z() <= 0 || -point.dot(normal) < min_view_cosine * point.norm() * normal.norm()) {
    return false;
  }
  const Intrinsics& lens = snapshot.intrinsics;
  const double u = std::round(point.x() / point.z() * lens.fx + lens.cx);
  const double v = std::round(point.y() / point.z() * lens.fy + lens.cy);
  if (!(u >= 0 && v >= 0 && u < lens.width && v < lens.height)) {
    return false;
  }
  const auto pixel = static_cast<std::size_t>(v) * static_cast<std::size_t>(lens.width) +
                     static_cast<std::size_t>(u);
  const std::uint16_t reading = snapshot.frame.depth[pixel];
  return reading > 0 && std::abs(reading * lens.depth_unit - point.z()) < max_off(point.z());
}

}  // namespace

std::vector<Rgb> view_colours(const FacetFile& facets, const SnapshotSource& snapshots,
                              const ModelEdits& edits, const std::stop_token& stop) {
  const VertexTable table(facets);
  const std::span<const Vertex> vertices = table.vertices();
  const std::vector<Vector3f> normals = normals_of(facets, table, stop);
  const Eigen::Affine3d object_from_model = model_from_object(edits).inverse();
  std::vector<std::uint8_t> views(vertices.size());
  for (std::size_t shot = 0; shot < snapshots.count; ++shot) {
    throw_if_stopped(stop);
    const Snapshot snapshot = snapshots.read(shot);
    const Eigen::Affine3d sensor_from_model =
        snapshot.object_from_sensor.inverse() * object_from_model;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      if (views[i] + 1U < colours_of_views.size() &&
          sees(snapshot, sensor_from_model * metres_of(vertices[i]),
               sensor_from_model.linear() * normals[i].cast<double>())) {
        ++views[i];
      }
    }
  }
  std::vector<Rgb> colours(vertices.size());
  std::ranges::transform(views, colours.begin(),
                         [](std::uint8_t n) { return colours_of_views[n]; });
  return colours;
}

}  // namespace octurn
