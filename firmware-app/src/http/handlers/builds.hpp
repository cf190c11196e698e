#pragma once

#include <filesystem>
#include <optional>
#include <string_view>

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// Models built again from the snapshots of a scan: what `/api/v1/scans/{id}/builds` answers. Each
// throws Error "no-such-scan" for a scan that there is not, and "no-model" for such a build.

/// All builds of a scan, the one that it made itself first.
Response list_builds(App& app, std::string_view id);

/// Begins a build with the settings of the body. 202, and its address.
/// @throws Error "bad-json", "bad-settings", "busy", "no-model", "disk-full"
Response start_build(App& app, const Request& request, std::string_view id);

/// Tells of a build that was begun: 202, and its address.
/// @throws Error "busy"  if none was
Response send_begun(const std::optional<BuildRun>& run);

Response send_build(App& app, std::string_view id, std::string_view build);

/// Asks a build to stop. @throws Error "not-running"  if it has ended
Response cancel_build(App& app, std::string_view id, std::string_view build);

/// Makes a build's model the scan's. @throws Error "disk-full", "write-failed"
Response choose_build(App& app, std::string_view id, std::string_view build);

/// Removes a build and its model. @throws Error "busy"  if that is the scan's
Response remove_build(App& app, std::string_view id, std::string_view build);

/// The file of a build's model.
std::filesystem::path find_build_model(const App& app, std::string_view id, std::string_view build);

/// The model of a build.
Response send_build_model(App& app, const Request& request, std::string_view id,
                          std::string_view build);

}  // namespace octurn
