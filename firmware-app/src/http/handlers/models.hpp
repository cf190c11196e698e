#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// The models of scans, as STL.

/// That of the newest finished scan. @throws Error "no-model"
Response send_newest_model(App& app, const Request& request);

/// The model of a scan; with parameters, one that is made for this answer.
/// @throws Error "no-such-scan", "no-model", "bad-settings", "busy", "memory-limit"
Response send_model(App& app, const Request& request, std::string_view id);

/// Refuses a query that asks for colours where a file has none. @throws Error "bad-settings"
void refuse_colours(const Request& request);

/// What a file of a scan is called when it is downloaded.
/// @param ending  with its dot, such as ".stl"
std::string download_name(const Job& job, std::string_view ending);

/// The file of a scan's model. @throws Error "no-model"
std::filesystem::path find_model(const App& app, const Job& job);

/// The surface of what the latest scan has seen so far.
/// @throws Error "no-such-scan", "no-preview"
Response send_preview(App& app, const Request& request, std::string_view id);

}  // namespace octurn
