#pragma once

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "octurn/json_object.hpp"
#include "scan/scan_settings.hpp"
#include "settings/field.hpp"

namespace octurn {

/// The settings of a build: those of a scan that need no new capture.
struct BuildSettings {
  ScanSettings scan = {};         ///< only those of the model are used
  std::optional<int> level = {};  ///< `intersection` only: draws the surface of this coarser level
  /// The told pose, optical frame to platform frame, metres; nothing: that of the scan.
  std::optional<Eigen::Isometry3d> platform_from_sensor = {};
};

/// All these settings, each with its key, unit and range.
std::vector<Field> fields(BuildSettings& settings);

nlohmann::json to_json(const BuildSettings& settings);

/// Reads the settings of a new build; a missing key has the value of `defaults`.
/// @throws Error "bad-settings"  with the key, its value and the allowed range; also for an unknown
///                               key
BuildSettings build_settings_from(const nlohmann::json& object, const BuildSettings& defaults);

/// Reads the settings of a stored build. @throws Error  as above, with the value's code
BuildSettings stored_build_settings_from(const JsonValue& object);

}  // namespace octurn
