#pragma once

#include <nlohmann/json_fwd.hpp>

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// The state of the scanner as a whole.

/// The devices, free disk space, warnings, the running scan and build, and the id of the newest
/// finished scan. Touches no disk.
nlohmann::json status_json(const App& app);
Response send_status(App& app);

/// Sends the OpenAPI 3.1 description of this interface, a file of the page.
Response send_description(App& app, const Request& request);

/// Sends the findings of `octurn doctor`.
Response send_findings(App& app);

/// Sends a zip of diagnostics for support: findings, log, settings and scans.
Response send_diagnostics(App& app);

/// Sends the current depth frame or camera picture as PNG. @throws Error "sensor-..."
Response send_depth_picture(App& app);

}  // namespace octurn
