#pragma once

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// Updates of Octurn's image, its host name, time zone and WiFi. Each handler throws Error
// "not-an-appliance" on a machine that does not run that image.

/// @throws Error "not-an-appliance"
Appliance& expect_appliance(const App& app);

/// @throws Error "busy"  during an update, which may restart this machine at any moment
void expect_no_update(const App& app);

Response send_update_state(App& app);

/// Receives an update of the image, for root to install. Answers 202.
/// @throws Error "busy", "bad-settings", "length-required", "cut-short", "too-large", "no-space"
Response take_update(App& app, const Request& request);

/// Sends the machine's name and time zone.
Response send_machine(App& app);

/// Asks root to set the name or the time zone of the body. Answers 202.
/// @throws Error "bad-json", "bad-settings"
Response change_machine(App& app, const Request& request);

Response send_wifi_state(App& app);

/// Asks root to join the network of the body. Answers 202. @throws Error "bad-json", "bad-wifi"
Response join_wifi(App& app, const Request& request);

}  // namespace octurn
