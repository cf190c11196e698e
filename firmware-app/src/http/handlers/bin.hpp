#pragma once

#include <string_view>

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// Scans that were deleted: what `/api/v1/bin` answers.

/// What can be restored, what was deleted last first.
Response send_bin(App& app);

/// Removes all of it for good.
Response empty_bin(App& app);

/// Brings a scan back. @throws Error "no-such-scan"  if it is not in the bin
Response restore_scan(App& app, std::string_view id);

}  // namespace octurn
