#include "config.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "octurn/error.hpp"
#include "octurn/json_object.hpp"
#include "octurn/units.hpp"

namespace octurn {
namespace {

using nlohmann::json;

/// With the folder that systemd gives a service (StateDirectory=), if it runs as one.
Config defaults() {
  Config config;
  if (const char* state = std::getenv("STATE_DIRECTORY"); state != nullptr && *state != '\0') {
    config.data = state;
  }
  return config;
}

std::vector<std::string> names_from(const JsonObject& keys, const json& names) {
  const auto is_text = [](const json& name) { return name.is_string(); };
  if (!names.is_array() || !std::ranges::all_of(names, is_text)) {
    keys.refuse("host_names", names, "an array of texts");
  }
  return names.get<std::vector<std::string>>();
}

Config config_from(const json& object) {
  JsonObject keys(object, "bad-config", "");
  Config config = defaults();
  config.http.address = keys.text("listen").value_or(config.http.address);
  config.http.port = keys.whole_number("port", 0, 65535).value_or(config.http.port);
  config.http.password_file = keys.text("password_file").value_or("");
  config.data = keys.text("data").value_or(config.data.string());
  config.limits.threads = keys.whole_number("threads", 1, 256).value_or(config.limits.threads);
  if (const auto mb = keys.number("memory_limit_mb", 32, 1e6)) {
    config.limits.memory_bytes = static_cast<std::size_t>(bytes_from_mb(*mb));
  }
  if (const json* names = keys.find("host_names")) {
    config.host_names = names_from(keys, *names);
  }
  if (const json* scan = keys.find("scan")) {
    config.scan = settings_from(*scan, config.scan, "scan");
  }
  if (const json* turntable = keys.find("turntable")) {
    config.turntable = stepper_settings_from(*turntable);
  }
  keys.refuse_unread();
  return config;
}

}  // namespace

Config read_config(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream) {
    throw Error("bad-config", file.string() + ": cannot be read",
                "Check that it exists and that this program may read it.");
  }
  try {
    return config_from(parse_json(text, "bad-config", "it"));
  } catch (const Error& error) {
    throw Error("bad-config", file.string() + ": " + error.what(), error.hint());
  }
}

json json_of(const Config& config) {
  return {{"listen", config.http.address},
          {"port", config.http.port},
          {"host_names", config.host_names},
          {"password_file", config.http.password_file.string()},
          {"data", config.data.string()},
          {"threads", config.limits.threads},
          {"memory_limit_mb", mb_from_bytes(static_cast<double>(config.limits.memory_bytes))},
          {"scan", json_of(config.scan)},
          {"turntable", json_of(config.turntable)}};
}

Config chosen_config(const std::optional<std::filesystem::path>& file) {
  if (file) {
    return read_config(*file);
  }
  return std::filesystem::exists(default_config_file) ? read_config(default_config_file)
                                                      : defaults();
}

}  // namespace octurn
