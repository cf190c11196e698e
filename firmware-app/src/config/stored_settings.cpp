#include "config/stored_settings.hpp"

#include <algorithm>
#include <optional>
#include <string>

#include "config/page_keys.hpp"
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

void write_stored_settings(const fs::path& data, const json& values) {
  write_file(data / settings_file, values.dump(2) + "\n");
}

void write_last_good_settings(const fs::path& data, const json& values) {
  const FileContent last = read_object(data / last_good_file);
  if (last.values != values) {
    write_file(data / last_good_file, values.dump(2) + "\n");
  }
}

json read_last_good_settings(const fs::path& data, const Config& base) {
  const FileContent last = read_object(data / last_good_file);
  return last.values && refusal(base, *last.values).empty() ? *last.values : json::object();
}

json merged(json values, const json& change) {
  values.merge_patch(change);
  if (values.is_object()) {
    remove_empty_objects(values);
  }
  return values;
}

}  // namespace octurn
