#pragma once

#include <string_view>

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// Access keys of programs, at `/api/v1/keys`.

Response list_keys(App& app);

/// Makes a key. Only this answer contains the key itself.
/// @throws Error "bad-json", "bad-name", "bad-settings", "disk-full", "write-failed"
Response make_key(App& app, const Request& request);

/// Revokes a key; it is invalid at once. @throws Error "not-found", "disk-full", "write-failed"
Response revoke_key(App& app, std::string_view id);

}  // namespace octurn
