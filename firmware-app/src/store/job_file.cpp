#include "store/job_file.hpp"

#include <algorithm>
#include <exception>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "octurn/file.hpp"
#include "octurn/json_object.hpp"
#include "octurn/scan_folder.hpp"
#include "store/job_json.hpp"

namespace octurn {
namespace {

using nlohmann::json;

// `to_job_text` writes more than six bytes for each value.
constexpr JsonLimits job_limits{.bytes = max_job_bytes, .values = max_job_bytes / 6};
constexpr double max_seconds = 1e9;  // 30 years: the clock's nanoseconds hold 292

/// @param named  maps a name to its value
template <typename Value>
Value parse_name(const JsonValue& name, std::optional<Value> (*named)(std::string_view)) {
  const std::optional<Value> value = named(name.text());
  if (!value) {
    name.refuse("a name that this version knows");
  }
  return *value;
}

std::optional<Failure> failure_from(const std::optional<JsonValue>& object) {
  return !object || object->json().is_null() ? std::nullopt : std::optional(to_failure(*object));
}

std::optional<ScanCalibration> calibration_from(const std::optional<JsonValue>& object) {
  return !object || object->json().is_null() ? std::nullopt
                                             : std::optional(to_scan_calibration(*object));
}

/// Whether a stored scan is by laser line; not if it has no snapshot.
bool is_by_laser(const std::filesystem::path& folder) {
  try {
    return read_scan(folder).laser.has_value();
  } catch (const std::exception&) {
    return false;
  }
}

std::optional<PoseOf> pose_of_from(const std::optional<JsonValue>& object) {
  return !object || object->json().is_null() ? std::nullopt : std::optional(to_pose_of(*object));
}

/// The time that a scan has taken, within the range of the scanner's clock.
double in_clock_range(double seconds) { return std::clamp(seconds, 0.0, max_seconds); }

/// `otherwise` without the key, which earlier versions did not write.
bool flag_in(const std::optional<JsonValue>& flag, bool otherwise) {
  return flag ? flag->flag() : otherwise;
}

std::optional<Model> model_from(const std::optional<JsonValue>& object) {
  return !object || object->json().is_null() ? std::nullopt : std::optional(to_model(*object));
}

}  // namespace

json to_job_json(const Job& job) {
  json object{{"id", job.id},
              {"name", job.label.name},
              {"state", to_string(job.state)},
              {"phase", to_string(job.phase)},
              {"created", job.times.created},
              {"snapshots_done", job.snapshots_done},
              {"snapshots_total", job.settings.snapshots},
              {"seconds_elapsed", to_thousandths(in_clock_range(job.times.elapsed.count()))},
              {"late_pulses", job.times.late_pulses},
              {"slips", job.times.slips},
              {"seconds_settling", to_thousandths(in_clock_range(job.times.settling.count()))},
              {"settings", to_json(job.settings)},
              {"error", nullptr},
              {"calibration", nullptr},
              {"model", nullptr},
              {"build", job.builds.chosen},
              {"pose_of", job.pose_of ? to_json(*job.pose_of) : json()},
              {"has_colours", job.builds.have_colours},
              {"has_views", job.builds.have_views}};
  if (job.failure) {
    object["error"] = to_json(*job.failure);
  }
  if (job.calibration) {
    object["calibration"] = to_json(*job.calibration);
  }
  if (job.model) {
    object["model"] = to_json(*job.model);
  }
  return object;
}

std::string to_job_text(const Job& job) {
  return to_job_json(job).dump(1, ' ', false, json::error_handler_t::replace) + "\n";
}

Job parse_job(std::string_view text) {
  return to_job(parse_json(text, ErrorCode::job_malformed, "the file", job_limits));
}

Job read_job(const std::filesystem::path& folder) {
  const json object = parse_json(read_regular_file(folder / "job.json", max_job_bytes).value_or(""),
                                 ErrorCode::job_malformed, "the file", job_limits);
  Job job = to_job(object);
  if (!object.contains("has_views") && is_by_laser(folder)) {  // written by an earlier version
    job.builds.have_views = false;
  }
  return job;
}

Job to_job(const json& object) {
  JsonObject keys(object, ErrorCode::job_malformed, "");
  constexpr int max_int = std::numeric_limits<int>::max();
  const bool have_colours = flag_in(keys.value("has_colours"), false);
  return {.id = keys.at("id").text(),
          .label = {.name = keys.at("name").text()},
          .state = parse_name(keys.at("state"), job_state_named),
          .phase = parse_name(keys.at("phase"), phase_named),
          .snapshots_done = static_cast<int>(keys.at("snapshots_done").number(0, max_int)),
          .times = {.created = keys.at("created").text(),
                    .elapsed = Seconds(in_clock_range(keys.at("seconds_elapsed").number())),
                    .late_pulses = static_cast<int>(number_or_zero(keys, "late_pulses", max_int)),
                    .slips = static_cast<int>(number_or_zero(keys, "slips", max_int)),
                    .settling = Seconds(number_or_zero(keys, "seconds_settling", max_int))},
          .settings = stored_settings_from(keys.at("settings")),
          .failure = failure_from(keys.value("error")),
          .calibration = calibration_from(keys.value("calibration")),
          .model = model_from(keys.value("model")),
          .builds = {.chosen = static_cast<int>(number_or_zero(keys, "build", max_int)),
                     .have_colours = have_colours,
                     .have_views = flag_in(keys.value("has_views"), !have_colours)},
          .pose_of = pose_of_from(keys.value("pose_of"))};
}

}  // namespace octurn
