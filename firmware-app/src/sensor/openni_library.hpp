#pragma once

#include <OpenNI.h>

#include <chrono>
#include <optional>
#include <string>

#include "octurn/error.hpp"
#include "octurn/snapshot.hpp"

namespace octurn {

inline constexpr const char* missing_sensor_hint =
    "Check that the sensor has its own power supply, that its USB plug sits firmly, and that its "
    "light is on.";

/// @param doing  the action that returned `status`: "sensor: cannot start its depth stream"
/// @throws Error "sensor-failed"  unless the status is STATUS_OK
void expect_ok(openni::Status status, const char* doing);

/// Opens a device. @param uri  empty: the first real sensor that is found
/// @throws Error "sensor-missing", or "sensor-failed" for a simulated sensor that is set wrongly
void open_device(openni::Device& device, const std::string& uri);

/// The unit of a mode's depths in metres; nothing for a format that Octurn does not read.
std::optional<double> depth_unit(const openni::VideoMode& mode);

/// The intrinsics of a depth stream's mode, in pixels, from its fields of view.
/// @throws Error "sensor-failed" unless its depth is in millimetres
Intrinsics to_intrinsics(const openni::VideoStream& stream);

/// Waits until a stream has a frame to read. @return false after the timeout
bool wait_for_frame(openni::VideoStream& stream, std::chrono::milliseconds timeout);

/// Reads a frame, and waits for it. @throws Error "sensor-failed"
openni::VideoFrameRef read_frame(openni::VideoStream& stream);

/// Copies a picture of 8-bit grey levels.
Picture to_picture(const openni::VideoFrameRef& frame);

DepthFrame to_depth_frame(const openni::VideoFrameRef& frame);

/// The error "sensor-silent" of a sensor that has sent no frame for so long.
/// @param lost_share  of its packets meanwhile, which were lost on the way
Error silence_error(std::chrono::milliseconds silence, double lost_share = 0);

}  // namespace octurn
