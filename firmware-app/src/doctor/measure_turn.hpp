#pragma once

#include <functional>
#include <stop_token>

#include "capture/rig.hpp"
#include "doctor/seen_rotation.hpp"

namespace octurn {

/// Motion of the platform, measured from depth frames of an object on it.
struct TurnMeasurement {
  double turn_deg = 0;    ///< per commanded full turn, counter-clockwise; 0: it does not move
  double play_deg = 0;    ///< backlash: by how much a move backwards falls short
  double return_deg = 0;  ///< offset from the starting angle after all moves
};

/// Measures one turn of the platform. Small moves give size and direction of a move, a whole turn
/// refines the size, moves forth and back give the backlash, and a return to the starting angle
/// shows lost steps.
///
/// Each comparison of two frames estimates the axis, too. With a pose that is 15 mm and 2 degrees
/// off, and a Kinect's fixed-pattern error, a turn of 270 degrees is measured to half a degree, and
/// the backlash to one. From errors of 20 mm or 3 degrees on, the result is arbitrary: calibrate
/// first.
///
/// @param platform_from_sensor  the sensor's pose; with `clip` it selects the object
/// @param on_progress           called with the share that is done, from 0 to 1
/// @throws Stopped              once `stop` is requested
/// @throws Error "sensor-blind" if there is no object, or it looks the same from all sides
/// @throws Error                if a device fails
TurnMeasurement measure_turn(Rig& rig, const Eigen::Isometry3d& platform_from_sensor,
                             const Box& clip, const std::stop_token& stop,
                             const std::function<void(double done)>& on_progress);

}  // namespace octurn
