#pragma once

#include <string_view>

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// Deleted scans, at `/api/v1/bin`.

/// Lists the scans that can be restored, most recently deleted first.
Response send_bin(App& app);

/// Removes all scans in the bin permanently.
Response empty_bin(App& app);

/// Restores a scan. @throws Error "no-such-scan"  if it is not in the bin
Response restore_scan(App& app, std::string_view id);

}  // namespace octurn
