#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "config.hpp"
#include "scan/rig.hpp"

namespace octurn {

/// What a command line says about sensor and turntable.
struct RigArguments {
  bool simulate = false;
  std::string mesh_file = {};   ///< on the simulated platform; empty: the simulator's own object
  double speed = 1.0;           ///< of the simulated rig, relative to life
  std::string sensor_uri = {};  ///< of a DepthSensor, in place of the simulated one
};

/// @param stepper  of the real turntable, which is used without --simulate
RigOptions rig_options(const RigArguments& arguments, const StepperSettings& stepper);

/// What a command line says about the configuration.
struct ConfigArguments {
  std::optional<std::filesystem::path> file = {};
  nlohmann::json given = nlohmann::json::object();  ///< by their keys in octurn.json
};

/// The file's configuration, over it what the command line says.
/// @throws Error  that names the key which is wrong
Config make_config(const ConfigArguments& arguments);

/// Finds out before the work whether a model can be written. @param output  "-" is standard output
/// @throws Error  that says why not
void expect_writable(const std::filesystem::path& output);

struct ServeArguments {
  RigArguments rig = {};
  ConfigArguments config = {};
  std::optional<std::filesystem::path> web = {};
  std::optional<std::filesystem::path> appliance = {};  ///< folder of an Appliance
};

/// `octurn serve`: the daemon. Returns after SIGTERM or SIGINT.
void serve(const ServeArguments& arguments);

struct ScanArguments {
  RigArguments rig = {};
  ConfigArguments config = {};
  nlohmann::json settings = nlohmann::json::object();  ///< as the body of a start has them
  std::optional<std::string> resume = {};     ///< the scan to go on with, by its own settings
  std::filesystem::path output = "Scan.stl";  ///< "-" is standard output
};

/// `octurn scan`: one scan from the shell. The model goes to `output`, the scan stays in `data`.
void scan(const ScanArguments& arguments);

struct RecordArguments {
  RigArguments rig = {};
  ConfigArguments config = {};
  std::filesystem::path output = {};
  int snapshots = 36;  ///< stops in a turn
  int frames = 10;     ///< at each stop
};

/// `octurn record`: what the sensor sees in a turn of the platform, to be replayed as the sensor.
void record(const RecordArguments& arguments);

struct DoctorArguments {
  RigArguments rig = {};
  ConfigArguments config = {};
  bool json = false;                              ///< one line of JSON in place of the table
  std::optional<std::filesystem::path> zip = {};  ///< also an archive for who helps from afar
};

/// `octurn doctor`: checks the scanner and says what to do about each fault. Never moves the motor.
/// @return false if there is a fault
bool doctor(const DoctorArguments& arguments);

struct ReconstructArguments {
  std::filesystem::path folder = {};
  std::filesystem::path output = {};                   ///< "-" is standard output
  nlohmann::json settings = nlohmann::json::object();  ///< of ModelSettings, by their keys
  bool json = false;                                   ///< one line of JSON on standard output
};

/// `octurn reconstruct`: a model from a scan folder.
void reconstruct(const ReconstructArguments& arguments);

struct CalibrateArguments {
  std::filesystem::path folder = {};
  bool apply = false;  ///< writes what is accepted into the folder's scan.json
  bool json = false;   ///< one line of JSON in place of text
};

/// `octurn calibrate`: the sensor's pose, from a stored scan.
/// @return false if what was solved is not to be trusted
bool calibrate(const CalibrateArguments& arguments);

/// `octurn password`: reads a password, a line, from standard input, and writes the file that
/// `password_file` of the configuration names.
void set_password(const std::filesystem::path& file);

/// `octurn update`: becomes the appliance's own program that installs an update.
/// @throws Error  if this is no appliance, or not root
[[noreturn]] void install_update(const std::filesystem::path& file);

/// Reads the command line and does what it says.
/// @return the exit status: 0, 1 if it failed, which one line on standard error explains, 2 for bad
///         usage
int run(int argc, char** argv);

}  // namespace octurn
