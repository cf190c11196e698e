#include "simulator/placed_object.hpp"

#include <utility>

#include "simulator/mesh_file.hpp"
#include "simulator/object_pose.hpp"
#include "simulator/simulator_object.hpp"

namespace octurn {

PlacedObject::PlacedObject(Mesh mesh) : mesh_(std::move(mesh)) {}

bool PlacedObject::set_pose(int pose) {
  if (pose == pose_) {
    return false;
  }
  pose_ = pose;
  platform_from_object_ = platform_from_object(mesh_, pose);
  return true;
}

Eigen::Isometry3d PlacedObject::platform_from_mesh(double angle) const {
  return Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()) * platform_from_object_;
}

Mesh told_object(const std::string& mesh_file) {
  if (mesh_file.empty()) {
    return simulator_object();
  }
  Mesh mesh = read_mesh(mesh_file);
  stand_on_platform(mesh);
  return mesh;
}

}  // namespace octurn
