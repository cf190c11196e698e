#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "calibration/board_watch.hpp"
#include "capture/rig.hpp"
#include "capture/scan_observer.hpp"
#include "failure.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/lens.hpp"
#include "octurn/sensor_map.hpp"

namespace octurn {

/// Cross-section of the object: all stops' points within 1 mm of the plane y = 0 of its frame, x
/// and z, metres.
using Slice = std::vector<Eigen::Vector2d>;

/// Returns every n-th point, at most 3000: enough for a picture.
Slice thinned(const Slice& slice);

/// Number of stops of a turn that measures the sensor's pose. Fewer show too few sides of the
/// object. Each stop's depth image is held in memory, 0.6 MB.
inline constexpr int min_calibration_stops = 4;
inline constexpr int max_calibration_stops = 72;
inline constexpr int default_calibration_stops = 24;

/// The sensor's pose as solved from a turn.
struct TurnReport {
  CalibrationReport calibration = {};
  std::vector<double> angles = {};  ///< commanded angles of the stops, radians
  Slice before = {};                ///< with the configured pose
  Slice after = {};                 ///< with the solved pose; empty if it was refused
  Eigen::Isometry3d configured_pose = Eigen::Isometry3d::Identity();  ///< platform from sensor
  std::vector<Laser> configured_lasers = {};  ///< with the configured planes; empty: a depth sensor
  std::vector<Laser> lasers = {};             ///< with the solved planes
  bool replaces_told = false;  ///< accepted, and differs from the configured pose or planes
};

/// The progress and result of a measurement of the rig.
struct CalibrationRun {
  enum class Kind { turn, wall, lens };
  enum class State { running, done, refused, failed, cancelled };
  enum class Phase { turning, solving, looking };

  Kind kind = Kind::turn;
  State state = State::running;
  Phase phase = Phase::turning;
  int stop = 0;  ///< number done: stops of a turn, frames of a wall, views of a board
  int stops = 0;
  std::optional<TurnReport> report = {};     ///< of a turn
  std::optional<SensorMapReport> wall = {};  ///< of a wall; without the map's pixels
  std::optional<BoardLook> look = {};        ///< of a lens, while views are taken
  std::optional<LensReport> lens = {};       ///< of a lens
  std::optional<SolvedOptics> optics = {};   ///< of a depth sensor's lens, if it is accepted
  std::string camera = {};                   ///< of a lens: the camera's serial number
  std::optional<Failure> failure = {};
};

/// JSON of a run, for the API.
nlohmann::json to_json(const CalibrationRun& run);

/// Takes the depth images of one turn, and solves the sensor's pose from them; its optics as well,
/// if the rig's are not known. Nothing is stored.
///
/// @param settings  `snapshots` is the number of stops; `platform_from_sensor` the initial pose
/// @param map       map of the sensor's depth error, which is subtracted; may be null
/// @return nullopt if stopped first
/// @throws Error "sensor-...", "turntable-..."
std::optional<TurnReport> measure_turn(const ScanSettings& settings,
                                       const std::shared_ptr<const SensorMap>& map, int threads,
                                       Rig& rig, const std::stop_token& stop,
                                       const ScanObserver& observer);

/// Takes the pictures of one turn with a camera and lasers, and solves the camera's pose and the
/// lasers' planes from them. Nothing is stored.
///
/// @param settings  `snapshots` is the number of stops
/// @param data      the data folder, which holds the pictures until this returns
/// @return nullopt if stopped first
/// @throws Error "sensor-...", "turntable-...", "disk-full", "write-failed"
std::optional<TurnReport> measure_laser_turn(const ScanSettings& settings,
                                             const std::filesystem::path& data, int threads,
                                             Rig& rig, const std::stop_token& stop,
                                             const ScanObserver& observer);

}  // namespace octurn
