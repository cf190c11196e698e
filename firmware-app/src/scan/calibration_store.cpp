#include "scan/calibration_store.hpp"

#include <chrono>
#include <nlohmann/json.hpp>
#include <utility>

#include "log.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "utc.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t max_file_bytes = std::size_t{1} << 20U;  // a hundred times what is written

fs::path file_in(const fs::path& data) { return data / "calibration.json"; }
fs::path copy_in(const fs::path& data) { return data / "calibration.last.json"; }

std::vector<PoseRecord> records_from(const json& document) {
  JsonObject root(document, ErrorCode::platform_malformed, "");
  if (const JsonValue format = root.at("format"); format.text() != "octurn-calibration") {
    format.refuse("\"octurn-calibration\"");
  }
  if (const JsonValue version = root.at("version"); version.number() != 1) {
    version.refuse("1, which this program reads");
  }
  std::vector<PoseRecord> records;
  for (const JsonValue& record : root.at("poses").elements()) {
    records.push_back(to_record(record));
  }
  return records;
}

/// None if there is no such file. @throws Error "platform-malformed", "read-failed"
std::vector<PoseRecord> read_records(const fs::path& file) {
  const auto text = read_regular_file(file, max_file_bytes);
  try {
    return text ? records_from(parse_json(*text, ErrorCode::platform_malformed, "it"))
                : std::vector<PoseRecord>{};
  } catch (const Error& error) {
    throw Error(error.code(), file.string() + ": " + error.what(), error.hint());
  }
}

std::vector<PoseRecord> last_good_records(const fs::path& data) {
  for (const fs::path& file : {file_in(data), copy_in(data)}) {
    try {
      return read_records(file);
    } catch (const Error& error) {
      log::warning("calibration", error.what());
    }
  }
  return {};
}

/// The pose that the settings tell.
PoseRecord to_record(const ScanSettings& told) {
  const bool is_drawing = told.platform_from_sensor.isApprox(nominal_platform_from_sensor(), 1e-12);
  return {.platform_from_sensor = told.platform_from_sensor,
          .origin = is_drawing ? PoseOrigin::drawing : PoseOrigin::settings,
          .scale = told.depth_scale};
}

bool is_told(const PoseRecord& record) {
  return record.origin == PoseOrigin::drawing || record.origin == PoseOrigin::settings;
}

}  // namespace

CalibrationStore::CalibrationStore(fs::path data)
    : data_(std::move(data)), records_(last_good_records(data_)) {}

std::vector<PoseRecord> CalibrationStore::records() const {
  const std::lock_guard lock(mutex_);
  return records_;
}

std::vector<PoseRecord> CalibrationStore::records(const ScanSettings& told) const {
  std::vector<PoseRecord> all = records();
  if (all.empty()) {
    return {to_record(told)};
  }
  if (PoseRecord& first = all.front(); is_told(first)) {
    const std::string at = std::move(first.at);
    first = to_record(told);
    first.at = at;
  }
  return all;
}

ScanSettings CalibrationStore::in_force(ScanSettings told) const {
  const PoseRecord now = records(told).front();
  told.platform_from_sensor = now.platform_from_sensor;
  told.depth_scale = now.scale;
  return told;
}

void CalibrationStore::set(const PoseRecord& record) {
  const std::lock_guard writing(writing_);
  add(record);
}

/// `writing_` is held.
void CalibrationStore::add(const PoseRecord& record) {
  std::vector<PoseRecord> all = records();
  all.insert(all.begin(), record);
  write(std::move(all));
}

void CalibrationStore::change(const PoseChange& change, const ScanSettings& told) {
  const std::lock_guard writing(writing_);  // from here on: the record that is changed stays
  PoseRecord record = change.is_settings_pose ? to_record(told) : records(told).front();
  record.at = utc_text(std::chrono::system_clock::now(), rfc3339);
  if (change.platform_from_sensor || change.scale) {
    const double scale = change.scale.value_or(record.scale);
    record.platform_from_sensor.translation() *= scale / record.scale;
    record.scale = scale;
    record.origin = PoseOrigin::page;
    record.figures.reset();
  }
  if (change.platform_from_sensor) {
    record.platform_from_sensor = *change.platform_from_sensor;
  }
  add(record);
}

void CalibrationStore::undo() {
  const std::lock_guard writing(writing_);
  std::vector<PoseRecord> all = records();
  if (all.empty()) {
    throw Error(ErrorCode::not_found, "there is no earlier pose of the sensor",
                "The settings' pose is in force.");
  }
  all.erase(all.begin());
  write(std::move(all));
}

/// `writing_` is held.
void CalibrationStore::write(std::vector<PoseRecord> records) {
  records.resize(std::min(records.size(), max_history + 1));
  json poses = json::array();
  for (const PoseRecord& record : records) {
    poses.push_back(to_json(record));
  }
  const std::string text =
      json{{"format", "octurn-calibration"}, {"version", 1}, {"poses", poses}}.dump(1) + "\n";
  write_file(file_in(data_), text);
  write_file(copy_in(data_), text);
  const std::lock_guard lock(mutex_);
  records_ = std::move(records);
}

std::optional<std::string> find_damaged_calibration(const fs::path& data) {
  try {
    read_records(file_in(data));
    return std::nullopt;
  } catch (const Error& error) {
    return error.what();
  }
}

}  // namespace octurn
