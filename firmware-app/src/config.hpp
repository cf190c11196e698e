#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "http_options.hpp"
#include "settings/laser_settings.hpp"
#include "settings/scan_settings.hpp"
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
  bool keep_sensor_on = false;  ///< between scans
  LaserSettings laser = {};     ///< used if `sensor` is laser_line
};

/// The default configuration file. It need not exist.
inline constexpr const char* default_config_file = "/etc/octurn/octurn.json";

/// Reads a configuration file, such as `{"port": 80, "scan": {"snapshots": 60}}`. docs/settings.md
/// lists the keys.
///
/// @param sensor  overrides the file's key "sensor". Settings that the file leaves out get the
///                defaults of this kind of sensor
/// @throws Error "bad-config"  that names file and key, the value and what is allowed; also for an
///                             unknown key
Config read_config(const std::filesystem::path& file, const std::optional<SensorKind>& sensor = {});

class JsonObject;

/// Refuses a laser that shares a GPIO line with the turntable, whose pulses would switch it on.
/// @param keys  JSON of the configuration, for error messages
void expect_own_lines(const JsonObject& keys, const Config& config);

struct Field;

/// All settings of the file.
std::vector<Field> fields(Config& config);
/// The settings of the HTTP listener: `listen` and `port`.
std::vector<Field> network_fields(Config& config);
/// The setting `data`, the folder of scans.
std::vector<Field> data_fields(Config& config);
/// The settings `sensor`, `keep_sensor_on` and `laser`.
std::vector<Field> sensor_fields(Config& config);

/// The configuration in the form of the file, with every key. It contains no secret.
nlohmann::json to_json(const Config& config);

/// Reads the named file, or else the default file if it exists. Without either: the defaults.
/// @param sensor  as above
Config chosen_config(const std::optional<std::filesystem::path>& file,
                     const std::optional<SensorKind>& sensor = {});

}  // namespace octurn
