#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "http/app.hpp"
#include "http/message.hpp"
#include "octurn/png.hpp"
#include "octurn/snapshot.hpp"

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

// Control of the machine: clock, power and log.

/// Sets the clock of an appliance without a time server.
/// @throws Error "not-an-appliance", "bad-json", "bad-settings"  also if the clock is right
Response set_clock(App& app, const Request& request);

/// Restarts the appliance. @throws Error "not-an-appliance", "busy"
Response restart_machine(App& app);

/// Shuts the appliance down. @throws Error "not-an-appliance", "busy"
Response shut_machine_down(App& app);

/// Sends the newest lines of this program's log, and of the errors that root has logged.
Response send_messages(App& app);

/// The name of the sensor, as of its last use.
std::string sensor_name(const App& app);

/// A depth frame as a picture for people: PNG, 8-bit grey, 320 x 240, near bright, far dark, black
/// where there is no reading.
std::string preview_png(const DepthFrame& frame, double depth_unit,
                        const SensorTraits& sensor = {});

/// A camera's picture as PNG of that size, with unchanged brightness.
std::string preview_png(const Picture& picture);

}  // namespace octurn
