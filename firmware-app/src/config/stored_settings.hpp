#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "config.hpp"

namespace octurn {

/// What the page has set, in the form of octurn.json.
struct StoredSettings {
  nlohmann::json values = nlohmann::json::object();
  std::string trouble = {};  ///< why these are not what the file holds; empty: they are
};

/// A configuration with some settings changed.
///
/// @param values  in the form of octurn.json, without `data`, `password_file`, `sensor` and `laser`
/// @throws Error "bad-settings"  that names the key, its value and what is allowed
Config with_settings(const Config& base, const nlohmann::json& values);

/// Reads `data/settings.json`. A file that is damaged or refused never throws: then the settings
/// are those that the daemon served with last, or else the part of the file that can be used.
///
/// @param base  what the settings go over, which they have to agree with
StoredSettings read_stored_settings(const std::filesystem::path& data, const Config& base);

/// Writes `data/settings.json`, whole or not at all. @throws Error "disk-full", "write-failed"
void write_stored_settings(const std::filesystem::path& data, const nlohmann::json& values);

/// Keeps settings as those that the daemon has served with. @throws Error  as above
void write_last_good_settings(const std::filesystem::path& data, const nlohmann::json& values);

/// The settings that the daemon served with last; none if that is not known.
nlohmann::json read_last_good_settings(const std::filesystem::path& data, const Config& base);

/// Merges a change into settings (RFC 7396): null removes a key, an object is merged key by key.
/// Objects that become empty are removed.
nlohmann::json merged(nlohmann::json values, const nlohmann::json& change);

}  // namespace octurn
