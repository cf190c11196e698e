#pragma once

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// The sensor's pose and its own error: what `/api/v1/calibration` answers.

/// The pose in force, those before it, and the measurement that goes on or was the last.
Response send_calibration(App& app);

/// Puts the pose, or the scale, of the body into force, or removes the sensor's map.
/// @throws Error "bad-json", "bad-settings", "busy", "not-found", "disk-full", "write-failed"
Response change_calibration(App& app, const Request& request);

/// Begins the measurement of the body. 202
/// @throws Error "bad-json", "bad-settings", "busy", "sensor-...", "turntable-..."
Response start_calibration(App& app, const Request& request);

/// @throws Error "not-running"
Response cancel_calibration(App& app);

/// Puts the pose before the one in force back. @throws Error "not-found"
Response undo_calibration(App& app);

/// A picture of the map of the sensor's own error. @throws Error "not-found"
Response send_sensor_map(App& app);

/// What the sensor sees as points in its own frame. @throws Error "sensor-..."
Response send_points(App& app);

}  // namespace octurn
