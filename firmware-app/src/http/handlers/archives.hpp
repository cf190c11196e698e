#pragma once

#include <string_view>

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// Whole scans as zip files, to move them from one Octurn to another.

/// Sends a scan's snapshots and settings as a zip file.
/// @throws Error "no-such-scan", "busy"  while it runs, "no-model"  without snapshots, "disk-full"
Response send_archive(App& app, const Request& request, std::string_view id);

/// Receives such a zip file as a new scan, and builds its model unless a scan runs. Answers 201
/// with Location.
/// @throws Error "length-required", "too-large", "cut-short", "bad-request", "disk-full"
Response import_scan(App& app, const Request& request);

}  // namespace octurn
