#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scan/laser_settings.hpp"
#include "scan/pose_record.hpp"
#include "scan/scan_settings.hpp"

namespace octurn {

/// What a person changes of the pose in force; what is absent stays.
struct PoseChange {
  bool is_settings_pose = false;  ///< back to the settings' pose, without a scale
  std::optional<Eigen::Isometry3d> platform_from_sensor = {};
  /// Of the depths. A pose that is not given grows with it: the platform stays where it is seen.
  std::optional<double> scale = {};
};

/// The pose of the sensor that is in force over the settings', and those before it, in
/// `DATA/calibration.json`; `calibration.last.json` is a copy, read where that is damaged. Of a rig
/// with lasers, `laser-calibration.json` and its copy: records there belong to a camera, or to any
/// where a person gave the pose. Any thread may call anything.
class CalibrationStore {
 public:
  static constexpr std::size_t max_history = 10;  ///< records beside the one in force, of a camera

  /// Reads the file; one that is damaged is named in the log.
  /// @param data  that this process has locked
  explicit CalibrationStore(std::filesystem::path data, SensorKind kind = SensorKind::depth);

  /// The record in force, then those before it, the newest first. Touches no disk.
  /// @param told    settings whose pose is in force where no other is
  /// @param camera  serial number of the one whose records are asked for; empty: of all
  std::vector<PoseRecord> records(const ScanSettings& told, std::string_view camera = {}) const;

  /// The settings of a scan to come, with the pose and the scale in force. Touches no disk.
  /// @param camera  as above
  ScanSettings in_force(ScanSettings told, std::string_view camera = {}) const;

  /// Puts a pose into force. @throws Error "disk-full", "write-failed"
  void set(const PoseRecord& record);

  /// The same with what a person wants. @param told, camera  as above
  void change(const PoseChange& change, const ScanSettings& told, std::string_view camera = {});

  /// Puts the pose before the one in force back into force. @param camera  as above
  /// @throws Error "not-found"  if there was none; as `set`
  void undo(std::string_view camera = {});

 private:
  std::vector<PoseRecord> records() const;
  PoseRecord to_record(const ScanSettings& told) const;
  void add(const PoseRecord& record);
  void write(std::vector<PoseRecord> records);

  std::filesystem::path data_;
  SensorKind kind_;
  std::mutex writing_;        // held by who changes the records; taken before mutex_
  mutable std::mutex mutex_;  // guards records_, and is never held while the disk is used
  std::vector<PoseRecord> records_;
};

/// What is wrong with the calibration of a data folder; nothing if it is whole, or there is none.
std::optional<std::string> find_damaged_calibration(const std::filesystem::path& data);

}  // namespace octurn
