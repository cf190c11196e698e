#pragma once

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// The sensor's pose, its own error and its lens: what `/api/v1/calibration` answers.

/// The pose in force, those before it, and the measurement that goes on or was the last.
Response send_calibration(App& app);

/// Puts the pose, or the scale, of the body into force, removes the sensor's map, or keeps,
/// discards or removes a lens.
/// @throws Error "bad-json", "bad-settings", "busy", "not-found", "disk-full", "write-failed"
Response change_calibration(App& app, const Request& request);

/// Begins the measurement of the body. 202
/// @throws Error "bad-json", "bad-settings", "busy", "sensor-...", "turntable-..."
Response start_calibration(App& app, const Request& request);

/// @throws Error "not-running"
Response cancel_calibration(App& app);

/// Has the lens solved from the views of a board so far. 202
/// @throws Error "not-running"  if no board is looked at, or was not seen yet
Response solve_lens(App& app);

/// The board for that, as a PDF. @throws Error "bad-settings"  if the query asks for other paper
Response send_board(App& app, const Request& request);

/// Puts the pose before the one in force back. @throws Error "not-found"
Response undo_calibration(App& app);

/// A picture of the map of the sensor's own error. @throws Error "not-found"
Response send_sensor_map(App& app);

/// What the sensor sees as points in its own frame. @throws Error "sensor-..."
Response send_points(App& app);

}  // namespace octurn
