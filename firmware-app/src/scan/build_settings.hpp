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

/// What a stored scan is built with: every setting that needs no new capture.
struct BuildSettings {
  ScanSettings scan = {};         ///< of which those of the model count
  std::optional<int> level = {};  ///< surface of this coarser level; intersection
  /// Taken as told, optical frame to platform frame, metres; nothing: as the scan was told.
  std::optional<Eigen::Isometry3d> platform_from_sensor = {};
};

/// Every one of these settings, with its key, unit and range.
std::vector<Field> fields(BuildSettings& settings);

nlohmann::json to_json(const BuildSettings& settings);

/// Reads the settings of a build to come; a key that is not given is as in `defaults`.
/// @throws Error "bad-settings"  that names the key, its value and what is allowed; also for a key
///                               that is none
BuildSettings build_settings_from(const nlohmann::json& object, const BuildSettings& defaults);

/// Reads the settings of a build that was made. @throws Error  as above, of the value's code
BuildSettings stored_build_settings_from(const JsonValue& object);

}  // namespace octurn
