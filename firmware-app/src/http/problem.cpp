#include "http/problem.hpp"

#include <array>
#include <nlohmann/json.hpp>

namespace octurn {
namespace {

/// What a code of an error means in HTTP.
struct ProblemType {
  std::string_view code;  // a prefix of several codes where it ends in '-'
  int status;
  std::string_view title;
};

constexpr std::array problem_types{
    ProblemType{"bad-request", 400, "The request is malformed"},
    ProblemType{"bad-json", 400, "The body is not what is expected here"},
    ProblemType{"bad-name", 400, "The name cannot be used"},
    ProblemType{"bad-settings", 400, "A setting is wrong"},
    ProblemType{"bad-wifi", 400, "The WiFi cannot be joined like this"},
    ProblemType{"cut-short", 400, "The request did not come whole"},
    ProblemType{"memory-limit", 400, "The model does not fit into the memory"},
    ProblemType{"wrong-origin", 403, "The request comes from another site"},
    ProblemType{"not-found", 404, "There is nothing here"},
    ProblemType{"no-such-scan", 404, "There is no such scan"},
    ProblemType{"not-an-appliance", 404, "This is no Octurn appliance"},
    ProblemType{"no-preview", 404, "There is nothing to show yet"},
    ProblemType{"model-empty", 404, "There is nothing to build"},
    ProblemType{"no-model", 404, "There is no finished model"},
    ProblemType{"wrong-method", 405, "That cannot be done with this"},
    ProblemType{"too-slow", 408, "The request came too slowly"},
    ProblemType{"busy", 409, "The scanner is busy"},
    ProblemType{"not-running", 409, "The scan is not running"},
    ProblemType{"not-paused", 409, "The scan cannot be resumed"},
    ProblemType{"length-required", 411, "The length is missing"},
    ProblemType{"changed", 412, "It is no longer what was asked for"},
    ProblemType{"too-large", 413, "The request is too large"},
    ProblemType{"wrong-content-type", 415, "The body is of the wrong type"},
    ProblemType{"bad-range", 416, "The file has no such part"},
    ProblemType{"wrong-host", 421, "The address is not this scanner's"},
    ProblemType{"too-many", 503, "Too many ask for this at once"},
    ProblemType{"disk-full", 503, "The disk is full"},
    ProblemType{"sensor-", 503, "The sensor does not work"},
    ProblemType{"turntable-", 503, "The turntable does not work"},
    ProblemType{"no-space", 507, "There is not enough room"},
};

ProblemType find_problem_type(std::string_view code) {
  for (const ProblemType& type : problem_types) {
    if (type.code == code || (type.code.ends_with('-') && code.starts_with(type.code))) {
      return type;
    }
  }
  return {code, 500, "Something went wrong inside the scanner"};
}

}  // namespace

Response problem(const Failure& failure) {
  const ProblemType type = find_problem_type(failure.code);
  const nlohmann::json body{{"type", "about:blank"},    {"title", type.title},
                            {"status", type.status},    {"code", failure.code},
                            {"detail", failure.detail}, {"hint", failure.hint}};
  return {.status = type.status,
          .headers = {{"Content-Type", "application/problem+json"}},
          .body = body.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n"};
}

}  // namespace octurn
