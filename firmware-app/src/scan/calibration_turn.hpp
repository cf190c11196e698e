#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "failure.hpp"
#include "octurn/calibrate.hpp"
#include "octurn/lens.hpp"
#include "octurn/sensor_map.hpp"
#include "scan/board_watch.hpp"
#include "scan/rig.hpp"
#include "scan/scan_observer.hpp"
#include "scan/slice.hpp"

namespace octurn {

/// Stops of a turn that measures the sensor's pose. With fewer the object is seen from too few
/// sides; each one more takes 0.6 MB for its depth image.
inline constexpr int min_calibration_stops = 4;
inline constexpr int max_calibration_stops = 72;
inline constexpr int default_calibration_stops = 24;

/// The sensor's pose as solved from a turn.
struct TurnReport {
  CalibrationReport calibration = {};
  std::vector<double> angles = {};  ///< of the stops as told, radians
  Slice before = {};                ///< with the told pose
  Slice after = {};                 ///< with the solved one; empty if that is refused
  std::vector<Laser> told = {};     ///< of a rig with lasers: with the told planes
  std::vector<Laser> lasers = {};   ///< the same, with the solved ones
  bool replaces_told = false;       ///< accepted, and more than what the rig was told already
};

/// The progress and result of a measurement of the rig.
struct CalibrationRun {
  enum class Kind { turn, wall, lens };
  enum class State { running, done, refused, failed, cancelled };
  enum class Phase { turning, solving, looking };

  Kind kind = Kind::turn;
  State state = State::running;
  Phase phase = Phase::turning;
  int stop = 0;  ///< number done: stops; frames of a wall; views of a board
  int stops = 0;
  std::optional<TurnReport> report = {};     ///< of a turn
  std::optional<SensorMapReport> wall = {};  ///< of a wall; its map has no pixels here
  std::optional<BoardLook> look = {};        ///< of a lens, while a board is looked at
  std::optional<LensReport> lens = {};       ///< of a lens
  std::string camera = {};                   ///< of a lens: the camera's serial number
  std::optional<Failure> failure = {};
};

/// A run as the API has it.
nlohmann::json to_json(const CalibrationRun& run);

/// Takes the depth images of one turn, and solves the sensor's pose from them. Nothing is stored.
///
/// @param settings  `snapshots` are the stops; the told pose is theirs
/// @param map       of the sensor's own error, by which the depth images are corrected; may be null
/// @return nothing if stopped first
/// @throws Error "sensor-...", "turntable-..."
std::optional<TurnReport> measure_turn(const ScanSettings& settings, const SensorMap* map,
                                       int threads, Rig& rig, const std::stop_token& stop,
                                       const ScanObserver& observer);

}  // namespace octurn
