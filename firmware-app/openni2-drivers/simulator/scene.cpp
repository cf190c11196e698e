#include "simulator/scene.hpp"

#include <cmath>
#include <utility>

#include "simulator/camera.hpp"
#include "simulator/infrared_board.hpp"
#include "simulator/printed_board.hpp"
#include "simulator/surroundings.hpp"

namespace octurn {
namespace {

constexpr double baseline = 0.075;  // metres from the camera to the projector, along +X

/// The projector's picture has the camera's rows, and more columns: enough to cover everything that
/// the camera sees beyond 0.37 m.
constexpr int wider = 116;  // pixels; f b / 0.37 m

Intrinsics projector_beside(Intrinsics camera) {
  camera.width += wider;
  camera.cx += wider;
  return camera;
}

/// Whether the projector lights a point, by shadow mapping: the projector's picture is the inverse
/// depth of the first surface along each of its rays.
/// @param shift  pixels for each 1/m
bool is_lit(const float* projector_row, int u, float inverse_depth, float shift) {
  constexpr float slack = 0.0025F;  // 1/m, 1 mm at 0.65 m: surfaces must not shadow themselves
  const float column = static_cast<float>(u + wider) - shift * inverse_depth;
  if (!(column >= 0)) {
    return true;  // outside of the projector's picture: nearer than the sensor's range
  }
  const auto left = static_cast<int>(column);
  const float blocking = std::min(projector_row[left], projector_row[left + 1]);
  return inverse_depth + slack >= blocking;
}

}  // namespace

Scene::Scene(Mesh object, const Eigen::Isometry3d& platform_from_sensor, const SensorOptics& optics)
    : Scene(std::move(object), surroundings(), platform_from_sensor, optics) {}

Scene Scene::of_wall(double distance, const SensorOptics& optics) {
  const auto z = static_cast<float>(distance);
  Mesh wall;
  add_rectangle(wall, {-2 * z, -2 * z, z}, {4 * z, 0, 0}, {0, 4 * z, 0});
  return {{}, wall, Eigen::Isometry3d::Identity(), optics};
}

Scene Scene::of_board(int hold, const SensorOptics& optics) {
  constexpr float wall = 1.8F;  // metres
  const Eigen::Isometry3d pose = infrared_hold(hold, optics);
  const auto place = [&](double column, double row) {
    return Eigen::Vector3f((board_square * (pose * Eigen::Vector3d(column, row, 0))).cast<float>());
  };
  const Eigen::Vector3f corner = place(-board_margin, -board_margin);
  Mesh around;
  add_rectangle(around, corner, place(board_columns + board_margin, -board_margin) - corner,
                place(-board_margin, board_rows + board_margin) - corner);
  add_rectangle(around, {-2 * wall, -2 * wall, wall}, {4 * wall, 0, 0}, {0, 4 * wall, 0});
  return {{}, around, Eigen::Isometry3d::Identity(), optics};
}

Scene::Scene(Mesh object, const Mesh& around, const Eigen::Isometry3d& platform_from_sensor,
             const SensorOptics& optics)
    : object_(std::move(object)),
      view_(optics),
      camera_(pinhole_of(optics)),
      projector_(projector_beside(camera_)),
      camera_from_platform_(platform_from_sensor.inverse()),
      projector_from_platform_(Eigen::Translation3d(-baseline, 0, 0) * camera_from_platform_),
      camera_background_(pixels(camera_), 0.0F),
      projector_background_(pixels(projector_), 0.0F) {
  rasterise(around, camera_from_platform_, camera_, camera_background_);
  rasterise(around, projector_from_platform_, projector_, projector_background_);
}

InverseDepth Scene::lit_at(double angle) const {
  const Eigen::Isometry3d turn = object_.platform_from_mesh(angle);
  InverseDepth seen = camera_background_;
  InverseDepth reached = projector_background_;
  rasterise(object_.mesh(), camera_from_platform_ * turn, camera_, seen);
  rasterise(object_.mesh(), projector_from_platform_ * turn, projector_, reached);
  const auto shift = static_cast<float>(camera_.fx * baseline);
  for (int v = 0; v < camera_.height; ++v) {
    float* row = seen.data() + static_cast<std::ptrdiff_t>(v) * camera_.width;
    const float* projector_row = reached.data() + static_cast<std::ptrdiff_t>(v) * projector_.width;
    for (int u = 0; u < camera_.width; ++u) {
      if (!is_lit(projector_row, u, row[u], shift)) {
        row[u] = 0;
      }
    }
  }
  return view_.of(seen);
}

}  // namespace octurn
