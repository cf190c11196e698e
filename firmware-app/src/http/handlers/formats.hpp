#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

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
