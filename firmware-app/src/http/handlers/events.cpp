#include "http/handlers/events.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "http/handlers/system.hpp"
#include "http/json_body.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr const char* retry_after = "30";  // seconds

}  // namespace

std::vector<News> StatusNews::operator()() {
  Sources now{.status = app_.scanner.latest_status(),
              .build = app_.scanner.build_run(),
              .cluster_builds = app_.scanner.slurm_runs(),
              .machine = app_.machine.health(),
              .scans_revision = app_.store.revision()};
  if (now == before_ && !now.status->is_scanning()) {  // a running scan's times always change
    return {};
  }
  before_ = std::move(now);
  const json status = status_json(app_);
  const json devices{{"sensor", status.at("sensor")}, {"turntable", status.at("turntable")}};
  return {{"devices", json_text(devices)},
          {"warnings", json_text({{"warnings", status.at("warnings")}})},
          {"scans", json_text({{"scans_revision", status.at("scans_revision")}})},
          {"status", json_text(status)}};
}

Response send_events(EventFeed& feed, const Request& request) {
  auto stream = feed.watch(request.header("Last-Event-ID").value_or(""));
  if (!stream) {
    Response refused = problem({.code = ErrorCode::too_many,
                                .detail = "others are watching already, as many as there may be",
                                .hint = "Ask GET /api/v1/status about once a second instead."});
    refused.headers.emplace_back("Retry-After", retry_after);
    return refused;
  }
  return {.headers = {{"Content-Type", "text/event-stream"},
                      {"Cache-Control", "no-store"},
                      {"X-Accel-Buffering", "no"}},  // of nginx, which would keep events back
          .body = std::move(*stream)};
}

}  // namespace octurn
