#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <variant>
#include <vector>

#include "calibration/board_watch.hpp"
#include "calibration/calibration_store.hpp"
#include "calibration/pose_record.hpp"
#include "capture/calibration_turn.hpp"
#include "capture/rig.hpp"
#include "capture/scan_observer.hpp"
#include "capture/take_depth_image.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/lens.hpp"
#include "octurn/png.hpp"
#include "octurn/scan_folder.hpp"
#include "octurn/snapshot.hpp"
#include "settings/scan_settings.hpp"

namespace octurn {

/// A depth frame, or a picture that was taken with all lasers off.
using SeenImage = std::variant<DepthFrame, Picture>;

/// The open sensor, or camera.
struct SensorInfo {
  std::string name = {};
  std::string serial = {};    ///< empty if it has none
  bool has_infrared = false;  ///< whether it shows infrared pictures, too
};

/// A stop of a scan that was stored.
struct TakenStop {
  /// To be added to the model while the platform turns. Nothing by laser line: the surface at the
  /// first stop ends at the lines of the last one.
  std::optional<DepthFrame> frame = {};
};

/// Callbacks of a measurement by a board.
struct BoardObserver {
  std::function<void(const Picture& picture, const BoardLook& look)> on_picture;
  /// Called once no more views are taken. @return false to give up; else they are solved
  std::function<bool()> on_solving;
};

/// What a board showed of a sensor's lens.
struct BoardResult {
  LensReport lens = {};
  std::optional<SolvedOptics> optics = {};  ///< of a depth sensor, if the report is accepted
};

/// What the kind of a rig's sensor decides, while the rig scans and is calibrated. Used by the
/// thread that uses the rig. Functions may open the sensor, or the camera, if it is closed, and
/// throw "sensor-missing" or "sensor-failed" if that fails.
class Capture {
 public:
  virtual ~Capture() = default;

  Rig& rig() { return rig_; }

  virtual SensorInfo sensor() = 0;

  /// Reads what the sensor sees next; nullopt if stopped first.
  virtual std::optional<SeenImage> read(const std::stop_token& stop) = 0;

  /// Sets what this machine knows of the sensor: a depth sensor's optics, with the depth scale of
  /// `settings`; a camera's lens and pose, and its lasers' planes.
  /// @param begun  folder of a scan whose optics or lens are used in place of those in force, since
  ///               all snapshots of a scan have the same; empty: none
  virtual void use_stored(const ScanSettings& settings, const std::filesystem::path& begun) = 0;

  /// Copies the map of the sensor's depth error into the folder of a new scan, if there is one.
  virtual void keep_sensor_map(const std::filesystem::path& folder) = 0;

  /// Returns the part of a new scan that is known before a device is opened.
  virtual Scan plan(const ScanSettings& settings) = 0;

  /// Completes a planned scan with the data that all its snapshots share.
  /// @param folder  the scan's, which may contain a sensor map
  virtual void begin(Scan& scan, const ScanSettings& settings,
                     const std::filesystem::path& folder) = 0;

  /// Prepares for the next stop of a scan that was interrupted.
  /// @param stored  its snapshots so far
  /// @return whether they are added to the model while the platform turns
  virtual bool resume(const Scan& scan, const SnapshotSource& stored) = 0;

  /// Turns to a stop, takes its depth image or pictures, and stores them: they and the scan.json
  /// that names them are on the disk when this returns.
  /// @param angle  of the platform there, radians
  /// @return nullopt if stopped first
  /// @throws Error "sensor-...", "turntable-...", "disk-full", "write-failed"
  virtual std::optional<TakenStop> take(const Stop& at, double angle, const ScanSettings& settings,
                                        const std::filesystem::path& folder, Scan& scan,
                                        const std::stop_token& stop,
                                        const ScanObserver& observer) = 0;

  /// Takes the last look of a turn; see last_look.hpp. @return nullopt if there is none
  virtual std::optional<DepthFrame> look_again(const ScanSettings& settings,
                                               const std::stop_token& stop,
                                               const ScanObserver& observer) = 0;

  /// Whether a scan has the intrinsics of the rig's sensor, or the lens and lasers of its camera.
  /// Planes of lasers are not compared: they may have been measured since the scan began.
  virtual bool has_sensor_of(const Scan& scan, const ScanSettings& settings) = 0;

  /// Takes a turn and solves the sensor's pose from it, as `measure_turn` and `measure_laser_turn`.
  virtual std::optional<TurnReport> measure_turn(const ScanSettings& settings, int threads,
                                                 const std::stop_token& stop,
                                                 const ScanObserver& observer) = 0;

  /// Takes views of a printed board until they suffice or `stop` is requested, and solves the lens.
  /// @param square  metres: side of the board's squares, for a depth sensor
  /// @return nullopt if `on_solving` gives up
  /// @throws Error "sensor-other"  if the sensor has no serial number, by which a lens is kept, or
  ///                               its pictures have another size than the settings say
  virtual std::optional<BoardResult> measure_board(double square, const std::stop_token& stop,
                                                   const BoardObserver& observer) = 0;

  /// Makes the record of an accepted pose, with the current time.
  /// @param lasers  with the planes that belong to the pose; empty: a depth sensor
  virtual PoseRecord to_record(const CalibrationReport& report, PoseOrigin origin,
                               const ScanSettings& settings, const std::vector<Laser>& lasers) = 0;

 protected:
  explicit Capture(Rig& rig) : rig_(rig) {}

  Rig& rig_;  // NOLINT
};

/// Makes the capture of a rig.
/// @param data         the data folder
/// @param calibration  of `use_stored`, whose calls need it
std::unique_ptr<Capture> make_capture(Rig& rig, std::filesystem::path data = {},
                                      const CalibrationStore* calibration = nullptr);

/// Checks that a scan can be continued with this rig.
/// @throws Error "sensor-other"
void expect_same_sensor(const Scan& scan, const ScanSettings& settings, Capture& capture);

}  // namespace octurn
