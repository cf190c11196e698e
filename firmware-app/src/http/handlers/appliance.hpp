#pragma once

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// What the appliance answers: updates, its name and WiFi. Each handler throws Error
// "not-an-appliance" where the system of the machine is somebody else's business.

/// @throws Error "not-an-appliance"
Appliance& expect_appliance(const App& app);

/// @throws Error "busy"  if this machine may start again at any moment
void expect_no_update(const App& app);

Response send_update_state(App& app);

/// Takes an update as it is uploaded, to be installed.
/// @throws Error "busy", "length-required", "cut-short", "no-space"
Response take_update(App& app, const Request& request);

/// What this machine is called, and its time zone.
Response send_machine(App& app);

/// Gives it the name and the time zone of the body. @throws Error "bad-json", "bad-settings"
Response change_machine(App& app, const Request& request);

Response send_wifi_state(App& app);

/// Joins the network of the body. @throws Error "bad-json", "bad-wifi"
Response join_wifi(App& app, const Request& request);

}  // namespace octurn
