#pragma once

#include <nlohmann/json_fwd.hpp>

#include "http/message.hpp"

namespace octurn {

Response json_response(const nlohmann::json& body, int status = 200);

/// The body of a request, parsed; no body is an empty object. @throws Error "bad-json"
nlohmann::json parse_body(const Request& request);

}  // namespace octurn
