#pragma once

#include <string_view>

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// Whole scans as files, from one Octurn to another.

/// What a scan was taken as, in one file.
/// @throws Error "no-such-scan", "busy"  while it runs, "no-model"  without snapshots, "disk-full"
Response send_archive(App& app, const Request& request, std::string_view id);

/// Takes such a file, and builds its model unless a scan runs. 201, and its address.
/// @throws Error "length-required", "too-large", "cut-short", "bad-request", "disk-full"
Response import_scan(App& app, const Request& request);

}  // namespace octurn
