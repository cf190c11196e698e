#pragma once

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// What the page does with the machine itself.

/// Sets the clock of an appliance that no time server has set.
/// @throws Error "not-an-appliance", "bad-json", "bad-settings"  also where the clock is right
Response set_clock(App& app, const Request& request);

/// Restarts the appliance. @throws Error "not-an-appliance", "busy"
Response restart_machine(App& app);

/// Shuts the appliance down. @throws Error "not-an-appliance", "busy"
Response shut_machine_down(App& app);

/// The newest lines of the log, and errors that root has logged.
Response send_messages(App& app);

}  // namespace octurn
