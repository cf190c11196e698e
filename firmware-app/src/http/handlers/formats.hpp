#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// What is made of a scan's model when somebody asks for it first, and then lies beside it: other
// formats, and a picture. Each throws Error "no-such-scan", "no-model", "disk-full".

/// The file of a scan's model. @param extension  ".stl", or of another format, which is made first
std::filesystem::path model_in_format(const App& app, const Job& job, const std::string& extension);

/// The model in the format that the path's ending names: 3MF, PLY or GLB. With the parameter
/// `colour` it has the colours of the scan's pictures.
/// @throws Error "bad-settings"  if the scan has none; "busy", "memory-limit"
Response send_mesh(App& app, const Request& request, std::string_view id);

/// The same of a build.
Response send_build_mesh(App& app, const Request& request, std::string_view id,
                         std::string_view build);

/// A picture of the model.
Response send_thumbnail(App& app, const Request& request, std::string_view id);

/// The model with 3,000 facets or less, for a first sight of it.
Response send_coarse_model(App& app, const Request& request, std::string_view id);

/// The same of a build.
Response send_coarse_build(App& app, const Request& request, std::string_view id,
                           std::string_view build);

}  // namespace octurn
