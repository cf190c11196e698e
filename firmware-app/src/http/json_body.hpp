#pragma once

#include <nlohmann/json_fwd.hpp>

#include "http/message.hpp"

namespace octurn {

Response json_response(const nlohmann::json& body, int status = 200);

/// What a request says; no body is an empty object. @throws Error "bad-json"
nlohmann::json body_of(const Request& request);

}  // namespace octurn
