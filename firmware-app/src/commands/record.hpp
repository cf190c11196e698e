#pragma once

#include <chrono>
#include <optional>
#include <stop_token>
#include <string>

#include "sensor/depth_sensor.hpp"

namespace octurn {

/// Records what comes from a Kinect over USB, in the form of `octurn record --usb`.
/// @return nothing if the sensor is no Kinect, or `stop` is requested first
/// @throws Error  as `DepthSensor::read`, except that a silent sensor is recorded, too
std::optional<std::string> usb_log_text(DepthSensor& sensor, std::chrono::seconds duration,
                                        const std::stop_token& stop);

}  // namespace octurn
