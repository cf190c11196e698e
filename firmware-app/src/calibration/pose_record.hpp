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
  page,      ///< entered by a person on the page
  turn,      ///< solved from a calibration turn
  scan,      ///< solved from a scan
};

/// The origin's name in files: "default", "settings", "page", "turn", "scan".
std::string_view to_string(PoseOrigin origin);

/// Uncertainty of a solved pose, and its distance from the configured one. See `CalibrationReport`.
struct PoseFigures {
  double shift = 0;            ///< metres, of the axis on the platform
  double tilt = 0;             ///< radians, of the axis
  double position_sigma = 0;   ///< metres
  double direction_sigma = 0;  ///< radians
  double before = 0;           ///< metres: residual with the configured pose
  double after = 0;            ///< metres: residual with the solved pose
};

/// A pose of the sensor that is in force, or was.
struct PoseRecord {
  /// Optical frame to platform frame, metres of scaled depths.
  Eigen::Isometry3d platform_from_sensor = Eigen::Isometry3d::Identity();
  PoseOrigin origin = PoseOrigin::drawing;
  std::string at = {};                      ///< UTC, as in ISO 8601; empty: never changed
  std::optional<PoseFigures> figures = {};  ///< of a solved pose
  double scale = 1;                         ///< factor of the sensor's depths
  std::string camera = {};  ///< serial number of a camera with lasers; empty: of a depth sensor
  std::vector<Laser> lasers = {};  ///< their planes with this pose; empty: those of the settings
  /// Serial number of the depth sensor with whose optics of the time `optics_at` the pose was
  /// solved: it holds only with them. Empty: with the sensor's own, or entered by a person.
  std::string optics_of = {};
  std::string optics_at = {};
};

/// Makes the record of an accepted pose, with the current time.
/// @param scale  factor of the depths from which the pose was solved
PoseRecord to_record(const CalibrationReport& report, PoseOrigin origin, double scale);

/// The same for a camera with lasers, whose planes were solved with its pose.
PoseRecord to_record(const CalibrationReport& report, PoseOrigin origin, std::string camera,
                     std::vector<Laser> lasers);

/// JSON of a record, for files and the API.
nlohmann::json to_json(const PoseRecord& record);

/// Parses that JSON. @throws Error  with the code of `object`
PoseRecord to_record(const JsonValue& object);

}  // namespace octurn
