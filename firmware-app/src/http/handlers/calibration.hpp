#pragma once

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// Calibration of the sensor's pose, its depth errors and its lens, at `/api/v1/calibration`.

/// Sends the pose in force, earlier poses, and the current or last measurement.
Response send_calibration(App& app);

/// Applies the pose or the depth scale of the body, removes the sensor's depth error map, or keeps,
/// discards or removes a lens.
/// @throws Error "bad-json", "bad-settings", "busy", "not-found", "disk-full", "write-failed"
Response change_calibration(App& app, const Request& request);

/// Starts the measurement that the body names. Answers 202.
/// @throws Error "bad-json", "bad-settings", "busy", "sensor-...", "turntable-..."
Response start_calibration(App& app, const Request& request);

/// Asks the measurement to stop. Answers 202. @throws Error "not-running"
Response cancel_calibration(App& app);

/// Has the lens solved from the views of the calibration board taken so far. Answers 202.
/// @throws Error "not-running"  if there are no views
Response solve_lens(App& app);

/// Sends the calibration board as a PDF.
/// @throws Error "bad-settings"  if the query asks for an unknown paper size
Response send_board(App& app, const Request& request);

/// Restores the pose that was in force before the current one. @throws Error "not-found"
Response undo_calibration(App& app);

/// Sends the sensor's depth error map as JSON, downsampled for display. @throws Error "not-found"
Response send_sensor_map(App& app);

/// Sends the depth frame, downsampled, as points in millimetres in the sensor's frame.
/// @throws Error "sensor-...", "not-found"  for a camera with lasers, which measures no depth
Response send_points(App& app);

}  // namespace octurn
