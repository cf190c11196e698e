#include "scan/job_file.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "octurn/json_object.hpp"
#include "scan/calibration_json.hpp"
#include "scan/failure_json.hpp"
#include "scan/json_numbers.hpp"
#include "scan/model_json.hpp"
#include "scan/pose_of_json.hpp"

namespace octurn {
namespace {

using nlohmann::json;

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

std::optional<PoseOf> pose_of_from(const std::optional<JsonValue>& object) {
  return !object || object->json().is_null() ? std::nullopt : std::optional(to_pose_of(*object));
}

/// False without the key, which earlier versions did not write.
bool flag_in(const std::optional<JsonValue>& flag) { return flag && flag->flag(); }

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
              {"seconds_elapsed", to_thousandths(job.times.elapsed.count())},
              {"late_pulses", job.times.late_pulses},
              {"settings", to_json(job.settings)},
              {"error", nullptr},
              {"calibration", nullptr},
              {"model", nullptr},
              {"build", job.builds.chosen},
              {"pose_of", job.pose_of ? to_json(*job.pose_of) : json()},
              {"has_colours", job.builds.have_colours}};
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

Job to_job(const json& object) {
  JsonObject keys(object, ErrorCode::job_malformed, "");
  constexpr int max_int = std::numeric_limits<int>::max();
  return {.id = keys.at("id").text(),
          .label = {.name = keys.at("name").text()},
          .state = parse_name(keys.at("state"), job_state_named),
          .phase = parse_name(keys.at("phase"), phase_named),
          .snapshots_done = static_cast<int>(keys.at("snapshots_done").number(0, max_int)),
          .times = {.created = keys.at("created").text(),
                    .elapsed = Seconds(keys.at("seconds_elapsed").number(0, unlimited)),
                    .late_pulses = static_cast<int>(number_or_zero(keys, "late_pulses", max_int))},
          .settings = stored_settings_from(keys.at("settings")),
          .failure = failure_from(keys.value("error")),
          .calibration = calibration_from(keys.value("calibration")),
          .model = model_from(keys.value("model")),
          .builds = {.chosen = static_cast<int>(number_or_zero(keys, "build", max_int)),
                     .have_colours = flag_in(keys.value("has_colours"))},
          .pose_of = pose_of_from(keys.value("pose_of"))};
}

}  // namespace octurn
