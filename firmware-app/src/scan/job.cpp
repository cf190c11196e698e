#include "scan/job.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "octurn/json_object.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

using nlohmann::json;
using Seconds = std::chrono::duration<double>;

template <typename Value>
using Names = std::pair<Value, std::string_view>;

constexpr std::array<Names<JobState>, 6> states{{{JobState::running, "running"},
                                                 {JobState::paused, "paused"},
                                                 {JobState::finished, "finished"},
                                                 {JobState::cancelled, "cancelled"},
                                                 {JobState::failed, "failed"},
                                                 {JobState::interrupted, "interrupted"}}};

constexpr std::array<Names<Phase>, 5> phases{{{Phase::starting, "starting"},
                                              {Phase::turning, "turning"},
                                              {Phase::capturing, "capturing"},
                                              {Phase::building, "building"},
                                              {Phase::done, "done"}}};

constexpr double most = std::numeric_limits<double>::max();
constexpr double most_whole = 1e15;  // a double holds every whole number up to there

/// Thousandths, as people and the page read them.
double rounded(double value) { return std::round(value * 1000) / 1000; }

json json_of(const Model& model, const std::string& id) {
  const ModelReport& report = model.report;
  return {{"parts", report.parts == 0 ? json(nullptr) : json(report.parts)},
          {"filled_share", report.parts == 0 ? json(nullptr) : json(rounded(report.filled_share))},
          {"url", "/api/v1/scans/" + id + "/Scan.stl"},
          {"bytes", report.bytes},
          {"triangles", report.triangles},
          {"leaves", report.leaves},
          {"watertight", report.watertight},
          {"volume_cm3", rounded(cm3_from_m3(report.volume))},
          {"size_mm",
           {rounded(mm_from_metres(report.size.x())), rounded(mm_from_metres(report.size.y())),
            rounded(mm_from_metres(report.size.z()))}},
          {"seconds", rounded(model.build_time.count())}};
}

[[noreturn]] void missing(std::string_view key) {
  throw Error("job-malformed", "\"" + std::string(key) + "\" is missing");
}

double number(JsonObject& keys, std::string_view key, double largest) {
  const auto value = keys.number(key, 0, largest);
  return value ? *value : (missing(key), 0);
}

std::uint64_t count(JsonObject& keys, std::string_view key) {
  return static_cast<std::uint64_t>(number(keys, key, most_whole));
}

/// Of what not every method counts.
double number_or_none(JsonObject& keys, std::string_view key, double largest) {
  const json* value = keys.find(key);
  return value == nullptr || value->is_null() ? 0 : number(keys, key, largest);
}

std::string text(JsonObject& keys, std::string_view key) {
  auto value = keys.text(key);
  return value ? *value : (missing(key), "");
}

template <typename Value, std::size_t size>
Value one_of(JsonObject& keys, std::string_view key, const std::array<Names<Value>, size>& names) {
  const std::string name = text(keys, key);
  const auto* found = std::ranges::find(names, name, &Names<Value>::second);
  if (found == names.end()) {
    keys.refuse(key, name, "a name that this version knows");
  }
  return found->first;
}

std::optional<Failure> failure_from(const json* object) {
  if (object == nullptr || object->is_null()) {
    return std::nullopt;
  }
  JsonObject keys(*object, "job-malformed", "error");
  return Failure{
      .code = text(keys, "code"), .detail = text(keys, "detail"), .hint = text(keys, "hint")};
}

std::optional<Model> model_from(const json* object) {
  if (object == nullptr || object->is_null()) {
    return std::nullopt;
  }
  JsonObject keys(*object, "job-malformed", "model");
  Model model{
      .report = {.leaves = count(keys, "leaves"),
                 .triangles = count(keys, "triangles"),
                 .bytes = count(keys, "bytes"),
                 .parts = static_cast<std::uint64_t>(number_or_none(keys, "parts", most_whole)),
                 .filled_share = number_or_none(keys, "filled_share", 1),
                 .watertight = keys.flag("watertight").value_or(false),
                 .volume = m3_from_cm3(number(keys, "volume_cm3", most))},
      .build_time = Seconds(number(keys, "seconds", most))};
  const json* size = keys.find("size_mm");
  if (size == nullptr || !size->is_array() || size->size() != 3 ||
      !std::ranges::all_of(*size, [](const json& side) { return side.is_number(); })) {
    throw Error("job-malformed", "\"model.size_mm\" is not three numbers");
  }
  for (int axis = 0; axis < 3; ++axis) {
    model.report.size[axis] = metres_from_mm((*size)[static_cast<std::size_t>(axis)].get<double>());
  }
  return model;
}

}  // namespace

bool is_resumable(JobState state) {
  return state == JobState::paused || state == JobState::interrupted;
}

std::string_view name_of(JobState state) {
  return std::ranges::find(states, state, &Names<JobState>::first)->second;
}

std::string_view name_of(Phase phase) {
  return std::ranges::find(phases, phase, &Names<Phase>::first)->second;
}

Failure failure_of(const Error& error) {
  return {.code = error.code(), .detail = error.what(), .hint = error.hint()};
}

Failure current_failure() {
  const std::string hint = "Please report this.";
  try {
    throw;
  } catch (const Error& error) {
    return failure_of(error);
  } catch (const std::exception& error) {
    return {.code = "internal", .detail = error.what(), .hint = hint};
  } catch (...) {
    return {.code = "internal", .detail = "an unknown exception", .hint = hint};
  }
}

bool is_device_fault(const Failure& failure) {
  return failure.code.starts_with("sensor-") || failure.code.starts_with("turntable-");
}

Failure interruption() {
  return {.code = "interrupted",
          .detail = "the scanner was switched off during this scan",
          .hint = "Resume it if neither the object nor the platform was moved since."};
}

json json_of(const Job& job) {
  json object{{"id", job.id},
              {"name", job.name},
              {"state", name_of(job.state)},
              {"phase", name_of(job.phase)},
              {"created", job.created},
              {"snapshots_done", job.snapshots_done},
              {"snapshots_total", job.settings.snapshots},
              {"seconds_elapsed", rounded(job.elapsed.count())},
              {"seconds_left", nullptr},
              {"late_pulses", job.late_pulses},
              {"settings", json_of(job.settings)},
              {"error", nullptr},
              {"model", nullptr}};
  if (job.left) {
    object["seconds_left"] = rounded(job.left->count());
  }
  if (job.failure) {
    object["error"] = {
        {"code", job.failure->code}, {"detail", job.failure->detail}, {"hint", job.failure->hint}};
  }
  if (job.model) {
    object["model"] = json_of(*job.model, job.id);
  }
  return object;
}

Job job_from(const json& object) {
  JsonObject keys(object, "job-malformed", "");
  const json* settings = keys.find("settings");
  if (settings == nullptr) {
    missing("settings");
  }
  return {.id = text(keys, "id"),
          .name = text(keys, "name"),
          .state = one_of(keys, "state", states),
          .phase = one_of(keys, "phase", phases),
          .created = text(keys, "created"),
          .snapshots_done =
              static_cast<int>(number(keys, "snapshots_done", std::numeric_limits<int>::max())),
          .elapsed = Seconds(number(keys, "seconds_elapsed", most)),
          .settings = settings_from(*settings, {}, "settings"),
          .late_pulses = static_cast<int>(
              number_or_none(keys, "late_pulses", std::numeric_limits<int>::max())),
          .failure = failure_from(keys.find("error")),
          .model = model_from(keys.find("model"))};
}

}  // namespace octurn
