#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "http_options.hpp"
#include "scan/scan_settings.hpp"
#include "turntable/stepper_settings.hpp"

namespace octurn {

/// What `octurn.json` says; what it leaves out is as here. The command line has the last word.
struct Config {
  HttpOptions http = {};
  std::vector<std::string> host_names = {};  ///< that the page may be opened by, besides local ones
  std::filesystem::path data = "/var/lib/octurn";
  Limits limits = {};      ///< of reconstruction
  ScanSettings scan = {};  ///< what a scan uses for settings that its start does not give
  StepperSettings turntable = {};
};

/// The file that is read unless another is named; it need not exist.
inline constexpr const char* default_config_file = "/etc/octurn/octurn.json";

/// Reads a configuration:
/// `{"listen": "0.0.0.0", "port": 8080, "host_names": [], "data": "/var/lib/octurn", "scan":
/// {...}, "turntable": {...}}`. docs/settings.md has them all.
///
/// @throws Error "bad-config" that names file and key, its value and what is allowed; also for a
/// key
///                            that is none
Config read_config(const std::filesystem::path& file);

struct Field;

/// Every setting of the file.
std::vector<Field> fields(Config& config);
/// Where the page is served.
std::vector<Field> network_fields(Config& config);
/// Where scans are kept.
std::vector<Field> data_fields(Config& config);

/// The configuration as `read_config` reads it, every key. No secret is one of them.
nlohmann::json json_of(const Config& config);

/// The configuration in the file that the command line names, or in the default one if that is
/// there, or the defaults.
Config chosen_config(const std::optional<std::filesystem::path>& file);

}  // namespace octurn
