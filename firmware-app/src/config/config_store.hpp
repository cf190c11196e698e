#pragma once

#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "config.hpp"
#include "config/stored_settings.hpp"

namespace octurn {

/// What the page's settings stand between.
struct ConfigLayers {
  Config file = {};                                 ///< octurn.json, over the defaults
  nlohmann::json given = nlohmann::json::object();  ///< command line, by its keys in octurn.json
};

/// The configuration in force, of four layers: the defaults, octurn.json, the page's settings.json
/// in the folder `data`, and the command line. Keeps what the page sets. A scan's settings and the
/// names of this host are in force at once, all else with the next ConfigStore. Any thread may call
/// anything.
class ConfigStore {
 public:
  /// A damaged settings.json is no error: `trouble` then tells of it.
  /// @throws Error "bad-settings"  of the command line
  explicit ConfigStore(ConfigLayers layers);

  /// What is in force.
  Config config() const;

  /// Without the page's settings: what a key that is removed goes back to.
  const Config& preset() const { return preset_; }

  /// What the page has set.
  nlohmann::json stored() const;

  /// What is wrong with settings.json; empty: nothing.
  std::string trouble() const;

  /// Merges a change into the page's settings; null removes a key.
  /// @throws Error "bad-settings", "disk-full", "write-failed"  and nothing has changed
  void change(const nlohmann::json& change);

  /// Replaces all of the page's settings. @throws Error  as above
  void replace(const nlohmann::json& values);

  /// Keys whose setting is not in force yet, such as "turntable.gear_ratio".
  std::vector<std::string> restart_needed() const;

  /// The daemon serves: the settings are good. @throws Error "disk-full", "write-failed"
  void keep_as_good() const;

  /// Puts the settings that the daemon served with last in the place of those that it cannot serve
  /// with. @return false if they are the same
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

/// Who may open the page, as the page itself has set it; over `password_file` if it is there.
std::filesystem::path own_password_file(const Config& config);

/// Whether a setting is in force at once. @param key  in octurn.json, an outermost one
bool applies_at_once(std::string_view key);

/// JSON Schema of octurn.json, with "x-restart" for keys that wait for the next start. Without what
/// the rig is built of: that is measured beside it, and the page cannot set it.
nlohmann::json config_schema();

}  // namespace octurn
