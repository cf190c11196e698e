#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

#include "calibration/calibration_store.hpp"
#include "calibration/pose_record.hpp"
#include "capture/calibration_turn.hpp"
#include "capture/rig.hpp"
#include "capture/scan_observer.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/png.hpp"
#include "octurn/snapshot.hpp"
#include "settings/scan_settings.hpp"

namespace octurn {

/// What the kind of a rig's sensor decides, while the rig is used and calibrated. Used by the
/// thread that uses the rig. Functions may open the sensor, or the camera, if it is closed, and
/// throw "sensor-missing" or "sensor-failed" if that fails.
class Capture {
 public:
  /// A depth frame, or a picture that was taken with all lasers off.
  using Seen = std::variant<DepthFrame, Picture>;

  virtual ~Capture() = default;

  /// Serial number of the sensor or the camera; empty if it has none.
  virtual std::string serial() = 0;

  /// Whether the sensor shows infrared pictures, too.
  virtual bool has_infrared() = 0;

  /// Reads what the sensor sees next; nullopt if stopped first.
  virtual std::optional<Seen> read(const std::stop_token& stop) = 0;

  /// Sets what this machine knows of the sensor: a depth sensor's optics, with the depth scale of
  /// `settings`; a camera's lens and pose, and its lasers' planes.
  /// @param begun  folder of a scan whose optics or lens are used in place of those in force, since
  ///               all snapshots of a scan have the same; empty: none
  virtual void use_stored(const ScanSettings& settings, const std::filesystem::path& begun) = 0;

  /// Copies the map of the sensor's depth error into the folder of a new scan, if there is one.
  virtual void keep_sensor_map(const std::filesystem::path& folder) = 0;

  /// Takes a turn and solves the sensor's pose from it, as `measure_turn` and `measure_laser_turn`.
  virtual std::optional<TurnReport> measure_turn(const ScanSettings& settings, int threads,
                                                 const std::stop_token& stop,
                                                 const ScanObserver& observer) = 0;

  /// Makes the record of an accepted pose, with the current time.
  /// @param lasers  with the planes that belong to the pose; empty: a depth sensor
  virtual PoseRecord to_record(const CalibrationReport& report, PoseOrigin origin,
                               const ScanSettings& settings, const std::vector<Laser>& lasers) = 0;
};

/// Makes the capture of a rig. @param data  the data folder
std::unique_ptr<Capture> make_capture(Rig& rig, std::filesystem::path data,
                                      const CalibrationStore& calibration);

}  // namespace octurn
