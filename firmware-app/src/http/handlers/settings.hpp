#pragma once

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// What `/api/v1/settings` answers: the configuration, as far as the page may change it.

/// Settings in force, stored ones, what is allowed, and what waits for a restart.
Response send_settings(App& app);

/// Merges the body into the page's settings. What needs a restart of the daemon gets one by itself.
/// @throws Error "bad-json", "bad-settings", "disk-full"
Response change_settings(App& app, const Request& request);

/// The page's settings as a file.
Response send_backup(App& app);

/// Replaces the page's settings by those of a backup. @throws Error  as above
Response restore_backup(App& app, const Request& request);

/// Gives the page the password of the body, or takes the one away that the page has set.
/// @throws Error "bad-json", "bad-settings", "bad-password"
Response set_page_password(App& app, const Request& request);

}  // namespace octurn
