#include "http/handlers/scans.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <future>
#include <initializer_list>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <semaphore>
#include <set>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "http/file_response.hpp"
#include "http/handlers/appliance.hpp"
#include "http/handlers/models.hpp"
#include "http/json_body.hpp"
#include "http/place.hpp"
#include "http/scan_json.hpp"
#include "http/scan_view.hpp"
#include "mesh/mesh_formats.hpp"
#include "octurn/error.hpp"
#include "octurn/json_object.hpp"
#include "settings/field.hpp"
#include "store/data_folder.hpp"
#include "store/job.hpp"
#include "store/scan_archive.hpp"
#include "store/scan_estimate.hpp"
#include "wall_clock.hpp"
#include "zip_file.hpp"

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

/// The text of a label's JSON, a list as lines; nothing if it is something else.
std::optional<std::string> written_in(const json& value, const LabelText& text) {
  if (!text.is_list) {
    return value.is_string() ? std::optional(value.get<std::string>()) : std::nullopt;
  }
  if (!value.is_array()) {
    return std::nullopt;
  }
  std::string lines;
  for (const json& line : value) {
    if (!line.is_string() || line.get<std::string>().find('\n') != std::string::npos) {
      return std::nullopt;
    }
    lines += line.get<std::string>() + '\n';
  }
  return lines;
}

