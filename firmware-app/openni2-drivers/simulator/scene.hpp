#pragma once

#include <Eigen/Geometry>

#include "octurn/snapshot.hpp"
#include "rig/nominal_pose.hpp"
#include "simulator/mesh.hpp"
#include "simulator/placed_object.hpp"
#include "simulator/rasterise.hpp"
#include "simulator/sensor_unit.hpp"

namespace octurn {

/// A turning platform (a disc of 150 mm radius, 12.7 mm thick) with an object on it, on a table in
/// front of a wall, before a Kinect v1: a camera, and a projector 75 mm to its right. Surfaces that
/// the projector does not light have no depth, so objects throw a shadow to the left.
class Scene {
 public:
  /// @param object  in the platform's frame at angle 0, metres
  /// @param platform_from_sensor  the sensor's true pose
  /// @param optics  the sensor's
  explicit Scene(Mesh object,
                 const Eigen::Isometry3d& platform_from_sensor = nominal_platform_from_sensor(),
                 const SensorOptics& optics = {});

  /// Makes a scene of a wall only. @param distance  metres; the sensor looks squarely at the wall
  static Scene of_wall(double distance, const SensorOptics& optics = {});

  /// Makes a scene of a printed board before a wall.
  /// @param hold  as of `infrared_hold`
  static Scene of_board(int hold, const SensorOptics& optics);

  /// Turns the object over. @param pose  as of `platform_from_object`
  /// @return false if it has this pose already
  bool set_object_pose(int pose) { return object_.set_pose(pose); }

  const SensorOptics& optics() const { return view_.optics(); }

  /// What the sensor reports of the surfaces that the camera sees and the projector lights, 640 x
  /// 480; 0 where there is none.
  /// @param angle  of the platform, radians, counter-clockwise seen from above
  InverseDepth lit_at(double angle) const;

 private:
  /// @param around  the surroundings, which do not turn, in the platform's frame
  Scene(Mesh object, const Mesh& around, const Eigen::Isometry3d& platform_from_sensor,
        const SensorOptics& optics);

  PlacedObject object_;
  SensorView view_;
  Intrinsics camera_;
  Intrinsics projector_;
  Eigen::Isometry3d camera_from_platform_;
  Eigen::Isometry3d projector_from_platform_;
  InverseDepth camera_background_;
  InverseDepth projector_background_;
};

}  // namespace octurn
