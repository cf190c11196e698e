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

/// Sends a coarse mesh of the latest scan's snapshots so far, as STL.
/// @throws Error "no-such-scan", "no-preview"
Response send_preview(App& app, const Request& request, std::string_view id);

// Files derived from a scan's model: other formats, a thumbnail and a coarse mesh. They are made at
// the first request and cached beside the model. Each handler throws Error "no-such-scan",
// "no-model", "disk-full".

/// The path of a scan's model in a format; a derived file is made if it is missing or outdated.
/// @param extension  of the format, such as ".stl"
std::filesystem::path model_in_format(const App& app, const Job& job, const std::string& extension);

/// Sends the model in the format of the path's extension: 3MF, PLY or GLB. With the parameter
/// `colour=true` its vertices have the colours of the scan's pictures.
/// @throws Error "bad-settings"  if the scan has none; "busy", "memory-limit"
Response send_mesh(App& app, const Request& request, std::string_view id);

/// Sends the model of a build, as `send_mesh`.
Response send_build_mesh(App& app, const Request& request, std::string_view id,
                         std::string_view build);

/// Sends a PNG thumbnail of the model.
Response send_thumbnail(App& app, const Request& request, std::string_view id);

/// Sends the model simplified to at most 3,000 facets, as STL, for a fast first view.
Response send_coarse_model(App& app, const Request& request, std::string_view id);

/// Sends the coarse model of a build.
Response send_coarse_build(App& app, const Request& request, std::string_view id,
                           std::string_view build);

}  // namespace octurn
