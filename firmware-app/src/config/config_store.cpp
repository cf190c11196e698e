#include "config/config_store.hpp"

#include <string>
#include <string_view>
#include <utility>

#include "config/page_keys.hpp"
#include "log.hpp"
#include "octurn/error.hpp"
#include "settings/field.hpp"

namespace octurn {
namespace {

using nlohmann::json;

/// Applies the options of the command line to a configuration.
Config with_options(Config config, const json& given) {
  JsonObject keys(given, ErrorCode::bad_settings, "");
  read_fields(keys, network_fields(config));
  read_fields(keys, data_fields(config));
  return config;
}

/// The keys of `wanted` that differ from those of `present`.
std::vector<std::string> differences(const json& wanted, const json& present,
                                     const std::string& path) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : wanted.items()) {
    if (value == present[key] || (path.empty() && applies_at_once(key))) {
      continue;
    }
    if (!value.is_object()) {
      keys.push_back(path + key);
      continue;
    }
    for (std::string& inner : differences(value, present[key], path + key + ".")) {
      keys.push_back(std::move(inner));
    }
  }
  return keys;
}

}  // namespace

std::filesystem::path own_password_file(const Config& config) {
  return config.data / "page-password";
}

bool applies_at_once(std::string_view key) { return key == "scan" || key == "host_names"; }

json config_schema() {
  Config config;
  json schema = to_schema(fields(config));
  schema["properties"].erase("sensor");
  json& of_laser = schema["properties"]["laser"]["properties"];
  const json all = std::move(of_laser);
  of_laser = json::object();
  for (const std::string_view key : laser_keys_of_page) {
    of_laser[std::string(key)] = all.at(std::string(key));
  }
  for (const auto& [key, property] : schema["properties"].items()) {
    property["x-restart"] = !applies_at_once(key);
  }
  return schema;
}

ConfigStore::ConfigStore(ConfigLayers layers)
    : layers_(std::move(layers)),
      preset_(with_options(layers_.file, layers_.given)),
      stored_(read_stored_settings(preset_.data, layers_.file)),
      in_force_(wanted(stored_.values)) {}

/// The configuration with the page's settings between octurn.json and the command line.
Config ConfigStore::wanted(const json& values) const {
  Config config = with_options(with_page_settings(layers_.file, values), layers_.given);
  config.http.own_password_file = own_password_file(config);
  return config;
}

Config ConfigStore::config() const {
  const std::lock_guard lock(mutex_);
  return in_force_;
}

json ConfigStore::stored() const {
  const std::lock_guard lock(mutex_);
  return stored_.values;
}

std::string ConfigStore::trouble() const {
  const std::lock_guard lock(mutex_);
  return stored_.trouble;
}

void ConfigStore::change(const json& change) {
  const std::lock_guard lock(mutex_);
  if (!change.is_object()) {
    JsonValue(change, "", ErrorCode::bad_settings).refuse("an object");
  }
  set(merged(stored_.values, change));
}

void ConfigStore::replace(const json& values) {
  const std::lock_guard lock(mutex_);
  set(values);
}

/// Checks and stores the settings. Those that need no restart take effect. The caller holds
/// `mutex_`.
void ConfigStore::set(const json& values) {
  const Config next = wanted(values);  // throws if they are invalid
  write_stored_settings(preset_.data, values);
  stored_ = {.values = values};
  in_force_.scan = next.scan;
  in_force_.host_names = next.host_names;
}

std::vector<std::string> ConfigStore::restart_needed() const {
  const std::lock_guard lock(mutex_);
  return differences(to_json(wanted(stored_.values)), to_json(in_force_), "");
}

void ConfigStore::keep_as_good() const {
  const std::lock_guard lock(mutex_);
  try {
    write_last_good_settings(preset_.data, stored_.values);
  } catch (const Error& error) {
    log::warning("settings", std::string("not kept as the last good ones: ") + error.what());
  }
}

bool ConfigStore::return_to_last_good() {
  const std::lock_guard lock(mutex_);
  json last = read_last_good_settings(preset_.data, layers_.file);
  if (last == stored_.values) {
    return false;
  }
  try {
    write_stored_settings(preset_.data, last);
  } catch (const Error& error) {
    log::warning("settings", std::string("the last good ones are not stored: ") + error.what());
  }
  stored_ = {.values = std::move(last)};
  in_force_ = wanted(stored_.values);
  return true;
}

}  // namespace octurn
