#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// The models of scans, as STL.

/// Sends the model of the newest finished scan.
/// @throws Error "no-model", "bad-settings"  if the query asks for colours
Response send_newest_model(App& app, const Request& request);

/// Sends the model of a scan. With query parameters the model is built for this answer alone.
/// @throws Error "no-such-scan", "no-model", "bad-settings", "busy", "memory-limit"
Response send_model(App& app, const Request& request, std::string_view id);

/// Refuses a query that asks for colours, as STL has none. @throws Error "bad-settings"
void refuse_colours(const Request& request);

/// The name under which a browser saves a file of a scan.
/// @param ending  appended to the scan's name, such as ".stl"
std::string download_name(const Job& job, std::string_view ending);

/// The path of a scan's STL. @throws Error "no-model"
std::filesystem::path find_model(const App& app, const Job& job);

/// Sends a coarse mesh of the latest scan's snapshots so far, as STL.
/// @throws Error "no-such-scan", "no-preview"
Response send_preview(App& app, const Request& request, std::string_view id);

}  // namespace octurn
