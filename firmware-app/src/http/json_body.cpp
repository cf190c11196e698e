#include "http/json_body.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "http/entity_tags.hpp"
#include "octurn/json_object.hpp"
#include "store/scan_label.hpp"

namespace octurn {

using nlohmann::json;

std::string json_text(const json& value) {
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

Response json_text_response(std::string text, int status) {
  text += '\n';
  return {.status = status,
          .headers = {{"Content-Type", "application/json"}, {"Cache-Control", "private, no-cache"}},
          .body = std::move(text)};
}

Response json_response(const json& body, int status) {
  return json_text_response(json_text(body), status);
}

Response tagged(const Request& request, Response response) {
  const auto type =
      std::ranges::find(response.headers, "Content-Type", &Headers::value_type::first);
  const auto* const body = std::get_if<std::string>(&response.body);
  const bool has_tag =
      std::ranges::count(response.headers, "ETag", &Headers::value_type::first) > 0;
  if (!request.is_read() || response.status != 200 || body == nullptr || has_tag ||
      type == response.headers.end() || type->second != "application/json") {
    return response;
  }
  const std::string tag = to_entity_tag(*body);
  if (client_has(request, tag)) {
    response.status = 304;
    response.headers.erase(type);
    response.body = std::string();
  }
  response.headers.emplace_back("ETag", tag);
  return response;
}

std::string name_in(JsonObject& body) {
  const auto name = body.text("name");
  if (!name || !is_name(*name)) {
    throw Error(ErrorCode::bad_name, "\"name\" must be text of at most 100 characters on one line");
  }
  return *name;
}

json parse_body(const Request& request) {
  return request.body.empty() ? json::object()
                              : parse_json(request.body, ErrorCode::bad_json, "the body");
}

}  // namespace octurn