/// Takes the label's keys out of a body. @throws Error "bad-name"
LabelChange take_label(json& body) {
  LabelChange label;
  for (const LabelText& text : label_texts()) {
    const auto found = body.find(std::string(text.key));  // the end if the body is no object
    if (found == body.end()) {
      continue;
    }
    const std::optional<std::string> written = written_in(*found, text);
    if (!written || !text.is_valid(*written)) {
      throw Error(ErrorCode::bad_name,
                  '"' + std::string(text.key) + "\" must be " + std::string(text.rule));
    }
    label.*text.change = written;
    body.erase(found);
  }
  return label;
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
  json body = parse_body(request);
  const LabelChange label = take_label(body);
  const ScanSettings settings =
      settings_from(body, app.scanner.calibration().in_force(app.settings.config().scan));
  expect_no_update(app);
  app.scanner.expect_ready();
  const std::optional<Job> job = app.scanner.start(settings, label);
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
  json body = parse_body(request);
  if (body.empty()) {
    std::string keys;
    for (const LabelText& text : label_texts()) {
      keys.append(keys.empty() ? "\"" : ", \"").append(text.key).append("\"");
    }
    throw Error(ErrorCode::bad_name, "the body has none of " + keys);
  }
  const LabelChange change = take_label(body);
  JsonObject(body, ErrorCode::bad_name, "").refuse_unread();
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

namespace {

constexpr std::uint64_t max_collection_bytes = std::uint64_t{1} << 29U;

/// The chosen scans, oldest first: those of the parameter `ids`, or all but other poses.
/// @throws Error "bad-settings", "no-such-scan"
std::vector<Job> chosen_scans(const App& app, std::optional<std::string> ids) {
  std::vector<Job> jobs;
  if (!ids) {
    jobs = all_scans(app);
    std::erase_if(jobs, [](const Job& job) { return job.pose_of.has_value(); });
  }
  std::istringstream list(ids.value_or(""));
  for (std::string id; std::getline(list, id, ',');) {
    jobs.push_back(find_scan(app, id));
  }
  std::ranges::sort(jobs, {}, &Job::id);
  const auto is_same = [](const Job& one, const Job& other) { return one.id == other.id; };
  jobs.erase(std::unique(jobs.begin(), jobs.end(), is_same), jobs.end());
  return jobs;
}

/// The parameters of a query. @throws Error "bad-settings"  if it has one that is not among `keys`
std::map<std::string, std::string> parameters_of(const Request& request,
                                                 std::initializer_list<std::string_view> keys) {
  std::map<std::string, std::string> parameters;
  for (const auto& [name, value] : request.parameters) {
    if (std::ranges::find(keys, name) == keys.end() || !parameters.emplace(name, value).second) {
      throw Error(ErrorCode::bad_settings, "the query has \"" + name + "\"",
                  "It takes ids, once, and for scans.zip also format.");
    }
  }
  return parameters;
}

std::optional<std::string> value_of(const std::map<std::string, std::string>& parameters,
                                    const std::string& key) {
  const auto found = parameters.find(key);
  return found == parameters.end() ? std::nullopt : std::optional(found->second);
}

/// The columns of a table of scans, and where their values are in a scan's JSON.
constexpr std::array columns{
    std::pair{"id", "/id"},
    std::pair{"name", "/name"},
    std::pair{"inventory_number", "/inventory_number"},
    std::pair{"tags", "/tags"},
    std::pair{"author", "/author"},
    std::pair{"licence", "/licence"},
    std::pair{"notes", "/notes"},
    std::pair{"created", "/created"},
    std::pair{"state", "/state"},
    std::pair{"snapshots", "/snapshots_done"},
    std::pair{"method", "/settings/method"},
    std::pair{"leaf_size_mm", "/settings/leaf_size_mm"},
    std::pair{"x_mm", "/model/size_mm/0"},
    std::pair{"y_mm", "/model/size_mm/1"},
    std::pair{"z_mm", "/model/size_mm/2"},
    std::pair{"volume_cm3", "/model/volume_cm3"},
    std::pair{"triangles", "/model/triangles"},
    std::pair{"watertight", "/model/watertight"},
    std::pair{"verdict", "/model/quality/verdict"},
    std::pair{"file", "/file"},
};

/// A field of RFC 4180. A text that spreadsheets would take for a formula begins with an
/// apostrophe.
std::string csv_text(std::string text) {
  if (!text.empty() && std::string_view("=+-@\t").find(text.front()) != std::string_view::npos) {
    text.insert(text.begin(), '\'');
  }
  std::string quoted = "\"";
  for (const char c : text) {
    quoted.append(c == '"' ? 2 : 1, c);
  }
  return quoted + '"';
}

std::string csv_field(const json& value) {
  if (value.is_null()) {
    return "";
  }
  if (!value.is_array()) {
    return value.is_string() ? csv_text(value.get<std::string>()) : value.dump();
  }
  std::string all;
  for (const json& one : value) {
    all += (all.empty() ? "" : ", ") + one.get<std::string>();
  }
  return csv_text(all);
}

/// A table of scans (RFC 4180), with the mark that has spreadsheets read it as UTF-8.
/// @param files  of the scans' models, in their order; empty: none
std::string to_csv(const std::vector<Job>& jobs, const std::vector<std::string>& files = {}) {
  std::string csv = "\xEF\xBB\xBF";
  for (const auto& [name, place] : columns) {
    csv.append(csv.back() == '\xBF' ? "" : ",").append(name);
  }
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    json scan = to_json(jobs[i]);
    scan["file"] = i < files.size() ? files[i] : "";
    csv += "\r\n";
    for (const auto& [name, place] : columns) {
      const json::json_pointer pointer(place);
      csv += (csv.back() == '\n' ? "" : ",");
      csv += csv_field(scan.contains(pointer) ? scan[pointer] : json());
    }
  }
  return csv + "\r\n";
}

/// The name of a model's file in an archive, different from all before it, on every system.
/// @param used  in lower case; gets the new one
std::string file_name(const Job& job, const std::string& extension, std::set<std::string>& used) {
  std::string stem = job.label.name.empty() ? "Scan-" + job.id : job.label.name;
  std::ranges::replace_if(
      stem,
      [](char c) { return std::string_view("/\\:*?\"<>|").find(c) != std::string_view::npos; },
      '_');
  const auto folded = [](std::string name) {
    std::ranges::transform(name, name.begin(), [](char c) {
      return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
    });
    return name;
  };
  std::string name = stem + extension;
  for (int number = 2; !used.insert(folded(name)).second; ++number) {
    name = stem + " (" + std::to_string(number) + ")" + extension;
  }
  return name;
}

/// @throws Error "read-failed", "disk-full"
void copy_to(ZipWriter& zip, const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<char> part(std::size_t{64} << 10U);
  while (file.read(part.data(), static_cast<std::streamsize>(part.size())) || file.gcount() > 0) {
    zip.write({part.data(), static_cast<std::size_t>(file.gcount())});
  }
  if (!file.eof()) {
    throw Error(ErrorCode::read_failed, path.string() + ": cannot be read");
  }
}

/// Writes the models and their table to an archive. Runs on a thread of its own, whose stack is
/// large enough.
/// @param models  of the scans; empty: it has none
void write_collection(const std::vector<Job>& jobs, const std::vector<fs::path>& models,
                      const std::vector<std::string>& names, const fs::path& archive) {
  ZipWriter zip(archive);
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (!models[i].empty()) {
      zip.begin(names[i], ZipMethod::stored);  // fast, and a 3MF is compressed already
      copy_to(zip, models[i]);
    }
  }
  zip.begin("scans.csv", ZipMethod::deflated);
  zip.write(to_csv(jobs, names));
  zip.commit();
}

