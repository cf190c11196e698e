#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// Models rebuilt from the snapshots of a scan, at `/api/v1/scans/{id}/builds`. Each handler throws
// Error "no-such-scan" for an unknown scan, and "no-model" for an unknown build.

/// Lists all builds of a scan; the first is the model that the scan itself made.
Response list_builds(App& app, std::string_view id);

/// Starts a build with the settings of the body. Answers 202 with Location.
/// @throws Error "bad-json", "bad-settings", "busy", "no-model", "disk-full"
Response start_build(App& app, const Request& request, std::string_view id);

/// Answers 202 with a build that has started, and its Location.
/// @param run  nothing: none could start @throws Error "busy"  then
Response send_begun(const std::optional<BuildRun>& run);

Response send_build(App& app, std::string_view id, std::string_view build);

/// Asks a build to stop. Answers 202. @throws Error "not-running"  if it has ended
Response cancel_build(App& app, std::string_view id, std::string_view build);

/// Makes a build's model that of the scan. @throws Error "disk-full", "write-failed"
Response choose_build(App& app, std::string_view id, std::string_view build);

/// Removes a build and its model. @throws Error "busy"  if the scan uses that model
Response remove_build(App& app, std::string_view id, std::string_view build);

/// The path of a build's STL. @throws Error "no-model"  also if the build has not finished
std::filesystem::path find_build_model(const App& app, std::string_view id, std::string_view build);

/// Sends a build's model as STL. @throws Error "bad-settings"  if the query asks for colours
Response send_build_model(App& app, const Request& request, std::string_view id,
                          std::string_view build);

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
