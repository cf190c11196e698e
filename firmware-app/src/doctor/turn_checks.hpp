#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <stop_token>
#include <vector>

#include "capture/platform_swing.hpp"
#include "capture/rig.hpp"
#include "doctor/finding.hpp"
#include "turntable/stepper_settings.hpp"

namespace octurn {

/// Motion of the platform, measured from depth frames of an object on it.
struct TurnMeasurement {
  double turn_deg = 0;      ///< per commanded full turn, counter-clockwise; 0: it does not move
  double play_deg = 0;      ///< backlash: by how much a move backwards falls short
  double return_deg = 0;    ///< offset from the starting angle after all moves
  double swings_for_s = 0;  ///< how long the platform swings beyond `settle_time`
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

/// What a platform's motor can do, as a pace: the configured speeds times it, and the acceleration
/// times its square.
struct MotionLimits {
  std::optional<double> fastest = {};  ///< pace that lost no step; nothing: each that was tried did
  std::optional<double> lost_at = {};  ///< the slowest that lost some; nothing: none did
};

/// Finds the fastest pace at which the platform loses no step: it makes short moves as a scan does,
/// and a long one to the angle of the first look, and the sensor sees whether it went as far as the
/// pulses. Begins with the configured pace, and goes on to quicker ones while nothing is lost, or
/// to slower ones until nothing is. The pace is 1 again at the end.
///
/// @param rate  degrees of the platform for each commanded degree, from `measure_turn`
/// @throws Stopped  once `stop` is requested
/// @throws Error "sensor-blind" if the object's turn cannot be seen
MotionLimits find_motion_limits(Rig& rig, const PlatformLook& look, double rate,
                                const StepperSettings& settings, const std::stop_token& stop);

/// The pace to scan with: one for which the motor has twice the torque that is needed. Torque grows
/// with the square of the pace.
double pace_with_margin(double fastest);

/// A finding about the turntable's motion, and the setting that corrects it.
struct TurnFinding {
  Finding finding = {};
  nlohmann::json set = nlohmann::json::object();  ///< of "turntable" in octurn.json; empty: none
};

/// Checks direction, size of a turn, backlash, return and swinging of a measured turn.
/// @param settings  in force during the measurement
std::vector<TurnFinding> check_turn(const TurnMeasurement& turn, const StepperSettings& settings);

/// Whether the motor has a margin at the configured speeds; proposes others otherwise.
TurnFinding check_motion(const MotionLimits& limits, const StepperSettings& settings);

/// Measures a turn at half of the configured speeds, so that lost steps do not distort it, checks
/// it, and, if it is whole, finds out which speeds lose no step.
/// @throws Stopped, Error  as `measure_turn`
std::vector<TurnFinding> test_turn(Rig& rig, const StepperSettings& settings,
                                   const Eigen::Isometry3d& platform_from_sensor, const Box& clip,
                                   const std::stop_token& stop,
                                   const std::function<void(double done)>& on_progress);

}  // namespace octurn
