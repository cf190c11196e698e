#pragma once

#include <string_view>

#include "http/app.hpp"
#include "http/message.hpp"

namespace octurn {

// The keys of other programs.

Response list_keys(App& app);

/// Makes one, and tells it this once.
Response make_key(App& app, const Request& request);

/// From now on it counts no more.
Response revoke_key(App& app, std::string_view id);

}  // namespace octurn
