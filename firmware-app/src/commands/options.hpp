#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "settings/field.hpp"

namespace octurn {

/// The option of a setting: "--leaf-size-mm" of "leaf_size_mm".
std::string option_name(std::string_view key);

/// Adds an option for each of these settings. What the command line gives is in `given` afterwards,
/// by its key, still to be checked.
///
/// @param fields  of the defaults, which the help tells; needed by this call only
/// @param given   an object; has to outlive the parsing
void add_options(CLI::App& command, const std::vector<Field>& fields, nlohmann::json& given);

/// @throws Error "bad-settings"  that names an option which the method does not have
void expect_options_of_method(const nlohmann::json& given, const std::vector<Field>& fields,
                              std::string_view method);

}  // namespace octurn
