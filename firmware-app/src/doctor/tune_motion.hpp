#pragma once

#include <functional>
#include <optional>
#include <stop_token>

#include "capture/platform_swing.hpp"
#include "capture/rig.hpp"
#include "turntable/stepper_settings.hpp"

namespace octurn {

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

}  // namespace octurn
