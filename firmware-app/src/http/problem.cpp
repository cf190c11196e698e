#include "http/problem.hpp"

#include <array>
#include <nlohmann/json.hpp>

namespace octurn {
namespace {

struct Kind {
  std::string_view code;  // or the beginning of several, if it ends in '-'
  int status;
  std::string_view title;
};

constexpr std::array kinds{
    Kind{"bad-request", 400, "The request is malformed"},
    Kind{"bad-json", 400, "The body is not what is expected here"},
    Kind{"bad-name", 400, "The name cannot be used"},
    Kind{"bad-settings", 400, "A setting is wrong"},
    Kind{"bad-wifi", 400, "The WiFi cannot be joined like this"},
    Kind{"cut-short", 400, "The request did not come whole"},
    Kind{"memory-limit", 400, "The model does not fit into the memory"},
    Kind{"wrong-origin", 403, "The request comes from another site"},
    Kind{"not-found", 404, "There is nothing here"},
    Kind{"no-such-scan", 404, "There is no such scan"},
    Kind{"not-an-appliance", 404, "This is no Octurn appliance"},
    Kind{"no-preview", 404, "There is nothing to show yet"},
    Kind{"model-empty", 404, "There is nothing to build"},
    Kind{"no-model", 404, "There is no finished model"},
    Kind{"wrong-method", 405, "That cannot be done with this"},
    Kind{"too-slow", 408, "The request came too slowly"},
    Kind{"busy", 409, "The scanner is busy"},
    Kind{"not-running", 409, "The scan is not running"},
    Kind{"not-paused", 409, "The scan cannot be resumed"},
    Kind{"length-required", 411, "The length is missing"},
    Kind{"changed", 412, "It is no longer what was asked for"},
    Kind{"too-large", 413, "The request is too large"},
    Kind{"wrong-content-type", 415, "The body is of the wrong type"},
    Kind{"bad-range", 416, "The file has no such part"},
    Kind{"wrong-host", 421, "The address is not this scanner's"},
    Kind{"too-many", 503, "Too many ask for this at once"},
    Kind{"disk-full", 503, "The disk is full"},
    Kind{"sensor-", 503, "The sensor does not work"},
    Kind{"turntable-", 503, "The turntable does not work"},
    Kind{"no-space", 507, "There is not enough room"},
};

Kind kind_of(std::string_view code) {
  for (const Kind& kind : kinds) {
    if (kind.code == code || (kind.code.ends_with('-') && code.starts_with(kind.code))) {
      return kind;
    }
  }
  return {code, 500, "Something went wrong inside the scanner"};
}

}  // namespace

Response problem(const Failure& failure) {
  const Kind kind = kind_of(failure.code);
  const nlohmann::json body{{"type", "about:blank"},    {"title", kind.title},
                            {"status", kind.status},    {"code", failure.code},
                            {"detail", failure.detail}, {"hint", failure.hint}};
  return {.status = kind.status,
          .headers = {{"Content-Type", "application/problem+json"}},
          .body = body.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n"};
}

}  // namespace octurn
