#include "simulator/object_pose.hpp"

#include <cmath>

#include "octurn/units.hpp"

namespace octurn {
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
