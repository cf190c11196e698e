#include "config/config_store.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "log.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"
#include "octurn/json_object.hpp"
#include "settings/field.hpp"

namespace octurn {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* settings_file = "settings.json";
constexpr const char* last_good_file = "settings.last.json";
constexpr std::size_t max_file_bytes = std::size_t{1} << 20U;  // a request has at most 64 KiB

[[noreturn]] void refuse_fixed(const std::string& key) {
  throw Error(ErrorCode::bad_settings, "\"" + key + "\": cannot be set from the page",
              "It is a key of octurn.json.");
}

void refuse_fixed(const json& values) {
  for (const auto& [key, value] : values.items()) {
    if (std::ranges::find(fixed_keys, key) != fixed_keys.end()) {
      refuse_fixed(key);
    }
    if (key != "laser" || !value.is_object()) {
      continue;
    }
    for (const auto& [inner, setting] : value.items()) {
      if (std::ranges::find(laser_keys_of_page, inner) == laser_keys_of_page.end()) {
        refuse_fixed("laser." + inner);
      }
    }
  }
}

/// The content of a settings file, or the error in it.
struct FileContent {
  std::optional<json> values = {};
  std::string trouble = {};  ///< empty: no error, or no file
};

FileContent read_object(const fs::path& file) {
  FileContent content;
  try {
    const std::optional<std::string> text = read_regular_file(file, max_file_bytes);
    if (!text) {
      return content;
    }
    json values = parse_json(*text, ErrorCode::bad_settings, "it");
    if (!values.is_object()) {
      throw Error(ErrorCode::bad_settings, "it is no JSON object");
    }
    content.values = std::move(values);
  } catch (const Error& error) {
    content.trouble = file.string() + ": " + error.what();
  }
  return content;
}

/// @return why the settings are refused; empty if they are accepted
std::string refusal(const Config& base, const json& values) {
  try {
    with_page_settings(base, values);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

/// Splits settings into changes of one setting each, also within nested objects.
std::vector<json> single_settings(const json& values) {
  std::vector<json> singles;
  for (const auto& [key, value] : values.items()) {
    if (!value.is_object()) {
      singles.push_back({{key, value}});
      continue;
    }
    for (const auto& [inner, setting] : value.items()) {
      singles.push_back({{key, {{inner, setting}}}});
    }
  }
  return singles;
}

/// Keeps the settings that are accepted. Others may be of a later version, or contradict
/// octurn.json.
json usable_part(const Config& base, const json& values) {
  json usable = json::object();
  for (const json& single : single_settings(values)) {
    json tried = merged(usable, single);
    if (refusal(base, tried).empty()) {
      usable = std::move(tried);
    }
  }
  return usable;
}

void remove_empty_objects(json& values) {
  for (auto item = values.begin(); item != values.end();) {
    item = item->is_object() && item->empty() ? values.erase(item) : std::next(item);
  }
}

}  // namespace

Config with_settings(const Config& base, const json& values) {
  JsonObject keys(values, ErrorCode::bad_settings, "");
  Config config = base;
  read_fields(keys, fields(config));
  keys.refuse_unread();
  expect_own_lines(keys, config);
  if (const json* scan = keys.find("scan")) {
    check_clip(JsonObject(*scan, ErrorCode::bad_settings, "scan"), config.scan);
  }
  return config;
}

Config with_page_settings(const Config& base, const json& values) {
  refuse_fixed(values);
  return with_settings(base, values);
}

namespace {

/// Reads `data/settings.json`. Does not throw for a damaged or refused file: it then returns the
/// settings that the daemon last served with, or else the accepted part of the file.
///
/// @param base  the configuration that the settings override and may not contradict
StoredSettings read_stored_settings(const fs::path& data, const Config& base) {
  FileContent content = read_object(data / settings_file);
  if (content.values) {
    const std::string reason = refusal(base, *content.values);
    if (reason.empty()) {
      return {.values = *std::move(content.values)};
    }
    content.trouble = (data / settings_file).string() + ": " + reason;
  } else if (content.trouble.empty()) {
    return {};
  }
  const FileContent last = read_object(data / last_good_file);
  if (last.values && refusal(base, *last.values).empty()) {
    return {.values = *last.values, .trouble = content.trouble};
  }
  return {.values = usable_part(base, content.values.value_or(json::object())),
          .trouble = content.trouble};
}

/// Writes `data/settings.json`, whole or not at all. @throws Error "disk-full", "write-failed"
void write_stored_settings(const fs::path& data, const json& values) {
  write_file(data / settings_file, values.dump(2) + "\n");
}

}  // namespace

void write_last_good_settings(const fs::path& data, const json& values) {
  const FileContent last = read_object(data / last_good_file);
  if (last.values != values) {
    write_file(data / last_good_file, values.dump(2) + "\n");
  }
}

namespace {

/// The settings that the daemon last served with; empty if they are unknown or refused.
json read_last_good_settings(const fs::path& data, const Config& base) {
  const FileContent last = read_object(data / last_good_file);
  return last.values && refusal(base, *last.values).empty() ? *last.values : json::object();
}

}  // namespace

json merged(json values, const json& change) {
  values.merge_patch(change);
  if (values.is_object()) {
    remove_empty_objects(values);
  }
  return values;
}

namespace {

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
