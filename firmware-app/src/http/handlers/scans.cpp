#include "http/handlers/scans.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "http/handlers/appliance.hpp"
#include "http/json_body.hpp"
#include "http/scan_view.hpp"
#include "octurn/json_object.hpp"
#include "settings/field.hpp"
#include "store/earlier_scans.hpp"
#include "store/scan_label.hpp"

namespace octurn {
namespace {

using nlohmann::json;

[[noreturn]] void throw_busy() {
  throw Error(ErrorCode::busy, "a scan is running, or the sensor's pose is measured",
              "Wait for its end, or cancel it.");
}

/// Removes the places of a model's quality reasons: in a list of thousands of scans they would be
/// most of the bytes.
void drop_places(json& model) {
  if (model.is_null() || model["quality"].is_null()) {
    return;
  }
  for (json& reason : model["quality"]["reasons"]) {
    reason.erase("places_mm");
  }
}

}  // namespace

Response list_scans(App& app) {
  // Serialized scan by scan: one JSON document of thousands of scans takes ten times the memory.
  std::string list;
  for_each_scan(app, [&](json scan) {
    drop_places(scan["model"]);
    list += (list.empty() ? "" : ",") + json_text(scan);
  });
  return json_text_response("{\"scans\":[" + list + "]}");
}

Response start_scan(App& app, const Request& request) {
  const ScanSettings settings = settings_from(
      parse_body(request), app.scanner.calibration().in_force(app.settings.config().scan));
  expect_no_update(app);
  app.scanner.expect_ready();
  const std::optional<Job> job = app.scanner.start(settings);
  if (!job) {
    throw_busy();
  }
  Response response = json_response(to_json(app, *job), 202);
  response.headers.emplace_back("Location", "/api/v1/scans/" + job->id);
  return response;
}

Response send_scan(App& app, std::string_view id) {
  return json_response(to_json(app, find_scan(app, id)));
}

Response label_scan(App& app, const Request& request, std::string_view id) {
  const json body = parse_body(request);
  JsonObject keys(body, ErrorCode::bad_name, "");
  LabelChange change{.notes = keys.text("notes")};
  if (change.notes && !is_notes(*change.notes)) {
    throw Error(ErrorCode::bad_name, "\"notes\" must be text of at most 2000 characters");
  }
  if (body.contains("name")) {
    change.name = name_in(keys);
  }
  if (!change.name && !change.notes) {
    throw Error(ErrorCode::bad_name, "the body has neither \"name\" nor \"notes\"");
  }
  keys.refuse_unread();
  app.scanner.label(id, change);
  return send_scan(app, id);
}

Response remove_scan(App& app, std::string_view id) {
  app.scanner.remove(id);
  return {.status = 204};
}

Response cancel_scan(App& app, std::string_view id) {
  const Job job = find_scan(app, id);
  if (!app.scanner.cancel(id)) {
    throw Error(ErrorCode::not_running, "this scan is " + std::string(to_string(job.state)),
                "Only a scan that runs, or could be resumed, can be cancelled.");
  }
  return json_response(to_json(app, find_scan(app, id)), 202);
}

Response pause_scan(App& app, std::string_view id) {
  const Job job = find_scan(app, id);
  if (!app.scanner.pause(id)) {
    throw Error(ErrorCode::not_running, "this scan is " + std::string(to_string(job.state)),
                "Only a scan that runs can be paused.");
  }
  return json_response(to_json(app, find_scan(app, id)), 202);
}

Response send_estimate(App& app, const Request& request) {
  const ScanSettings settings = settings_from(
      parse_body(request), app.scanner.calibration().in_force(app.settings.config().scan));
  const ScanEstimate estimate = estimate_scan(earlier_scans(app.store), settings);
  json body{{"seconds", std::round(estimate.total(settings.snapshots).count())},
            {"bytes", estimate.bytes},
            {"measured", estimate.is_measured}};
  if (settings.method == Method::solid) {
    const MemoryNeed need =
        expected_memory(reconstruct_options(settings, app.settings.config().limits));
    body["memory_bytes"] = need.bytes;
    body["fitting_leaf_size_mm"] = rounded_mm(need.fitting_leaf_size);
  }
  return json_response(body);
}

Response resume_scan(App& app, std::string_view id) {
  const Job job = find_scan(app, id);
  expect_no_update(app);
  if (app.scanner.can_resume(job) && job.snapshots_done < job.settings.snapshots) {
    app.scanner.expect_ready();
  }
  if (job.state == JobState::running || !app.scanner.resume(id)) {
    throw_busy();
  }
  return json_response(to_json(app, find_scan(app, id)), 202);
}

}  // namespace octurn
