#include "commands/options.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>

#include "commands/commands.hpp"
#include "octurn/error.hpp"
#include "octurn/file.hpp"

namespace octurn {
namespace {

using nlohmann::json;

/// Whether a setting is a list of rows of numbers.
bool holds_rows(const json& schema) {
  return schema["type"] == "array" && schema["items"]["type"] == "array";
}

/// The value's placeholder in the help.
std::string placeholder(const Field& field) {
  const json& schema = field.access.schema;
  const json& row = holds_rows(schema) ? schema["items"] : schema;
  if (row.contains("title")) {
    return row["title"];
  }
  if (schema["type"] == "array") {
    return "X0 Y0 Z0 X1 Y1 Z1";
  }
  if (!field.unit.empty()) {
    std::string unit(field.unit);
    std::ranges::transform(unit, unit.begin(), [](unsigned char c) { return std::toupper(c); });
    return unit;
  }
  return schema["type"] == "string" ? "NAME" : "N";
}

/// The help of an option: "METHOD: text (default)".
std::string help_text(const Field& field) {
  const json value = field.access.write();
  std::string usual = !field.default_text.empty() ? std::string(field.default_text)
                      : value.is_string()         ? value.get<std::string>()
                                                  : plain_text(value);
  std::erase_if(usual, [](char c) { return c == '`' || c == '"' || c == '[' || c == ']'; });
  return (field.method.empty() ? "" : std::string(field.method) + ": ") + std::string(field.help) +
         " (" + usual + ")";
}

template <typename Value>
CLI::Option* add_option(CLI::App& command, const Field& field, json& given) {
  return command.add_option_function<Value>(
      option_name(field.key),
      [&given, key = std::string(field.key)](const Value& value) { given[key] = value; },
      help_text(field));
}

/// An option that may be given several times, each time with the numbers of one row.
CLI::Option* add_rows_option(CLI::App& command, const Field& field, json& given) {
  const auto numbers = field.access.schema["items"]["minItems"].get<std::size_t>();
  CLI::Option* const option = command.add_option_function<std::vector<double>>(
      option_name(field.key),
      [&given, numbers, key = std::string(field.key)](const std::vector<double>& values) {
        json rows = json::array();
        for (std::size_t i = 0; i < values.size(); ++i) {
          if (i % numbers == 0) {
            rows.push_back(json::array());
          }
          rows.back().push_back(values[i]);
        }
        given[key] = rows;
      },
      help_text(field));
  return option->type_size(static_cast<int>(numbers))->expected(1, -1)->allow_extra_args(false);
}

CLI::Option* add_option_of_type(CLI::App& command, const Field& field, json& given) {
  const json& schema = field.access.schema;
  if (schema["type"] == "integer") {
    return add_option<int>(command, field, given);
  }
  if (schema["type"] == "number") {
    return add_option<double>(command, field, given);
  }
  if (holds_rows(schema)) {
    return add_rows_option(command, field, given);
  }
  if (schema["type"] == "array") {
    return add_option<std::vector<double>>(command, field, given)
        ->expected(schema["minItems"].get<int>());
  }
  return add_option<std::string>(command, field, given);
}

/// Adds an option that selects a simulated rig. Its optional value is the object's mesh file.
const CLI::Option* add_mesh_option(CLI::App& command, const std::string& name, RigArguments& rig,
                                   const std::string& help) {
  return command.add_option(name, rig.mesh_file, help)->type_name("[=MESH]")->expected(0, 1);
}

/// Options of every simulated rig.
std::vector<const CLI::Option*> add_simulation_options(CLI::App& command, RigArguments& rig) {
  return {command
              .add_option("--simulate-speed", rig.speed,
                          "how much faster than life the simulated rig is")
              ->type_name("FACTOR")
              ->check(CLI::Range(0.1, 1000.0)),
          command.add_flag("--simulate-perfect", rig.perfect,
                           "the simulated rig stands where the settings say, and its sensor has no "
                           "error of its own but noise"),
          command
              .add_option("--simulate-torque", rig.load.holding_torque,
                          "holding torque of the simulated motor, N m (0.2)")
              ->type_name("NM")
              ->check(CLI::Range(0.01, 10.0)),
          command
              .add_option("--simulate-inertia", rig.load.inertia,
                          "of the simulated platform about its axis, kg m^2 (0.005)")
              ->type_name("KGM2")
              ->check(CLI::Range(0.0001, 0.1))};
}

/// Options of a simulated rig with a depth sensor.
std::vector<const CLI::Option*> add_depth_simulation_options(CLI::App& command, RigArguments& rig) {
  return {
      command
          .add_option("--simulate-wall", rig.wall,
                      "the simulated sensor looks squarely at a wall so far away, as for a map "
                      "of its own error")
          ->type_name("METRES")
          ->check(CLI::Range(0.3, 6.0)),
      command
          .add_option("--simulate-unit", rig.unit,
                      "which Kinect is simulated: each number has other optics, 0 the data "
                      "sheet's (1)")
          ->type_name("N"),
      command
          .add_option("--simulate-gear", rig.gear_ratio,
                      "gear ratio of the simulated turntable, where it is not what is set")
          ->type_name("RATIO")
          ->check(CLI::Range(0.001, 1000.0)),
      command.add_flag("--simulate-reversed", rig.reversed,
                       "the simulated motor is wired the other way"),
      command
          .add_option("--simulate-play", rig.play_deg, "play of the simulated gears, degrees (0)")
          ->type_name("DEGREES")
          ->check(CLI::Range(0.0, 10.0))};
}

/// Options of a simulated rig with a camera and lasers.
std::vector<const CLI::Option*> add_laser_simulation_options(CLI::App& command, RigArguments& rig) {
  return {command.add_flag("--simulate-lens", rig.other_lens,
                           "the simulated camera's lens is not the one of the settings: it is 1 % "
                           "longer, off the middle, and distorts"),
          command
              .add_option("--simulate-late", rig.late_pictures,
                          "how many pictures the simulated camera is late, as webcams are (0)")
              ->type_name("N")
              ->check(CLI::Range(0, 10))};
}

/// Refuses options that are given without the option that they depend on.
void expect_partner(const std::vector<const CLI::Option*>& options, bool has_partner,
                    const std::string& partner) {
  for (const CLI::Option* option : options) {
    if (option->count() > 0 && !has_partner) {
      throw CLI::RequiresError(option->get_name(), partner);
    }
  }
}

}  // namespace

std::string option_name(std::string_view key) {
  std::string name = "--" + std::string(key);
  std::ranges::replace(name, '_', '-');
  return name;
}

void add_options(CLI::App& command, const std::vector<Field>& fields, json& given) {
  for (const Field& field : fields) {
    add_option_of_type(command, field, given)->type_name(placeholder(field));
  }
}

void add_config_option(CLI::App& command, ConfigArguments& config) {
  command
      .add_option("--config", config.file,
                  std::string("settings (") + default_config_file + ", if it is there)")
      ->type_name("FILE");
}

void add_config_options(CLI::App& command, ConfigArguments& config) {
  add_config_option(command, config);
  Config defaults;
  add_options(command, data_fields(defaults), config.given);
}

void add_rig_options(CLI::App& command, RigArguments& rig, ConfigArguments& config) {
  const CLI::Option* simulate =
      add_mesh_option(command, "--simulate", rig,
                      "scan with a simulated rig; MESH (STL, millimetres) stands on it");
  const CLI::Option* laser =
      add_mesh_option(command, "--simulate-laser", rig,
                      "the same with a camera and line lasers, as the settings have them");
  std::vector<const CLI::Option*> of_any = add_simulation_options(command, rig);
  std::vector<const CLI::Option*> of_depth = add_depth_simulation_options(command, rig);
  std::vector<const CLI::Option*> of_laser = add_laser_simulation_options(command, rig);
  command
      .add_option("--sensor", rig.sensor_uri,
                  "use this as the sensor: kinect://, another OpenNI2 device, an .oni file, or a "
                  "folder of `octurn record`")
      ->type_name("URI");
  command.parse_complete_callback([=, &rig, &config] {
    rig.laser = laser->count() > 0;
    rig.simulate = rig.laser || simulate->count() > 0;
    if (rig.laser && simulate->count() > 0) {
      throw CLI::ExcludesError("--simulate", "--simulate-laser");
    }
    expect_partner(of_any, rig.simulate, "--simulate or --simulate-laser");
    expect_partner(of_depth, rig.simulate && !rig.laser, "--simulate");
    expect_partner(of_laser, rig.laser, "--simulate-laser");
    if (rig.simulate) {
      config.sensor = rig.laser ? SensorKind::laser_line : SensorKind::depth;
    }
  });
}

Config make_config(const ConfigArguments& arguments) { return open_config(arguments).config(); }

ConfigStore open_config(const ConfigArguments& arguments) {
  return ConfigStore(
      {.file = chosen_config(arguments.file, arguments.sensor), .given = arguments.given});
}

void expect_writable(const std::filesystem::path& output) {
  if (output.empty()) {
    throw Error(ErrorCode::bad_settings,
                "--output is empty: must be a file, or - for standard output");
  }
  if (output != "-") {
    const AtomicFile probe(output);  // its destructor removes the temporary file
  }
}

void expect_options_of_method(const json& given, const std::vector<Field>& fields,
                              std::string_view method) {
  for (const Field& field : fields) {
    if (!field.method.empty() && field.method != method && given.contains(field.key)) {
      throw Error(ErrorCode::bad_settings,
                  option_name(field.key) + ": the method " + std::string(method) + " has none");
    }
  }
}

}  // namespace octurn