Response pack_collection(App& app, const Request& request, const std::vector<Job>& jobs,
                         const std::string& extension) {
  std::vector<fs::path> models;
  std::vector<std::string> names;
  std::set<std::string> used;
  std::uint64_t bytes = 0;
  for (const Job& job : jobs) {
    const bool has_model = chosen_model(job) != nullptr;
    models.push_back(has_model ? model_in_format(app, job, extension) : fs::path());
    names.push_back(has_model ? file_name(job, extension, used) : "");
    std::error_code none;  // of a scan without a model, or whose model was removed meanwhile
    const std::uint64_t size = fs::file_size(models.back(), none);
    bytes += none ? 0 : size;
    if (bytes > max_collection_bytes) {
      throw Error(ErrorCode::too_large, "these models have more than 512 MB",
                  "Choose fewer scans.");
    }
  }
  if (used.empty()) {
    throw Error(ErrorCode::no_model, "none of these scans has a model", "Choose others.");
  }
  expect_room(app.store.data(), app.store.free_bytes(), 2 * bytes, "an archive of models");
  if (request.method == "HEAD") {
    return {.headers = {{"Content-Type", "application/zip"}},
            .body = ByteStream{}};  // of a length not known yet
  }
  const Scratch archive(app.store.data() / "scans" / ".export-scans.zip");
  std::async(std::launch::async, write_collection, jobs, models, names, archive.path()).get();
  return file_response(request, archive.path(), "application/zip", "scans.zip");
}

}  // namespace

Response send_table(App& app, const Request& request) {
  const auto parameters = parameters_of(request, {"ids"});
  return {.headers = {{"Content-Type", "text/csv; charset=utf-8"},
                      {"Content-Disposition", attachment("scans.csv")},
                      {"Cache-Control", "private, no-cache"}},
          .body = to_csv(chosen_scans(app, value_of(parameters, "ids")))};
}

Response send_collection(App& app, const Request& request) {
  const auto parameters = parameters_of(request, {"ids", "format"});
  const std::string extension = "." + value_of(parameters, "format").value_or("stl");
  if (extension != ".stl" && find_mesh_format(extension) == nullptr) {
    throw Error(ErrorCode::bad_settings, "\"format\" names no format of models",
                "It is stl, or one of the settings' model_formats.");
  }
  const std::vector<Job> jobs = chosen_scans(app, value_of(parameters, "ids"));
  const Place place(&packing_places, "an archive is being packed for others");
  try {
    return pack_collection(app, request, jobs, extension);
  } catch (const Error&) {
    for (const Job& job : jobs) {
      find_scan(app, job.id);  // throws if it was deleted meanwhile, with its model
    }
    throw;
  }
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
