#pragma once

#include <optional>
#include <string_view>

#include "http/access_keys.hpp"
#include "http/message.hpp"

namespace octurn {

/// The key that a request is sent with, as `Authorization: Bearer KEY`; nothing without one.
std::optional<std::string_view> key_in(const Request& request);

/// Why a request with a key is refused: 401 if it is none, 403 if it does not allow that. Nothing
/// if it is let in. A key that is sent counts also where the page has no password.
std::optional<Response> refuse_key(const AccessKeys& keys, const Request& request,
                                   std::string_view key);

}  // namespace octurn
