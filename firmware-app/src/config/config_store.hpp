#pragma once

#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "config.hpp"
#include "config/stored_settings.hpp"

namespace octurn {

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

}  // namespace octurn
