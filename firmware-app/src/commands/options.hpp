#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "settings/field.hpp"

namespace CLI {
class App;
}

namespace octurn {

/// The option's name: "--leaf-size-mm" for "leaf_size_mm".
std::string option_name(std::string_view key);

/// Adds an option for each setting. Parsing stores the given values in `given` by their keys,
/// unchecked.
///
/// @param fields  with the defaults, for the help; used by this call only
/// @param given   a JSON object that outlives the parsing
void add_options(CLI::App& command, const std::vector<Field>& fields, nlohmann::json& given);

struct RigArguments;
struct ConfigArguments;

/// Adds the options of sensor and turntable.
/// @param rig     outlives the parsing
/// @param config  outlives the parsing; receives the kind of a simulated sensor
void add_rig_options(CLI::App& command, RigArguments& rig, ConfigArguments& config);

/// Adds the option of the configuration file. @param config  outlives the parsing
void add_config_option(CLI::App& command, ConfigArguments& config);

/// Adds the options of the configuration file and of the folder of scans, `data`.
/// @param config  outlives the parsing
void add_config_options(CLI::App& command, ConfigArguments& config);

/// Refuses options of the other method. @throws Error "bad-settings"  that names the option
void expect_options_of_method(const nlohmann::json& given, const std::vector<Field>& fields,
                              std::string_view method);

}  // namespace octurn
