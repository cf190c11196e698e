#pragma once

#include <array>
#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

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

/// Stores settings as the ones that the daemon last served with.
/// @throws Error "disk-full", "write-failed"
void write_last_good_settings(const std::filesystem::path& data, const nlohmann::json& values);

/// Merges a change into settings (RFC 7396): null removes a key, an object is merged key by key.
/// Objects that become empty are removed.
nlohmann::json merged(nlohmann::json values, const nlohmann::json& change);

/// The layers of the configuration below and above the page's settings.
struct ConfigLayers {
  Config file = {};                                 ///< octurn.json, over the defaults
  nlohmann::json given = nlohmann::json::object();  ///< command line, by its keys in octurn.json
};

/// The configuration in force, merged of four layers: the defaults, octurn.json, the page's
/// settings.json in the folder `data`, and the command line. Stores the page's settings. A scan's
/// settings and the host names take effect at once, all others in the next ConfigStore.
/// Thread-safe.
class ConfigStore {
 public:
  /// A damaged settings.json does not throw: `trouble` then describes it.
  /// @throws Error "bad-settings"  for an option of the command line
  explicit ConfigStore(ConfigLayers layers);

  /// The configuration in force.
  Config config() const;

  /// The configuration without the page's settings: the values of keys that the page removes.
  const Config& preset() const { return preset_; }

  /// The settings that the page has set.
  nlohmann::json stored() const;

  /// The error in settings.json; empty if there is none.
  std::string trouble() const;

  /// Merges a change into the page's settings; null removes a key.
  /// @throws Error "bad-settings", "disk-full", "write-failed"  and nothing has changed
  void change(const nlohmann::json& change);

  /// Replaces all of the page's settings. @throws Error  as above
  void replace(const nlohmann::json& values);

  /// Keys whose setting is not in force yet, such as "turntable.gear_ratio".
  std::vector<std::string> restart_needed() const;

  /// Stores the settings as good: the daemon serves with them. Logs a warning if that fails.
  void keep_as_good() const;

  /// Puts the settings into force that the daemon last served with. Logs a warning if they cannot
  /// be stored: the next start then tries the others again.
  /// @return false if they are the current ones
  bool return_to_last_good();

 private:
  void set(const nlohmann::json& values);
  Config wanted(const nlohmann::json& values) const;

  ConfigLayers layers_;
  Config preset_;
  mutable std::mutex mutex_;  // guards what follows
  StoredSettings stored_;
  Config in_force_;
};

/// The password file that the page writes. If it exists, it overrides `password_file`.
std::filesystem::path own_password_file(const Config& config);

/// Whether a setting takes effect without a restart. @param key  top-level key of octurn.json
bool applies_at_once(std::string_view key);

/// JSON Schema of octurn.json. "x-restart" is true for keys that take effect at the next start.
/// Leaves out the keys that describe the rig's construction, which the page cannot set.
nlohmann::json config_schema();

/// Keys of octurn.json that the page may not set. Who may change settings must not decide where
/// they are stored or who else may change them. The kind of sensor is set where the rig is built.
inline constexpr std::array<std::string_view, 3> fixed_keys{"data", "password_file", "sensor"};

/// Keys of `laser` in octurn.json that the page may set: the exposure of pictures. The others are
/// the calibration of camera and lasers, and the lasers' GPIO lines.
inline constexpr std::array<std::string_view, 2> laser_keys_of_page{"exposure_ms", "gain"};

}  // namespace octurn
