#include "http/handlers/appliance.hpp"

#include <algorithm>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <vector>

#include "http/json_body.hpp"
#include "log.hpp"
#include "process.hpp"
#include "version.hpp"

namespace octurn {
namespace {

using nlohmann::json;

constexpr std::size_t update_part_bytes = std::size_t{64} << 10U;  // of an update, read at a time

json to_json(const UpdateState& update) {
  return {{"version", version()},
          {"slot", update.slot},
          {"state", update.state},
          {"update_version", update.version},
          {"error", update.error}};
}

json to_json(const WifiState& wifi) {
  json networks = json::array();
  for (const WifiNetwork& network : wifi.networks) {
    networks.push_back(
        {{"name", network.name}, {"signal_dbm", network.signal_dbm}, {"secured", network.secured}});
  }
  return {{"state", wifi.state},     {"name", wifi.name},   {"country", wifi.country},
          {"hotspot", wifi.hotspot}, {"error", wifi.error}, {"networks", std::move(networks)},
          {"host", host_name()}};
}

/// Copies a body of known length into an upload.
/// @throws Error "cut-short", and those of `Upload::write`
void copy(const ByteSource& source, Appliance::Upload& upload) {
  std::vector<std::byte> buffer(update_part_bytes);
  std::uint64_t left = *source.length;
  while (left > 0) {
    const std::size_t most = std::min<std::uint64_t>(buffer.size(), left);
    const std::size_t got = source.read(std::span(buffer).first(most));
    if (got == 0) {
      throw Error(ErrorCode::cut_short,
                  std::to_string(*source.length - left) + " of " + std::to_string(*source.length) +
                      " bytes of the update have arrived",
                  "Send the file again.");
    }
    upload.write(std::span(buffer).first(got));
    left -= got;
  }
}

/// @throws Error "bad-settings"
UpdateAge to_update_age(const Headers& parameters) {
  UpdateAge age = UpdateAge::not_older;
  for (const auto& [name, text] : parameters) {
    if (name != "older" || text != "yes") {
      throw Error(ErrorCode::bad_settings, "the query has \"" + name + "\"", "It takes older=yes.");
    }
    age = UpdateAge::any;
  }
  return age;
}

}  // namespace

Appliance& expect_appliance(const App& app) {
  if (app.appliance == nullptr) {
    throw Error(
        ErrorCode::not_an_appliance,
        "updates, WiFi, clock and power are not Octurn's business on this machine",
        "They are on a Raspberry Pi with the image of image-build; here they are the system's.");
  }
  return *app.appliance;
}

void expect_no_update(const App& app) {
  if (app.appliance != nullptr && app.appliance->is_updating()) {
    throw Error(ErrorCode::busy, "an update is being installed", "Wait for its end.");
  }
}

Response send_update_state(App& app) {
  return json_response(to_json(expect_appliance(app).update()));
}

Response take_update(App& app, const Request& request) {
  const auto expect_no_scan = [&app] {
    if (app.scanner.is_busy()) {
      throw Error(ErrorCode::busy, "a scan is running, or the sensor's pose is measured",
                  "Wait for its end, or cancel it.");
    }
  };
  Appliance& machine = expect_appliance(app);
  const UpdateAge age = to_update_age(request.parameters);
  if (!request.upload.length) {
    throw Error(ErrorCode::length_required, "the update comes without its length",
                "Send it with Content-Length, not in chunks.");
  }
  expect_no_scan();
  {
    Appliance::Upload upload(machine, *request.upload.length, age);
    copy(request.upload, upload);
    expect_no_scan();  // one may have started meanwhile
    upload.commit();
  }
  log::info("appliance",
            "an update of " + std::to_string(*request.upload.length) + " bytes is to be installed");
  return json_response(to_json(machine.update()), 202);
}

Response send_machine(App& app) {
  const MachineState machine = expect_appliance(app).machine();
  return json_response(
      {{"name", machine.name}, {"time_zone", machine.time_zone}, {"error", machine.error}});
}

Response change_machine(App& app, const Request& request) {
  expect_appliance(app).ask_for_machine(machine_request_from(parse_body(request)));
  log::info("appliance", "another name or time zone is asked for");
  Response response = send_machine(app);
  response.status = 202;
  return response;
}

Response send_wifi_state(App& app) { return json_response(to_json(expect_appliance(app).wifi())); }

Response join_wifi(App& app, const Request& request) {
  Appliance& machine = expect_appliance(app);
  const WifiRequest wanted = wifi_request_from(parse_body(request));
  machine.ask_for_wifi(wanted);
  log::info("appliance", "a WiFi is to be joined");
  return json_response(to_json(machine.wifi()), 202);
}

}  // namespace octurn
