#include "simulator/scene.hpp"

#include <cmath>
#include <numbers>
#include <utility>

#include "octurn/units.hpp"
#include "simulator/camera.hpp"
#include "simulator/object_pose.hpp"

namespace octurn {
namespace {

constexpr double baseline = 0.075;  // metres from the camera to the projector, along +X

/// The projector's picture has the camera's rows, and more columns: enough to cover everything that
/// the camera sees beyond 0.37 m.
constexpr int wider = 116;  // pixels; f b / 0.37 m
constexpr Intrinsics projector = {.width = camera.width + wider, .cx = camera.cx + wider};

void add_rectangle(Mesh& mesh, const Eigen::Vector3f& corner, const Eigen::Vector3f& side,
                   const Eigen::Vector3f& other_side) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (const Eigen::Vector3f& vertex :
       {corner, Eigen::Vector3f(corner + side), Eigen::Vector3f(corner + side + other_side),
        Eigen::Vector3f(corner + other_side)}) {
    mesh.vertices.push_back(vertex);
  }
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

void add_platform(Mesh& mesh) {
  constexpr double radius = 0.150;
  constexpr float thickness = 0.0127F;
  constexpr std::uint32_t corners = 128;  // the polygon is within 0.05 mm of the circle
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (std::uint32_t i = 0; i < corners; ++i) {
    const double angle = 2 * std::numbers::pi * i / corners;
    const auto x = static_cast<float>(radius * std::cos(angle));
    const auto y = static_cast<float>(radius * std::sin(angle));
    mesh.vertices.emplace_back(x, y, 0.0F);
    mesh.vertices.emplace_back(x, y, -thickness);
  }
  mesh.vertices.emplace_back(0.0F, 0.0F, 0.0F);
  for (std::uint32_t i = 0; i < corners; ++i) {
    const std::uint32_t top = first + 2 * i;
    const std::uint32_t next_top = first + 2 * ((i + 1) % corners);
    mesh.triangles.push_back({first + 2 * corners, top, next_top});
    mesh.triangles.push_back({top, top + 1, next_top + 1});
    mesh.triangles.push_back({top, next_top + 1, next_top});
  }
}

/// The platform and what stands behind it, in the platform's frame, metres.
Mesh surroundings() {
  Mesh mesh;
  add_platform(mesh);
  add_rectangle(mesh, {-1.0F, -0.45F, -0.08F}, {2.0F, 0, 0}, {0, 1.2F, 0});  // table
  add_rectangle(mesh, {-1.5F, 0.95F, -0.8F}, {3.0F, 0, 0}, {0, 0, 2.0F});    // wall
  return mesh;
}

/// True where the projector's light falls. Its picture holds the surface that the light meets
/// first.
bool is_lit(const float* projector_row, int u, float inverse_depth) {
  constexpr auto shift = static_cast<float>(camera.fx * baseline);
  constexpr float slack = 0.0025F;  // 1/m, 1 mm at 0.65 m: surfaces must not shade themselves
  const float column = static_cast<float>(u + wider) - shift * inverse_depth;
  if (!(column >= 0)) {
    return true;  // nearer than the projector's picture and the sensor's range reach
  }
  const auto left = static_cast<int>(column);
  const float blocking = std::min(projector_row[left], projector_row[left + 1]);
  return inverse_depth + slack >= blocking;
}

}  // namespace

Scene::Scene(Mesh object, const Eigen::Isometry3d& platform_from_sensor)
    : Scene(std::move(object), surroundings(), platform_from_sensor) {}

Scene Scene::of_wall(double distance) {
  const auto z = static_cast<float>(distance);
  Mesh wall;
  add_rectangle(wall, {-2 * z, -2 * z, z}, {4 * z, 0, 0}, {0, 4 * z, 0});
  return {{}, wall, Eigen::Isometry3d::Identity()};
}

Scene::Scene(Mesh object, const Mesh& around, const Eigen::Isometry3d& platform_from_sensor)
    : object_(std::move(object)),
      camera_from_platform_(platform_from_sensor.inverse()),
      projector_from_platform_(Eigen::Translation3d(-baseline, 0, 0) * camera_from_platform_),
      camera_background_(pixels(camera), 0.0F),
      projector_background_(pixels(projector), 0.0F) {
  rasterise(around, camera_from_platform_, camera, camera_background_);
  rasterise(around, projector_from_platform_, projector, projector_background_);
}

bool Scene::lay_object(int pose) {
  if (pose == pose_) {
    return false;
  }
  pose_ = pose;
  platform_from_object_ = platform_from_object(object_, pose);
  return true;
}

InverseDepth Scene::lit_at(double angle) const {
  const Eigen::Isometry3d turn =
      Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) * platform_from_object_;
  InverseDepth seen = camera_background_;
  InverseDepth reached = projector_background_;
  rasterise(object_, camera_from_platform_ * turn, camera, seen);
  rasterise(object_, projector_from_platform_ * turn, projector, reached);
  for (int v = 0; v < camera.height; ++v) {
    float* row = seen.data() + static_cast<std::ptrdiff_t>(v) * camera.width;
    const float* projector_row = reached.data() + static_cast<std::ptrdiff_t>(v) * projector.width;
    for (int u = 0; u < camera.width; ++u) {
      if (!is_lit(projector_row, u, row[u])) {
        row[u] = 0;
      }
    }
  }
  return seen;
}

}  // namespace octurn
