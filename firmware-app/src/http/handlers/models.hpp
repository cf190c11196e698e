#pragma once

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

/// The surface of what the latest scan has seen so far.
/// @throws Error "no-such-scan", "no-preview"
Response send_preview(App& app, const Request& request, std::string_view id);

}  // namespace octurn
