#include "calibration/calibration_store.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "calibration/record_file.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "wall_clock.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::string_view calibration_format = "octurn-calibration";
constexpr std::size_t max_records_bytes = std::size_t{1} << 20U;  // 100 times the usual size

fs::path file_in(const fs::path& data, SensorKind kind) {
  return data / (kind == SensorKind::depth ? "calibration.json" : "laser-calibration.json");
}
fs::path copy_in(const fs::path& data, SensorKind kind) {
  return file_in(data, kind).replace_extension(".last.json");
}

std::vector<PoseRecord> poses_from(JsonObject& root) {
  std::vector<PoseRecord> records;
  for (const JsonValue& record : root.at("poses").elements()) {
    records.push_back(to_record(record));
  }
  return records;
}

/// Returns no records if the file does not exist. @throws Error "platform-malformed", "read-failed"
std::vector<PoseRecord> read_records(const fs::path& file) {
  return read_record({.file = file,
                      .format = calibration_format,
                      .max_bytes = max_records_bytes,
                      .malformed = ErrorCode::platform_malformed},
                     poses_from)
      .value_or(std::vector<PoseRecord>());
}

std::vector<PoseRecord> last_good_records(const fs::path& data, SensorKind kind) {
  for (const fs::path& file : {file_in(data, kind), copy_in(data, kind)}) {
    if (auto records = last_good([&] { return read_records(file); })) {
      return *std::move(records);
    }
  }
  return {};
}

bool is_told(const PoseRecord& record) {
  return record.origin == PoseOrigin::drawing || record.origin == PoseOrigin::settings;
}

/// Whether a record applies to that camera. An empty serial number, on either side, matches all.
bool is_of(const PoseRecord& record, std::string_view camera) {
  return camera.empty() || record.camera.empty() || record.camera == camera;
}

/// The factor of the platform's distance when other optics correct the sensor's depths. A reported
/// inverse depth r is (r + offset) / scale in truth, see `SensorOptics`.
double distance_factor(const PoseRecord& pose, const SensorOptics& before,
                       const SensorOptics& now) {
  const double depth = std::abs(pose.platform_from_sensor.inverse().translation().z());  // metres
  const double moved = now.depth_offset_per_m - before.depth_offset_per_m;               // 1/m
  return now.depth_scale / (pose.scale * before.depth_scale + moved * depth);
}

/// Drops each camera's oldest records beyond `max_history`. @param records  newest first
std::vector<PoseRecord> newest_of_each(const std::vector<PoseRecord>& records) {
  std::map<std::string, std::size_t> count;
  std::vector<PoseRecord> kept;
  std::ranges::copy_if(records, std::back_inserter(kept), [&](const PoseRecord& record) {
    return count[record.camera]++ <= CalibrationStore::max_history;
  });
  return kept;
}

}  // namespace

CalibrationStore::CalibrationStore(fs::path data, SensorKind kind)
    : data_(std::move(data)), kind_(kind), records_(last_good_records(data_, kind)) {}

/// Returns the record of the settings' pose.
PoseRecord CalibrationStore::to_record(const ScanSettings& configured) const {
  const Eigen::Isometry3d drawing =
      kind_ == SensorKind::depth ? nominal_platform_from_sensor() : nominal_platform_from_camera();
  const bool is_drawing = configured.platform_from_sensor.isApprox(drawing, 1e-12);
  return {.platform_from_sensor = configured.platform_from_sensor,
          .origin = is_drawing ? PoseOrigin::drawing : PoseOrigin::settings,
          .scale = configured.depth_scale};
}

std::vector<PoseRecord> CalibrationStore::records() const {
  const std::lock_guard lock(mutex_);
  return records_;
}

std::vector<PoseRecord> CalibrationStore::records(const ScanSettings& configured,
                                                  std::string_view camera) const {
  std::vector<PoseRecord> all = records();
  std::erase_if(all, [&](const PoseRecord& record) { return !is_of(record, camera); });
  if (all.empty()) {
    return {to_record(configured)};
  }
  if (PoseRecord& first = all.front(); is_told(first)) {
    const std::string at = std::move(first.at);
    first = to_record(configured);
    first.at = at;
  }
  return all;
}

