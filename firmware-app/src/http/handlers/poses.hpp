#pragma once

#include <string_view>

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// Scans of one object in other poses, at `/api/v1/scans/{id}/poses`. Poses are numbered from 1.
// Each handler throws Error "no-such-scan" for an unknown scan, and "not-found" for an unknown
// pose.

/// Lists the scans of a scan's other poses, oldest first.
Response list_poses(App& app, std::string_view id);

/// Starts a scan of the object in another pose. Answers 202 with Location.
/// @throws Error "bad-json", "bad-settings", "no-model", "busy", "sensor-...", "turntable-..."
Response start_pose(App& app, const Request& request, std::string_view id);

/// Registers a pose again from the candidate or the point pairs of the body, and rebuilds the model
/// of all poses. Answers 202 with Location of the build.
/// @throws Error "bad-json", "bad-settings", "no-model", "busy", "disk-full"
Response choose_pose(App& app, const Request& request, std::string_view id,
                     std::string_view number);

/// Sends points of the object and of a pose, so that a person can align them.
/// @throws Error "no-model"  if the pose was not registered yet
Response send_pose_points(App& app, const Request& request, std::string_view id,
                          std::string_view number);

/// Removes a pose, and restores the model before it. @throws Error "busy"
Response remove_pose(App& app, std::string_view id, std::string_view number);

}  // namespace octurn
