#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/optics_files.hpp"
#include "calibration/pose_record.hpp"
#include "settings/laser_settings.hpp"
#include "settings/scan_settings.hpp"

namespace octurn {

/// A user's change of the pose in force. Absent members change nothing.
struct PoseChange {
  bool is_settings_pose = false;  ///< resets pose and depth scale to the settings'
  std::optional<Eigen::Isometry3d> platform_from_sensor = {};
  /// Factor of the sensor's depths. Without a new pose, the old one's translation is scaled along,
  /// so that the platform stays at the same pixels.
  std::optional<double> scale = {};
};

/// The sensor's pose in force, which overrides that of the settings, and the earlier poses. They
/// are stored in `DATA/calibration.json`; `calibration.last.json` is a copy, read if that file is
/// damaged. A rig with lasers uses `laser-calibration.json` and its copy. Each of its records
/// belongs to one camera, or to any camera if a user entered the pose. Thread-safe.
class CalibrationStore {
 public:
  static constexpr std::size_t max_history = 10;  ///< earlier records kept per camera

  /// Reads the file. If it is damaged, logs that and reads the copy.
  /// @param data  the data folder, which this process has locked
  explicit CalibrationStore(std::filesystem::path data, SensorKind kind = SensorKind::depth);

  /// Returns the record in force, then the earlier ones, newest first. Does not access the disk.
  /// @param configured    settings whose pose is in force if there is no record
  /// @param camera  serial number of the camera whose records are returned; empty: all cameras
  std::vector<PoseRecord> records(const ScanSettings& configured,
                                  std::string_view camera = {}) const;

  /// Returns settings for a new scan: `configured` with the pose and the depth scale in force. Does
  /// not access the disk.
  /// @param camera  as above
  ScanSettings in_force(ScanSettings configured, std::string_view camera = {}) const;

  /// Puts a pose into force. @throws Error "disk-full", "write-failed"
  void set(const PoseRecord& record);

  /// Puts a pose into force, and the optics of the sensor `pose.optics_of`, without which it does
  /// not hold. After a power cut in between, `drop_without_optics` drops the pose.
  /// @throws  as `set`
  void set(const PoseRecord& pose, const OpticsRecord& optics);

  /// Applies a user's change. @param configured, camera  as above
  void change(const PoseChange& change, const ScanSettings& configured,
              std::string_view camera = {});

  /// Puts a depth sensor's optics into force, whose scale replaces that of a known length. The
  /// distance of the platform changes as its depths do, so that it stays at the same pixels. A pose
  /// of the drawing stays as drawn.
  /// @throws  as `set`
  void use_optics(std::string_view serial, const OpticsRecord& optics,
                  const ScanSettings& configured);

  /// Restores the pose before the one in force. @param camera  as above
  /// @throws Error "not-found"  if there is none; and as `set`
  void undo(std::string_view camera = {});

  /// Drops the poses that hold only with optics of a depth sensor that are no longer kept: they
  /// were taken back, or the power failed before they were written.
  /// @param serial  of the sensor
  /// @throws  as `read_optics`, then no pose is dropped, and as `set`
  void drop_without_optics(std::string_view serial);

 private:
  std::vector<PoseRecord> records() const;
  PoseRecord to_record(const ScanSettings& configured) const;
  std::optional<PoseRecord> pose_with(std::string_view serial, const OpticsRecord& optics,
                                      const ScanSettings& configured) const;
  void add(const PoseRecord& record);
  void write(std::vector<PoseRecord> records);

  std::filesystem::path data_;
  SensorKind kind_;
  // Serialises changes of the records and of the optics with which they hold; locked before mutex_.
  std::mutex writing_;
  mutable std::mutex mutex_;  // guards records_; never held during disk access
  std::vector<PoseRecord> records_;
};

/// Returns what is wrong with a data folder's calibration files; nullopt if they are intact or
/// absent.
std::optional<std::string> find_damaged_calibration(const std::filesystem::path& data);

}  // namespace octurn
