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

/// A person's change of the pose in force; absent members stay.
struct PoseChange {
  bool is_settings_pose = false;  ///< back to the settings' pose, without a scale
  std::optional<Eigen::Isometry3d> platform_from_sensor = {};
  /// Factor of the depths. Without a new pose the old one is scaled with it, so that the platform
  /// stays where it is seen.
  std::optional<double> scale = {};
};

/// The sensor's pose in force, which overrides that of the settings, and the poses before it, in
/// `DATA/calibration.json`; `calibration.last.json` is a copy, read if that file is damaged. A rig
/// with lasers has `laser-calibration.json` and its copy, whose records belong to a camera each, or
/// to any camera if a person gave the pose. Thread-safe.
class CalibrationStore {
 public:
  static constexpr std::size_t max_history = 10;  ///< records beside the one in force, of a camera

  /// Reads the file; the log names a damaged one.
  /// @param data  the data folder, which this process has locked
  explicit CalibrationStore(std::filesystem::path data, SensorKind kind = SensorKind::depth);

  /// The record in force, then those before it, the newest first. Reads no disk.
  /// @param told    settings whose pose is in force if there is no record
  /// @param camera  serial number of the camera whose records are asked for; empty: of all
  std::vector<PoseRecord> records(const ScanSettings& told, std::string_view camera = {}) const;

  /// Settings for a new scan, with the pose and the scale in force. Reads no disk.
  /// @param camera  as above
  ScanSettings in_force(ScanSettings told, std::string_view camera = {}) const;

  /// Puts a pose into force. @throws Error "disk-full", "write-failed"
  void set(const PoseRecord& record);

  /// Applies a person's change. @param told, camera  as above
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
  std::mutex writing_;        // serialises changes of the records; locked before mutex_
  mutable std::mutex mutex_;  // guards records_, and is never held while the disk is used
  std::vector<PoseRecord> records_;
};

/// The fault of a data folder's calibration file; nothing if it is intact or absent.
std::optional<std::string> find_damaged_calibration(const std::filesystem::path& data);

}  // namespace octurn
