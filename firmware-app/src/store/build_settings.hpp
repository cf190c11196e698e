#pragma once

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "octurn/json_object.hpp"
#include "settings/field.hpp"
#include "settings/scan_settings.hpp"

namespace octurn {

/// The settings of a build: the scan settings that need no new capture, and two of its own.
struct BuildSettings {
  ScanSettings scan = {};         ///< only the settings of `model_fields` are used
  std::optional<int> level = {};  ///< `intersection` only: draws the surface of this coarser level
  /// Sensor pose to use instead of the scan's: optical frame to platform frame, metres.
  std::optional<Eigen::Isometry3d> platform_from_sensor = {};
};

/// All these settings, each with its key, unit and range.
std::vector<Field> fields(BuildSettings& settings, const SettingRanges& ranges = requested_ranges);

nlohmann::json to_json(const BuildSettings& settings);

/// Reads the settings of a new build; a missing key has the value of `defaults`.
/// @throws Error "bad-settings"  with the key, its value and the allowed range; also for an unknown
///                               key
BuildSettings build_settings_from(const nlohmann::json& object, const BuildSettings& defaults);

/// Reads the settings of a stored build, with `stored_ranges`. @throws Error  as above, with the
/// code of `object`
BuildSettings stored_build_settings_from(const JsonValue& object);

}  // namespace octurn
