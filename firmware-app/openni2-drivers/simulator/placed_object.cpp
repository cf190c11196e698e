#include "simulator/placed_object.hpp"

#include <cmath>
#include <utility>

#include "octurn/units.hpp"
#include "simulator/mesh_file.hpp"
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

namespace {

// Multiples of the golden angle spread evenly (Vogel 1979), so that no two poses are nearly alike.
constexpr double golden_deg = 137.508;
constexpr double first_tip_deg = 100;  // of pose 1, about a horizontal axis
constexpr double more_tip_deg = 25;    // added by each further pose

}  // namespace

Eigen::Isometry3d platform_from_object(const Mesh& object, int pose) {
  Eigen::Isometry3d lies = Eigen::Isometry3d::Identity();
  if (pose == 0 || object.vertices.empty()) {
    return lies;
  }
  const double axis = radians_from_degrees(golden_deg * (pose - 1));
  const double tip = radians_from_degrees(first_tip_deg + more_tip_deg * (pose - 1));
  const double turn = radians_from_degrees(golden_deg * pose);
  lies.linear() = (Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(tip, Eigen::Vector3d(std::cos(axis), std::sin(axis), 0)))
                      .toRotationMatrix();
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& vertex : object.vertices) {
    box.extend(lies.linear() * vertex.cast<double>());
  }
  const Eigen::Vector3d aside(0.007, -0.005, 0);  // metres
  const Eigen::Vector3d middle = box.center();
  lies.translation() = aside - Eigen::Vector3d(middle.x(), middle.y(), box.min().z());
  return lies;
}

}  // namespace octurn