ScanSettings CalibrationStore::in_force(ScanSettings configured, std::string_view camera) const {
  const PoseRecord now = records(configured, camera).front();
  configured.platform_from_sensor = now.platform_from_sensor;
  configured.depth_scale = now.scale;
  return configured;
}

void CalibrationStore::set(const PoseRecord& record) {
  const std::lock_guard writing(writing_);
  add(record);
}

void CalibrationStore::set(const PoseRecord& pose, const OpticsRecord& optics) {
  const std::lock_guard writing(writing_);  // nobody drops the pose before its optics are there
  add(pose);
  keep_optics(data_, pose.optics_of, optics);
}

/// `writing_` is held.
void CalibrationStore::add(const PoseRecord& record) {
  std::vector<PoseRecord> all = records();
  all.insert(all.begin(), record);
  write(std::move(all));
}

void CalibrationStore::change(const PoseChange& change, const ScanSettings& configured,
                              std::string_view camera) {
  const std::lock_guard writing(writing_);  // from reading the record to writing its change
  PoseRecord record =
      change.is_settings_pose ? to_record(configured) : records(configured, camera).front();
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
    record.optics_of.clear();
    record.optics_at.clear();
  }
  add(record);
}

/// The pose in force with new optics; nullopt if it stays as drawn. `writing_` is held.
std::optional<PoseRecord> CalibrationStore::pose_with(std::string_view serial,
                                                      const OpticsRecord& optics,
                                                      const ScanSettings& configured) const {
  PoseRecord pose = records(configured).front();
  const bool is_drawing = pose.origin == PoseOrigin::drawing;
  if (is_drawing && pose.scale == 1) {
    return std::nullopt;
  }
  if (!is_drawing) {
    const SensorOptics before = optics_in_force(data_, serial).value_or(SensorOptics{});
    pose.platform_from_sensor.translation() *= distance_factor(pose, before, optics.optics.value);
  }
  pose.origin = PoseOrigin::page;
  pose.at = optics.at;
  pose.figures.reset();
  pose.scale = 1;
  pose.optics_of = serial;
  pose.optics_at = optics.at;
  return pose;
}

void CalibrationStore::use_optics(std::string_view serial, const OpticsRecord& optics,
                                  const ScanSettings& configured) {
  const std::lock_guard writing(writing_);  // as in `set`
  if (const auto pose = pose_with(serial, optics, configured)) {
    add(*pose);
  }
  keep_optics(data_, serial, optics);
}

void CalibrationStore::undo(std::string_view camera) {
  const std::lock_guard writing(writing_);
  std::vector<PoseRecord> all = records();
  const auto now =
      std::ranges::find_if(all, [&](const PoseRecord& record) { return is_of(record, camera); });
  if (now == all.end()) {
    throw Error(ErrorCode::not_found, "there is no earlier pose of the sensor",
                "The settings' pose is in force.");
  }
  all.erase(now);
  write(std::move(all));
}

void CalibrationStore::drop_without_optics(std::string_view serial) {
  const std::lock_guard writing(writing_);
  std::vector<PoseRecord> all = records();
  const std::vector<OpticsRecord> optics = read_optics(data_, serial);
  const auto dropped = std::erase_if(all, [&](const PoseRecord& record) {
    return !serial.empty() && record.optics_of == serial &&
           std::ranges::count(optics, record.optics_at, &OpticsRecord::at) == 0;
  });
  if (dropped > 0) {
    write(std::move(all));
  }
}

/// `writing_` is held.
void CalibrationStore::write(std::vector<PoseRecord> records) {
  records = newest_of_each(records);
  json poses = json::array();
  for (const PoseRecord& record : records) {
    poses.push_back(to_json(record));
  }
  for (const fs::path& file : {file_in(data_, kind_), copy_in(data_, kind_)}) {
    write_record_file(file, calibration_format, {{"poses", poses}});
  }
  const std::lock_guard lock(mutex_);
  records_ = std::move(records);
}

std::optional<std::string> find_damaged_calibration(const fs::path& data) {
  try {
    read_records(file_in(data, SensorKind::depth));
    read_records(file_in(data, SensorKind::laser_line));
    return std::nullopt;
  } catch (const Error& error) {
    return error.what();
  }
}

}  // namespace octurn
