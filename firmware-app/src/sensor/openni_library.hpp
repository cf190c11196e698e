#pragma once

#include <OpenNI.h>

#include <string>

namespace octurn {

inline constexpr const char* missing_sensor_hint =
    "Check that the sensor has its own power supply, that its USB plug sits firmly, and that its "
    "light is on.";

/// The last failure in the words of OpenNI2 and its drivers, on one line.
std::string openni_error_text();

/// @param doing  the action that returned `status`: "sensor: cannot start its depth stream"
/// @throws Error "sensor-failed"  unless the status is STATUS_OK
void expect_ok(openni::Status status, const char* doing);

/// Opens a device. @param uri  empty: the first real sensor that is found
/// @throws Error "sensor-missing", or "sensor-failed" for a simulated sensor that is set wrongly
void open_device(openni::Device& device, const std::string& uri);

}  // namespace octurn
