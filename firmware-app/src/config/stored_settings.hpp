#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "config.hpp"

namespace octurn {

/// The settings that the page has set, in the form of octurn.json.
struct StoredSettings {
  nlohmann::json values = nlohmann::json::object();
  std::string trouble = {};  ///< why `values` differ from the file; empty if they do not
};

/// A configuration with some settings changed.
///
/// @param values  in the form of octurn.json
/// @throws Error "bad-settings"  that names the key, its value and what is allowed
Config with_settings(const Config& base, const nlohmann::json& values);

/// The same with settings that the page has set.
/// @param values  without `fixed_keys`; of `laser` only `laser_keys_of_page`
Config with_page_settings(const Config& base, const nlohmann::json& values);

/// Reads `data/settings.json`. Does not throw for a damaged or refused file: it then returns the
/// settings that the daemon last served with, or else the accepted part of the file.
///
/// @param base  the configuration that the settings override and may not contradict
StoredSettings read_stored_settings(const std::filesystem::path& data, const Config& base);

/// Writes `data/settings.json`, whole or not at all. @throws Error "disk-full", "write-failed"
void write_stored_settings(const std::filesystem::path& data, const nlohmann::json& values);

/// Stores settings as the ones that the daemon last served with. @throws Error  as above
void write_last_good_settings(const std::filesystem::path& data, const nlohmann::json& values);

/// The settings that the daemon last served with; empty if they are unknown or refused.
nlohmann::json read_last_good_settings(const std::filesystem::path& data, const Config& base);

/// Merges a change into settings (RFC 7396): null removes a key, an object is merged key by key.
/// Objects that become empty are removed.
nlohmann::json merged(nlohmann::json values, const nlohmann::json& change);

}  // namespace octurn
