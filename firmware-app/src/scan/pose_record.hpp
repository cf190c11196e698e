#pragma once

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "octurn/calibrate.hpp"
#include "octurn/json_object.hpp"

namespace octurn {

/// Origin of a sensor's pose.
enum class PoseOrigin {
  drawing,   ///< the default: the rig as drawn
  settings,  ///< octurn.json
  page,      ///< a person, by hand
  turn,      ///< solved from a calibration turn
  scan,      ///< solved from a scan
};

/// The origin's name in files: "default", "settings", "page", "turn", "scan".
std::string_view to_string(PoseOrigin origin);

/// Uncertainty of a solved pose, and its distance from the one before.
struct PoseFigures {
  double shift = 0;            ///< metres
  double tilt = 0;             ///< radians
  double position_sigma = 0;   ///< metres
  double direction_sigma = 0;  ///< radians
  double before = 0;           ///< metres: as in `CalibrationReport`
  double after = 0;            ///< metres: the same
};

/// A pose of the sensor that is in force, or was.
struct PoseRecord {
  /// Optical frame to platform frame, metres of scaled depths.
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();
  PoseOrigin origin = PoseOrigin::drawing;
  std::string at = {};                      ///< UTC, as in ISO 8601; empty: from the beginning
  std::optional<PoseFigures> figures = {};  ///< of a pose that was solved
  double scale = 1;                         ///< of the sensor's depths
  std::string camera = {};  ///< serial number of a camera with lasers; empty: of a depth sensor
  std::vector<Laser> lasers = {};  ///< their planes with this pose; empty: those of the settings
};

/// The record of a pose that is accepted now. @param scale  of the depths that it was solved from
PoseRecord to_record(const CalibrationReport& report, PoseOrigin origin, double scale);

/// The same of a camera, whose lasers' planes were solved with it.
PoseRecord to_record(const CalibrationReport& report, PoseOrigin origin, std::string camera,
                     std::vector<Laser> lasers);

/// A record as files and the API have it.
nlohmann::json to_json(const PoseRecord& record);

/// The record of such JSON. @throws Error  of the value's code
PoseRecord to_record(const JsonValue& object);

}  // namespace octurn
