#include "http/json_body.hpp"

#include <nlohmann/json.hpp>

#include "octurn/json_object.hpp"

namespace octurn {

using nlohmann::json;

Response json_response(const json& body, int status) {
  return {.status = status,
          .headers = {{"Content-Type", "application/json"}, {"Cache-Control", "no-store"}},
          .body = body.dump(-1, ' ', false, json::error_handler_t::replace) + "\n"};
}

json parse_body(const Request& request) {
  return request.body.empty() ? json::object()
                              : parse_json(request.body, ErrorCode::bad_json, "the body");
}

}  // namespace octurn
