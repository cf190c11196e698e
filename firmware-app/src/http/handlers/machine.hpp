#pragma once

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

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

}  // namespace octurn
