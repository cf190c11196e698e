#pragma once

#include <optional>
#include <string_view>

#include "http/access_keys.hpp"
#include "http/message.hpp"

namespace octurn {

/// The key that a request is sent with, as `Authorization: Bearer KEY`; nothing without one.
std::optional<std::string_view> key_in(const Request& request);

/// The refusal of a request with a key: 401 if the key is invalid, 403 if its rights are not
/// enough. Nothing if the request is admitted. Keys are checked even if the page has no password.
std::optional<Response> refuse_key(const AccessKeys& keys, const Request& request,
                                   std::string_view key);

}  // namespace octurn
