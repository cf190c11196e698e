#pragma once

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// What `/api/v1/turntable` answers: moves without a scan.

/// What the turntable does, and what its last test has found.
Response send_turntable(App& app);

/// Jogs, tests or stops it, as the body says. 202.
/// @throws Error "bad-json", "bad-settings", "busy"
Response move_turntable(App& app, const Request& request);

}  // namespace octurn
