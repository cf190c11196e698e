#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

#include "failure.hpp"
#include "http/message.hpp"
#include "octurn/json_object.hpp"

namespace octurn {

Response json_response(const nlohmann::json& body, int status = 200);

/// Serializes a JSON value on one line. Bytes that are not UTF-8 become U+FFFD.
std::string json_text(const nlohmann::json& value);

/// An answer whose body is that text and a newline.
Response json_text_response(std::string text, int status = 200);

/// Adds an entity tag to a 200 answer of JSON to GET or HEAD, or makes it 304 if the client has the
/// same JSON already. Returns any other answer unchanged.
Response tagged(const Request& request, Response response);

/// Parses the body of a request; an empty body is an empty object. @throws Error "bad-json"
nlohmann::json parse_body(const Request& request);

/// Reads the display name under the key "name" of a body.
/// @throws Error "bad-name" unless it is one line of at most 100 characters
std::string name_in(JsonObject& body);

/// An error that arises only in HTTP and has no ErrorCode.
struct HttpProblem {
  int status = 400;
  std::string_view title = {};
  std::string_view code = {};
  std::string_view detail = {};
  std::string_view hint = {};
  Parameters parameters = {};  ///< the values in `detail`
};

/// An HTTP problem as application/problem+json (RFC 9457).
Response to_response(const HttpProblem& problem);

/// An error as application/problem+json (RFC 9457). The status follows from the code; unknown codes
/// are 500.
Response problem(const Failure& failure);

}  // namespace octurn
