#include "http/handlers/scans.hpp"

#include <cmath>
#include <filesystem>
#include <future>
#include <nlohmann/json.hpp>
#include <optional>
#include <semaphore>
#include <string>
#include <system_error>

#include "http/file_response.hpp"
#include "http/handlers/appliance.hpp"
#include "http/handlers/models.hpp"
#include "http/json_body.hpp"
#include "http/place.hpp"
#include "http/scan_view.hpp"
#include "octurn/error.hpp"
#include "octurn/json_object.hpp"
#include "settings/field.hpp"
#include "store/job.hpp"
#include "store/scan_archive.hpp"
#include "store/scan_estimate.hpp"
#include "wall_clock.hpp"

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

std::string to_text(ScanTime time) {
  return utc_text(std::chrono::floor<std::chrono::seconds>(time), rfc3339);
}

/// Whether a scan in another pose is in the bin together with its first scan.
bool is_with_another(const ScanBin& bin, const Job& job) {
  return job.pose_of && bin.find(job.pose_of->scan);
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

Response send_bin(App& app) {
  json scans = json::array();
  for (const BinnedScan& scan : app.store.bin().list()) {
    const Job& job = scan.job;
    if (!is_with_another(app.store.bin(), job)) {
      scans.push_back({{"id", job.id},
                       {"name", job.label.name},
                       {"created", job.times.created},
                       {"state", to_string(job.state)},
                       {"snapshots_done", job.snapshots_done},
                       {"deleted", to_text(scan.deleted)},
                       {"kept_until", to_text(scan.deleted + days_in_bin)}});
    }
  }
  return json_response({{"scans", scans}});
}

Response empty_bin(App& app) {
  app.scanner.empty_bin();
  return {.status = 204};
}

Response restore_scan(App& app, std::string_view id) {
  app.scanner.restore(id);
  return json_response(to_json(app, find_scan(app, id)));
}

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t max_archive_bytes = std::uint64_t{1} << 30U;

// One archive is packed at a time, and no request waits for it: on a Pi that takes minutes, and
// each would occupy a thread of the server, where nobody cuts its connection.
std::counting_semaphore<> packing_places{1};

std::counting_semaphore<> import_places{2};  // uploads may take hours

/// A folder or file that is removed at the end of its scope.
class Scratch {
 public:
  explicit Scratch(fs::path path) : path_(std::move(path)) {}
  ~Scratch() {
    std::error_code ignored;  // the next start of the program removes leftovers
    fs::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

bool is_of_disk(ErrorCode code) {
  return code == ErrorCode::disk_full || code == ErrorCode::write_failed ||
         code == ErrorCode::data_failed;
}

}  // namespace

Response send_archive(App& app, const Request& request, std::string_view id) {
  const Job job = find_scan(app, id);
  if (job.state == JobState::running) {
    throw Error(ErrorCode::busy, "this scan is running", "Wait for its end.");
  }
  if (job.snapshots_done == 0) {
    throw Error(ErrorCode::no_model, "this scan has no snapshots", "Start a new scan.");
  }
  const Place place(&packing_places, "an archive is being packed for others");
  const std::string name = ".export-" + job.id + ".zip";
  const auto packed_in = [&](const fs::path& folder) {
    const Scratch archive(folder / name);
    std::async(std::launch::async, write_scan_archive, app.store.folder(id), archive.path()).get();
    return file_response(request, archive.path(), "application/zip",
                         download_name(job, ".zip"));  // its open descriptor outlives the removal
  };
  try {
    return packed_in(app.store.data() / "scans");
  } catch (const Error& error) {
    if (!is_of_disk(error.code())) {
      throw;
    }
  }
  // The disk is full or read-only, which is when somebody wants to save the scans.
  return packed_in(fs::temp_directory_path());
}

Response import_scan(App& app, const Request& request) {
  if (!request.upload.length) {
    throw Error(ErrorCode::length_required, "the scan comes without its length",
                "Send it with Content-Length, not in chunks.");
  }
  if (*request.upload.length > max_archive_bytes) {
    throw Error(ErrorCode::too_large, "a scan has at most 1 GiB", "Send a file scan.zip.");
  }
  const Place place(&import_places, "others are sending scans");
  const Job job = app.scanner.adopt({.bytes = *request.upload.length, .read = request.upload.read});
  Response response = json_response(to_json(app, find_scan(app, job.id)), 201);
  response.headers.emplace_back("Location", "/api/v1/scans/" + job.id);
  return response;
}

}  // namespace octurn
