#pragma once

#include <string_view>

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// Settings that the page can change, at `/api/v1/settings`.

/// Sends the settings in force, the stored ones, their schema, and the keys that need a restart.
Response send_settings(App& app);

/// Merges the body into the page's settings. The daemon restarts itself for keys that need it.
/// @throws Error "bad-json", "bad-settings", "disk-full"
Response change_settings(App& app, const Request& request);

/// Sends the page's settings as a file.
Response send_backup(App& app);

/// Replaces the page's settings with those of a backup. @throws Error  as `change_settings`
Response restore_backup(App& app, const Request& request);

/// Sets the page's password; null removes the one that the page has set.
/// @throws Error "bad-json", "bad-settings", "bad-password"
Response set_page_password(App& app, const Request& request);

// Access keys of programs, at `/api/v1/keys`.

Response list_keys(App& app);

/// Makes a key. Only this answer contains the key itself.
/// @throws Error "bad-json", "bad-name", "bad-settings", "disk-full", "write-failed"
Response make_key(App& app, const Request& request);

/// Revokes a key; it is invalid at once. @throws Error "not-found", "disk-full", "write-failed"
Response revoke_key(App& app, std::string_view id);

}  // namespace octurn
