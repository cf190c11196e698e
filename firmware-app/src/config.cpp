#include "config.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "octurn/error.hpp"
#include "settings/field.hpp"

namespace octurn {
namespace {

using nlohmann::json;

/// Returns the defaults. In a systemd unit, `data` is the folder that StateDirectory= assigns.
Config defaults() {
  Config config;
  if (const char* state = std::getenv("STATE_DIRECTORY"); state != nullptr && *state != '\0') {
    config.data = state;
  }
  return config;
}

/// Reads the sensor's settings first, because other defaults depend on the kind of sensor.
Config config_from(const json& object, const std::optional<SensorKind>& sensor) {
  JsonObject keys(object, ErrorCode::bad_config, "");
  Config config = defaults();
  read_fields(keys, sensor_fields(config));
  config.sensor = sensor.value_or(config.sensor);
  if (config.sensor == SensorKind::laser_line) {
    use_laser_capture_defaults(config.scan);
    config.turntable.settle_time = laser_settle_time;
  }
  const SensorKind chosen = config.sensor;
  read_fields(keys, fields(config));
  config.sensor = chosen;
  expect_own_lines(keys, config);
  if (config.sensor == SensorKind::laser_line) {
    config.scan.platform_from_sensor = config.laser.platform_from_sensor;
  }
  keys.refuse_unread();
  return config;
}

/// IP addresses, and no names, which would have to be resolved at each request.
Access addresses(std::vector<std::string>& value) {
  Access access = texts(value);
  access.read = [read = access.read, &value](const JsonValue& given) {
    read(given);
    in6_addr bytes{};
    const auto is_address = [&](const std::string& text) {
      return ::inet_pton(AF_INET, text.c_str(), &bytes) == 1 ||
             ::inet_pton(AF_INET6, text.c_str(), &bytes) == 1;
    };
    if (!std::ranges::all_of(value, is_address)) {
      given.refuse("an array of IP addresses");
    }
  };
  return access;
}

std::vector<Field> access_fields(Config& config) {
  return {
      {.key = "host_names",
       .help = "names that the page may be opened by, besides the local ones",
       .access = texts(config.host_names)},
      {.key = "trusted_proxies",
       .help = "IP addresses of proxies whose headers X-Forwarded-Host and X-Forwarded-For are "
               "believed; others' are ignored",
       .access = addresses(config.http.trusted_proxies)},
      {.key = "password_file",
       .unit = "file",
       .help = "file with the page's password, below; empty: everybody may open the page",
       .access = path(config.http.password_file, 0)},
  };
}

std::vector<Field> nested_fields(Config& config) {
  return {
      {.key = "scan",
       .help = "a scan's settings that its start does not give, below",
       .access =
           object(fields(config.scan), [&](JsonObject& keys) { check_leaf(keys, config.scan); })},
      {.key = "turntable",
       .help = "the stepper, below",
       .access = object(fields(config.turntable),
                        [&](JsonObject& keys) { check_stepper_settings(keys, config.turntable); })},
  };
}

}  // namespace

void expect_own_lines(const JsonObject& keys, const Config& config) {
  if (config.sensor != SensorKind::laser_line) {
    return;
  }
  const std::vector<NamedLine> turntable = to_gpio_lines(config.turntable);
  for (const std::string& line : to_gpio_names(config.laser)) {
    if (std::ranges::find(turntable, line, &NamedLine::name) != turntable.end()) {
      keys.refuse("laser", line, "on a GPIO line that the turntable does not use");
    }
  }
}

std::vector<Field> network_fields(Config& config) {
  return {
      {.key = "listen",
       .unit = "address",
       .help = "where the page is served; 0.0.0.0 is every network",
       .access = text(config.http.address)},
      {.key = "port",
       .help = "of the page; 0 is any free one",
       .access = whole(config.http.port, 0, 65535)},
  };
}

std::vector<Field> data_fields(Config& config) {
  return {{.key = "data",
           .unit = "folder",
           .help = "where scans are kept",
           .access = path(config.data, 1),
           .default_text = "`\"/var/lib/octurn\"`"}};
}

std::vector<Field> sensor_fields(Config& config) {
  return {
      {.key = "sensor",
       .help = "kind of sensor: depth is a depth sensor, laser-line a camera with line lasers",
       .access = choice(config.sensor, {SensorKind::depth, SensorKind::laser_line})},
      {.key = "keep_sensor_on",
       .help = "keep the sensor on between scans, so that it stays warm; else it is switched off "
               "half a minute after its last use",
       .access = flag(config.keep_sensor_on)},
      {.key = "laser",
       .help = "the camera and its lasers, below",
       .access = object(fields(config.laser),
                        [&](JsonObject& keys) { check_laser_settings(keys, config.laser); })},
  };
}

std::vector<Field> fields(Config& config) {
  std::vector<Field> all = network_fields(config);
  for (const std::vector<Field>& more :
       {access_fields(config), data_fields(config), fields(config.limits), nested_fields(config),
        sensor_fields(config)}) {
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

Config read_config(const std::filesystem::path& file, const std::optional<SensorKind>& sensor) {
  std::ifstream stream(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream) {
    throw Error(ErrorCode::bad_config, file.string() + ": cannot be read",
                "Check that it exists and that this program may read it.");
  }
  try {
    return config_from(parse_json(text, ErrorCode::bad_config, "it"), sensor);
  } catch (const Error& error) {
    throw Error(ErrorCode::bad_config, file.string() + ": " + error.what(), error.hint());
  }
}

json to_json(const Config& config) {
  Config copy = config;
  return to_json(fields(copy));
}

Config chosen_config(const std::optional<std::filesystem::path>& file,
                     const std::optional<SensorKind>& sensor) {
  if (file) {
    return read_config(*file, sensor);
  }
  return std::filesystem::exists(default_config_file) ? read_config(default_config_file, sensor)
                                                      : config_from(json::object(), sensor);
}

}  // namespace octurn
