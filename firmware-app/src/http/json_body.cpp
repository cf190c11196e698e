#include "http/json_body.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>

#include "http/file_response.hpp"
#include "store/job.hpp"
#include "store/job_json.hpp"

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

namespace {

/// The HTTP status and title of an error code.
struct ProblemType {
  ErrorCode code;
  int status;
  std::string_view title;
};

constexpr std::array problem_types{
    ProblemType{ErrorCode::bad_request, 400, "The request is malformed"},
    ProblemType{ErrorCode::bad_json, 400, "The body is not what is expected here"},
    ProblemType{ErrorCode::bad_name, 400, "The name cannot be used"},
    ProblemType{ErrorCode::bad_password, 400, "The password cannot be used"},
    ProblemType{ErrorCode::bad_settings, 400, "A setting is wrong"},
    ProblemType{ErrorCode::bad_wifi, 400, "The WiFi cannot be joined like this"},
    ProblemType{ErrorCode::cut_short, 400, "The request did not come whole"},
    ProblemType{ErrorCode::memory_limit, 400, "The model does not fit into the memory"},
    ProblemType{ErrorCode::password_needed, 401, "The page has a password"},
    ProblemType{ErrorCode::wrong_origin, 403, "The request comes from another site"},
    ProblemType{ErrorCode::not_found, 404, "There is nothing here"},
    ProblemType{ErrorCode::no_such_scan, 404, "There is no such scan"},
    ProblemType{ErrorCode::scan_missing, 404, "There is no such scan"},  // deleted meanwhile
    ProblemType{ErrorCode::not_an_appliance, 404, "This is no Octurn appliance"},
    ProblemType{ErrorCode::no_preview, 404, "There is nothing to show yet"},
    ProblemType{ErrorCode::model_empty, 404, "There is nothing to build"},
    ProblemType{ErrorCode::no_model, 404, "There is no finished model"},
    ProblemType{ErrorCode::wrong_method, 405, "That cannot be done with this"},
    ProblemType{ErrorCode::too_slow, 408, "The request came too slowly"},
    ProblemType{ErrorCode::busy, 409, "The scanner is busy"},
    ProblemType{ErrorCode::not_running, 409, "It is not running"},
    ProblemType{ErrorCode::not_paused, 409, "The scan cannot be resumed"},
    ProblemType{ErrorCode::length_required, 411, "The length is missing"},
    ProblemType{ErrorCode::changed, 412, "The file has changed in the meantime"},
    ProblemType{ErrorCode::too_large, 413, "The request is too large"},
    ProblemType{ErrorCode::wrong_content_type, 415, "The body is of the wrong type"},
    ProblemType{ErrorCode::bad_range, 416, "The file has no such part"},
    ProblemType{ErrorCode::wrong_host, 421, "The address is not this scanner's"},
    ProblemType{ErrorCode::too_many_guesses, 429, "Too many wrong passwords"},
    ProblemType{ErrorCode::too_many, 503, "Too many ask for this at once"},
    ProblemType{ErrorCode::disk_full, 503, "The disk is full"},
    ProblemType{ErrorCode::no_space, 507, "There is not enough room"},
};

ProblemType find_problem_type(const Failure& failure) {
  switch (failure.device()) {
    case Device::sensor:
      return {failure.code, 503, "The sensor does not work"};
    case Device::turntable:
      return {failure.code, 503, "The turntable does not work"};
    case Device::none:
      break;
  }
  const auto* const found = std::ranges::find(problem_types, failure.code, &ProblemType::code);
  return found == problem_types.end()
             ? ProblemType{failure.code, 500, "Something went wrong inside the scanner"}
             : *found;
}

}  // namespace

Response problem(const Failure& failure) {
  const ProblemType type = find_problem_type(failure);
  return to_response({.status = type.status,
                      .title = type.title,
                      .code = to_string(failure.code),
                      .detail = failure.detail,
                      .hint = failure.hint,
                      .parameters = failure.parameters});
}

Response to_response(const HttpProblem& problem) {
  const nlohmann::json body{{"type", "about:blank"},
                            {"title", problem.title},
                            {"status", problem.status},
                            {"code", problem.code},
                            {"detail", problem.detail},
                            {"hint", problem.hint},
                            {"parameters", to_json(problem.parameters)}};
  return {.status = problem.status,
          .headers = {{"Content-Type", "application/problem+json"}},
          .body = json_text(body) + "\n"};
}

}  // namespace octurn
