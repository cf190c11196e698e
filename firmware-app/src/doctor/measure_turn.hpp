#pragma once

#include <functional>
#include <stop_token>

#include "doctor/seen_rotation.hpp"
#include "scan/rig.hpp"

namespace octurn {

/// How the platform moves, by what the sensor sees of an object on it.
struct TurnMeasurement {
  double turn_deg = 0;    ///< for each turn that the motor is told, counter-clockwise; 0: it stands
  double play_deg = 0;    ///< that a move backwards falls short by
  double return_deg = 0;  ///< how far from where it began it stands after all moves
};

/// Turns the platform once and looks: small moves first, which tell how far a move goes and in
/// which direction, then one to where it should look as at the beginning; then one there and back,
/// for the play; and back to the beginning. Each comparison finds the axis itself: with a pose that
/// is 15 mm and 2 degrees off, and a sensor with a Kinect's fixed pattern, a turn of 270 degrees is
/// found to half a degree, and the play to one. From 20 mm or 3 degrees on it can be any: then
/// calibrate first.
///
/// @param platform_from_sensor  and clip box: where to look for the object
/// @param on_progress           told how much is done, from 0 to 1
/// @throws Stopped              once `stop` is requested
/// @throws Error "sensor-blind" if there is no object, or it looks the same from all sides
/// @throws Error                if a device fails
TurnMeasurement measure_turn(Rig& rig, const Eigen::Isometry3d& platform_from_sensor,
                             const Box& clip, const std::stop_token& stop,
                             const std::function<void(double done)>& on_progress);

}  // namespace octurn
