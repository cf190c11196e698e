#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "http_options.hpp"
#include "scan/laser_settings.hpp"
#include "scan/scan_settings.hpp"
#include "turntable/stepper_settings.hpp"

namespace octurn {

/// The configuration from `octurn.json`, with the defaults for keys that it leaves out. Options of
/// the command line override it.
struct Config {
  HttpOptions http = {};
  std::vector<std::string> host_names = {};  ///< names of this host, besides the local ones
  std::filesystem::path data = "/var/lib/octurn";
  Limits limits = {};      ///< of reconstruction
  ScanSettings scan = {};  ///< defaults of a scan
  StepperSettings turntable = {};
  SensorKind sensor = SensorKind::depth;
  LaserSettings laser = {};  ///< of a rig whose sensor is that
};

/// The default configuration file. It need not exist.
inline constexpr const char* default_config_file = "/etc/octurn/octurn.json";

/// Reads a configuration file, such as `{"port": 80, "scan": {"snapshots": 60}}`. docs/settings.md
/// lists the keys.
///
/// @param sensor  in place of the one that the file names. A scan's settings that the file does not
///                have are those of the sensor
/// @throws Error "bad-config"  that names file and key, the value and what is allowed; also for an
///                             unknown key
Config read_config(const std::filesystem::path& file, const std::optional<SensorKind>& sensor = {});

class JsonObject;

/// Refuses a laser on a line of the turntable, whose pulses would light it.
/// @param keys  of the configuration, for messages
void expect_own_lines(const JsonObject& keys, const Config& config);

struct Field;

/// All settings of the file.
std::vector<Field> fields(Config& config);
/// Where the page is served.
std::vector<Field> network_fields(Config& config);
/// Where scans are kept.
std::vector<Field> data_fields(Config& config);
/// What the rig looks with.
std::vector<Field> sensor_fields(Config& config);

/// The configuration in the form of the file, with every key. It contains no secret.
nlohmann::json to_json(const Config& config);

/// Reads the named file, or else the default file if it exists. Without either: the defaults.
/// @param sensor  as above
Config chosen_config(const std::optional<std::filesystem::path>& file,
                     const std::optional<SensorKind>& sensor = {});

}  // namespace octurn
