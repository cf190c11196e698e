#pragma once

#include <string_view>

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// Scans, at `/api/v1/scans`. Each handler throws Error "no-such-scan" for an unknown id.

/// Lists all scans, newest first.
Response list_scans(App& app);

/// Starts a scan with the settings and the label of the body. Answers 202 with Location.
/// @throws Error "bad-json", "bad-name", "bad-settings", "busy", "sensor-...", "turntable-...",
///               "disk-full"
Response start_scan(App& app, const Request& request);

Response send_scan(App& app, std::string_view id);

/// Sets texts of a scan's label, such as its name, from the body. @throws Error "bad-json",
/// "bad-name"
Response label_scan(App& app, const Request& request, std::string_view id);

/// Moves a scan into the bin. @throws Error "busy"  if it runs
Response remove_scan(App& app, std::string_view id);

/// Asks a scan to stop. Answers 202. @throws Error "not-running"  if it has ended
Response cancel_scan(App& app, std::string_view id);

/// Asks a scan to pause. Answers 202. @throws Error "not-running"
Response pause_scan(App& app, std::string_view id);

/// Estimates the time, disk space and memory of a scan with the settings of the body.
/// @throws Error "bad-json", "bad-settings"
Response send_estimate(App& app, const Request& request);

/// Resumes a paused or interrupted scan, or a cancelled one if it is the newest. Answers 202.
/// @throws Error "busy", "not-paused", "sensor-...", "turntable-..."
Response resume_scan(App& app, std::string_view id);

// Deleted scans, at `/api/v1/bin`.

/// Lists the scans that can be restored, most recently deleted first.
Response send_bin(App& app);

/// Removes all scans in the bin permanently.
Response empty_bin(App& app);

/// Restores a scan. @throws Error "no-such-scan"  if it is not in the bin
Response restore_scan(App& app, std::string_view id);

// Several scans: those of the parameter `ids`, or all.

/// Sends a table of scans, as CSV. @throws Error "bad-settings", "no-such-scan"
Response send_table(App& app, const Request& request);

/// Sends the models of scans, with their table, as a zip file.
/// @throws Error "bad-settings", "no-such-scan", "no-model", "too-large", "too-many", "disk-full",
///               "memory-limit"
Response send_collection(App& app, const Request& request);

// Whole scans as zip files, to move them from one Octurn to another.

/// Sends a scan's snapshots and settings as a zip file.
/// @throws Error "no-such-scan", "busy"  while it runs, "no-model"  without snapshots, "disk-full"
Response send_archive(App& app, const Request& request, std::string_view id);

/// Receives such a zip file as a new scan, and builds its model unless a scan runs. Answers 201
/// with Location.
/// @throws Error "length-required", "too-large", "cut-short", "bad-request", "disk-full"
Response import_scan(App& app, const Request& request);

}  // namespace octurn
