#include "http/handlers/machine.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "http/handlers/appliance.hpp"
#include "http/json_body.hpp"
#include "log.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr std::size_t max_lines = 200;

/// The last `max_lines` lines of a text.
json last_lines(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  const std::size_t skipped = lines.size() - std::min(lines.size(), max_lines);
  return std::vector(lines.begin() + static_cast<std::ptrdiff_t>(skipped), lines.end());
}

/// Whether the machine's health checks warn about the clock, so that it may be set.
bool is_clock_doubtful(const App& app) {
  const auto health = app.machine.health();
  return std::ranges::count(health->warnings, "clock", &Finding::check) > 0;
}

Response end_machine(App& app, PowerEnd end) {
  Appliance& machine = expect_appliance(app);
  expect_no_update(app);
  if (app.scanner.is_busy()) {
    throw Error(ErrorCode::busy, "a scan is running, a model is built, or the pose is measured",
                "Pause the scan, or wait for the end.");
  }
  machine.ask_for_control(end);
  log::info("appliance", end == PowerEnd::restart ? "the page asks for a restart"
                                                  : "the page asks to shut down");
  return json_response(json::object(), 202);
}

}  // namespace

Response set_clock(App& app, const Request& request) {
  Appliance& machine = expect_appliance(app);
  const auto time = clock_from(parse_body(request));
  if (!is_clock_doubtful(app)) {
    throw Error(ErrorCode::bad_settings, "the clock is right: a time server has set it",
                "There is nothing to do.");
  }
  machine.ask_for_control(time);
  log::info("appliance", "the page sets the clock");
  return json_response(json::object(), 202);
}

Response restart_machine(App& app) { return end_machine(app, PowerEnd::restart); }

Response shut_machine_down(App& app) { return end_machine(app, PowerEnd::off); }

Response send_messages(App& app) {
  return json_response(
      {{"log", last_lines(log::recent())},
       {"errors", last_lines(app.appliance != nullptr ? app.appliance->errors() : "")}});
}

}  // namespace octurn
