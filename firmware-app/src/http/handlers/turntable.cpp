#include "http/handlers/turntable.hpp"

#include <array>
#include <nlohmann/json.hpp>
#include <string_view>

#include "http/handlers/appliance.hpp"
#include "http/json_body.hpp"
#include "octurn/json_object.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr double max_jog_deg = 360;

json to_json(const std::optional<Failure>& failure) {
  return failure ? json{{"code", to_string(failure->code)},
                        {"detail", failure->detail},
                        {"hint", failure->hint}}
                 : json(nullptr);
}

json to_json(const TurnFinding& turn) {
  return {{"check", turn.finding.check},
          {"name", turn.finding.name},
          {"state", to_string(turn.finding.state)},
          {"measured", turn.finding.measured},
          {"advice", turn.finding.advice},
          {"set", turn.set}};
}

json to_json(const TurnTest& test) {
  constexpr std::array<std::string_view, 4> states{"running", "done", "failed", "cancelled"};
  json findings = json::array();
  for (const TurnFinding& finding : test.findings) {
    findings.push_back(to_json(finding));
  }
  return {{"state", states.at(static_cast<std::size_t>(test.state))},
          {"done", test.done},
          {"findings", std::move(findings)},
          {"error", to_json(test.failure)}};
}

json to_json(const TurntableState& state) {
  constexpr std::array<std::string_view, 3> names{"idle", "jogging", "testing"};
  return {{"state", names.at(static_cast<std::size_t>(state.doing))},
          {"error", to_json(state.failure)},
          {"test", state.test ? to_json(*state.test) : json(nullptr)}};
}

/// Whether a flag is given. @throws Error "bad-settings"  if it is given, and is not true
bool is_asked(JsonObject& keys, std::string_view key) {
  const auto value = keys.value(key);
  if (value && value->json() != true) {
    value->refuse("true");
  }
  return value.has_value();
}

}  // namespace

Response send_turntable(App& app) { return json_response(to_json(app.turntable.state())); }

Response move_turntable(App& app, const Request& request) {
  const json body = parse_body(request);
  JsonObject keys(body, ErrorCode::bad_settings, "");
  const auto jog_deg = keys.number("jog_deg", -max_jog_deg, max_jog_deg);
  const bool test = is_asked(keys, "test");
  const bool stop = is_asked(keys, "stop");
  keys.refuse_unread();
  if (body.size() != 1) {
    throw Error(ErrorCode::bad_settings, "the body must have one of jog_deg, test and stop");
  }
  expect_no_update(app);
  if (stop) {
    app.turntable.stop();
  } else if (!(test ? app.turntable.test(app.doctor_input().config)
                    : app.turntable.jog(*jog_deg))) {
    throw Error(ErrorCode::busy, "the turntable is moving, or a scan has it", "Wait for its end.");
  }
  return json_response(to_json(app.turntable.state()), 202);
}

}  // namespace octurn
