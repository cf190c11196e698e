#pragma once

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// Moves of the turntable outside of scans, at `/api/v1/turntable`.

/// Sends the turntable's state, and the findings of its last test.
Response send_turntable(App& app);

/// Jogs, tests or stops the turntable, as the body says. Answers 202.
/// @throws Error "bad-json", "bad-settings", "busy"
Response move_turntable(App& app, const Request& request);

}  // namespace octurn
