#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "http/message.hpp"
#include "octurn/json_object.hpp"

namespace octurn {

Response json_response(const nlohmann::json& body, int status = 200);

/// A JSON value as answers have it; a byte that is not UTF-8 is replaced.
std::string json_text(const nlohmann::json& value);

/// An answer whose body is that text.
Response json_text_response(std::string text, int status = 200);

/// An answer to a GET with the entity tag of its JSON, or 304 without it where the client has that
/// already; any other answer as it is.
Response tagged(const Request& request, Response response);

/// The body of a request, parsed; no body is an empty object. @throws Error "bad-json"
nlohmann::json parse_body(const Request& request);

/// The key "name" of a body, for people. @throws Error "bad-name" unless it is one line of at most
/// 100 characters
std::string name_in(JsonObject& body);

}  // namespace octurn
