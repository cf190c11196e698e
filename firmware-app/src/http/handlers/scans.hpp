#pragma once

#include <string_view>

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// Scans: what `/api/v1/scans` answers. Each throws Error "no-such-scan" for an id that there is
// not.

/// All scans, the newest first.
Response list_scans(App& app);

/// Starts a scan with the settings of the body. 202, and its address.
/// @throws Error "bad-json", "bad-settings", "busy", "sensor-...", "turntable-...", "disk-full"
Response start_scan(App& app, const Request& request);

Response send_scan(App& app, std::string_view id);

/// Gives a scan the name and the notes of the body. @throws Error "bad-json", "bad-name"
Response label_scan(App& app, const Request& request, std::string_view id);

/// Moves a scan into the bin. @throws Error "busy"  if it runs
Response remove_scan(App& app, std::string_view id);

/// Asks a scan to stop. @throws Error "not-running"  if it has ended
Response cancel_scan(App& app, std::string_view id);

/// Asks a scan to stop so that it can go on later. @throws Error "not-running"
Response pause_scan(App& app, std::string_view id);

/// What a scan with the settings of the body takes. @throws Error "bad-json", "bad-settings"
Response send_estimate(App& app, const Request& request);

/// Goes on with a scan that was paused, interrupted, or ended last.
/// @throws Error "busy", "not-paused", "sensor-...", "turntable-..."
Response resume_scan(App& app, std::string_view id);

}  // namespace octurn
