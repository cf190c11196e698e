#include "appliance/control_request.hpp"

#include <nlohmann/json.hpp>

#include "octurn/json_object.hpp"

namespace octurn {
namespace {

using std::chrono::sys_seconds;

// A client whose time is outside this range has no valid clock either.
constexpr sys_seconds earliest = std::chrono::sys_days(std::chrono::year(2026) / 1 / 1);
constexpr sys_seconds latest = std::chrono::sys_days(std::chrono::year(2100) / 1 / 1);

double to_number(sys_seconds time) { return static_cast<double>(time.time_since_epoch().count()); }

}  // namespace

sys_seconds clock_from(const nlohmann::json& body) {
  JsonObject keys(body, ErrorCode::bad_settings, "");
  const double seconds_since_1970 =
      keys.at("unix_s").number(to_number(earliest), to_number(latest));
  keys.refuse_unread();
  return sys_seconds(
      std::chrono::seconds(static_cast<std::chrono::seconds::rep>(seconds_since_1970)));
}

std::string to_text(const ControlRequest& request) {
  if (const auto* time = std::get_if<sys_seconds>(&request)) {
    return "clock " + std::to_string(time->time_since_epoch().count()) + "\n";
  }
  return std::get<PowerEnd>(request) == PowerEnd::restart ? "restart\n" : "off\n";
}

}  // namespace octurn
