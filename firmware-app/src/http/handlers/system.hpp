#pragma once

#include <nlohmann/json_fwd.hpp>

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// What the scanner as a whole answers.

/// The devices, the disk, warnings, the scan that runs and the newest that is finished. Touches no
/// disk.
nlohmann::json status_json(const App& app);
Response send_status(App& app);

/// The description of this interface for programs, OpenAPI 3.1: a file of the page.
Response send_description(App& app, const Request& request);

/// What `octurn doctor` finds.
Response send_findings(App& app);

/// A zip of what a person who helps would want to see.
Response send_diagnostics(App& app);

/// What the sensor sees, as a picture for people. @throws Error "sensor-..."
Response send_depth_picture(App& app);

}  // namespace octurn
